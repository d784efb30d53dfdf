//! Monitor, check, calibrate, compare, explain and adopt with everything that is shown of them: terminal, reports, panel and Python hold the same.

mod adopt;
pub mod batch;
mod calibration;
mod check;
mod compare;
mod explain;
mod known;
mod monitored;
mod motor_map;
mod places;
mod trace;
mod typed;

pub use adopt::Adopted;
pub use calibration::{
    CalibratedParameter, Calibration, CalibrationRange, ChannelGains, FALSE_ALARM_RATES,
    HealthyCage, HealthyStatistics, MisfitPercent, WINDING_KELVINS,
};
pub use check::{CheckedRecording, Checkup, Taken};
pub use compare::Compared;
pub use explain::{Explained, Next, anything_off};
pub use known::{Known, ParameterRow, PlateRow};
pub use monitored::{MonitorError, Monitored, Monitoring};
pub use motor_map::{Job, MapError, MappedMotor, MotorMap};
pub use places::{Place, worst};
pub use trace::{WindowRow, WindowTrace};
pub use typed::Typed;

use std::borrow::Cow;

pub use discovery::PARAMETERS;
use discovery::{Fitted, Laws, NextRun, One, Sources, SpeedScaleReport};
use monitor::MonitorConfig;
use motor::MotorFile;
use recording::Source;

/// What a question is asked about.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The recordings' names as people know them, in the order of `sources`.
    pub names: &'a [String],
    /// The first is fitted, the second proves, or the other way round where that explains more; of more, the first, third, ... are
    /// fitted together.
    pub sources: Sources<'a>,
    /// What is believed of the motor.
    pub motor: &'a MotorFile,
    /// What laws are held against, and which formula is taken over.
    pub laws: Laws,
    /// The next experiment, where an explanation is asked for one.
    pub next_run: Option<&'a NextRun>,
}

impl<'a> Inputs<'a> {
    /// Names and sources as an answer is about them, what is fitted first.
    fn as_answered(&self, fitted: Fitted) -> (Vec<String>, Vec<One<'a>>) {
        let (mut names, mut sources) =
            (self.names.to_vec(), self.sources.iter().collect::<Vec<_>>());
        if fitted == Fitted::Second {
            names.reverse();
            sources.reverse();
        }
        (names, sources)
    }
}

/// A source as figures show it: a speed of unknown scale in the scale that was fitted, of a long recording the stretch at
/// `at_s` (s) or the first one.
fn shown<'a>(
    source: One<'a>,
    scale: Option<&SpeedScaleReport>,
    at_s: f64,
) -> Option<Cow<'a, Source>> {
    match source {
        One::Source(source) => Some(in_fitted_scale(source, scale)),
        One::Excerpt(excerpt) => {
            let part = excerpt.around(at_s)?.clone();
            Some(Cow::Owned(Source::Recording(part)))
        }
    }
}

/// A source as figures show it: a speed of unknown scale in the scale that was fitted.
pub fn in_fitted_scale<'a>(
    source: &'a Source,
    scale: Option<&SpeedScaleReport>,
) -> Cow<'a, Source> {
    match (source, scale) {
        (Source::Recording(recording), Some(scale)) => Cow::Owned(Source::Recording(
            recording
                .clone()
                .with_speed_scale(scale.factor, scale.at_rest_rad_s),
        )),
        _ => Cow::Borrowed(source),
    }
}

/// Whether the core takes all effects and curves of a motor file.
///
/// # Errors
/// The file, how many there are, and the remedy.
pub fn effects_fit(file: &str, motor: &MotorFile) -> Result<(), String> {
    // What fits does not depend on the sampling time.
    let config = MonitorConfig::from_motor_file(motor, 1e-4);
    config.map(drop).map_err(|error| {
        let problems = error.problems().iter();
        let said: Vec<String> = problems.map(|p| format!("{file} {}", p.message)).collect();
        said.join("\n")
    })
}
