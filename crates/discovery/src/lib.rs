//! Compare a motor model with recordings, find the physical effect it misses, prove it on data that was not fitted.
//!
//! [`compare`] says where the model fails, [`explain`] which effect is missing and how sure that is, [`adopt`]
//! adds one and shows the error fall on held-out data. The first source is fitted, further ones prove; a single
//! one is proven by interleaved folds of 40 ms blocks. The same input gives the same report, byte for byte.
//!
//! ```
//! use discovery::compare;
//! use motor::MotorFile;
//! use formats::read_recording;
//! use recording::{Mapping, Source};
//!
//! let motor = MotorFile::read("../../tests/data/peer/windage/motor.toml").expect("a motor file");
//! let file = "../../tests/data/peer/windage/recording.csv.gz".as_ref();
//! let recording = read_recording(file, &Mapping::default(), &mut |_| {}).expect("readable");
//! let report = compare(&[Source::Recording(recording)], &motor, &mut |_, _| {}).expect("comparable");
//! let overall = report.overall.expect("a sound recording");
//! assert!(overall.error_over_noise > 1.1); // A windage is missing in the motor file.
//! ```

mod api;
mod bursts;
mod compare;
mod design;
mod explain;
mod identify;
mod laws;
mod report;
mod search;

pub use api::{
    Asked, LAW, PARAMETERS, Progress, adopt, adopt_with, explain, explain_with, explain_without,
};
pub use compare::compare;
pub use design::limits::{Limits, NextRun};
pub use design::report::{
    Certainty, DecidesReport, DesignGoal, DesignReport, LevelReport, RunReport,
};
pub use estimation::data::case::running_at;
pub use estimation::data::given::{Fitted, Given, One, Sources};
pub use estimation::data::instrument_class;
pub use estimation::data::load_table::table_values;
pub use estimation::data::question::Error;
pub use estimation::data::stretches::{
    Budget, Choice, Excerpt, FirstLook, Gathering, Role, Seen, StretchReport,
    told as told_stretches,
};
pub use estimation::data::unsupported::Unsupported;
pub use estimation::model::prediction::{carried_speed, simulations};
pub use estimation::model::scale_report::{AtRest, ErrorSource, SpeedScaleReport};
pub use estimation::proof::channels::{ChannelReport, ChannelsReport};
pub use estimation::proof::windings::WindingsReport;
pub use identify::{IdentifiedParameter, IdentifyReport, identify};
pub use laws::formula::dictionary::{Laws, Shapes};
pub use report::law::{BurstReport, BurstsReport, FormulaReport, LawCurve, LawPlace, LawReport};
pub use report::parameter::{NominalReport, ParameterReport};
pub use report::types::{
    AdoptReport, BandReport, CompareReport, DifferenceReport, ErrorReport, ExplainReport,
    FitReport, FrameBand, FrameReport, Inconclusive, OrderReport, Overall, RankReport,
    RegionReport, SignalReport, StepReport, Unexplained, Verdict,
};
