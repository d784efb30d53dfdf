//! Compare a motor model with recordings, find the physical effect it misses, prove it on data that was not fitted.
//!
//! [`compare`] says where the model fails, [`explain`] which effect is missing and how sure that is, [`adopt`]
//! adds one and shows the error fall on held-out data. The first source is fitted, further ones prove; a single
//! one is proven by interleaved folds of 40 ms blocks. The same input gives the same report, byte for byte.

mod accept;
mod api;
mod belief;
#[cfg(test)]
mod beliefs_checked;
mod case;
mod channels;
pub mod class;
mod compare;
mod confirm;
mod explain;
mod fit;
mod floor;
mod frame;
mod free_scale;
mod gram;
mod inconclusive;
mod inputs;
mod off;
mod polish;
mod predict;
mod present;
mod proof;
mod question;
mod readings;
#[cfg(test)]
mod refitted_folds;
mod report;
mod screen;
mod signal;
#[cfg(test)]
mod specimen;
mod speed_gain;
mod study;
mod table;
mod uncertainty;
mod unexplained;
mod unsupported;
mod words;

pub use api::{Progress, adopt, explain, explain_without};
pub use compare::compare;
pub use predict::simulations;
pub use question::Error;
pub use report::{
    AdoptReport, AtRest, BandReport, CompareReport, ErrorReport, ErrorSource, ExplainReport,
    FitReport, FrameBand, FrameReport, Inconclusive, NominalReport, OrderReport, Overall,
    ParameterReport, RankReport, RegionReport, SignalReport, SpeedScaleReport, StepReport,
    Unexplained, Verdict,
};
pub use table::table_values;
pub use unsupported::Unsupported;
