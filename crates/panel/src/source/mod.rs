//! Where the windows come from: a simulated motor, a recording or a board, behind one interface.

mod board;
mod replayed;
mod simulated;

pub use board::BoardSource;
pub use replayed::ReplayedSource;
pub use simulated::{PANEL_FAULTS, PanelFault, SimulatedSource, built_in_motor};

use document::FileError;
use monitor::{MonitorConfig, RawSample, Rehearsal, Sample};
use motor::MotorFile;
use recording::Recording;
use serde::{Deserialize, Serialize};

use crate::running::message::WindowMessage;

/// What a source is and what can be done with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SourceInfo {
    /// `simulation`, `recording` or `board`.
    pub kind: &'static str,
    /// What people call it.
    pub name: String,
    /// Samples per second, Hz.
    pub sample_rate_hz: f64,
    /// Its first and last instant, s; `None` when it has no end.
    pub span_s: Option<[f64; 2]>,
    /// Whether faults can be switched, speed chosen, pause pressed, another instant sought.
    pub can: Can,
    /// What the audit of a recording found.
    pub audit: Vec<audit::Finding>,
}

/// What a source can do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Can {
    /// Faults can be switched on and off.
    pub faults: bool,
    /// It can run slower, faster and pause.
    pub pace: bool,
    /// It can go to another instant.
    pub seek: bool,
    /// The monitor runs here, so that other parameters can be tried.
    pub parameters: bool,
}

/// A fault as the page switches it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SwitchedFault {
    /// Its name, one of [`PANEL_FAULTS`].
    pub name: String,
    /// Change of the parameter or signal, percent.
    pub change_percent: f64,
}

/// One instant of the six channels and the speed, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// Time on the source's clock, s.
    pub t_s: f64,
    /// Phase voltages, V.
    pub u_volt: [f32; 3],
    /// Phase currents, A.
    pub i_amp: [f32; 3],
    /// Speed, rad/s; `NaN` without one.
    pub omega_mech: f32,
}

/// What the monitor takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Codes, as the board's converters deliver them.
    Raw(RawSample),
    /// SI units; the flag says that samples are missing before it.
    Si(Sample, bool),
}

/// What a source delivers.
#[derive(Clone, Debug)]
pub enum Item {
    /// A sample to be judged here.
    Sample(Instant, Reading),
    /// A window that a board has judged; its `sequence` is set later.
    Judged(Box<WindowMessage>),
    /// Samples around an alarm that a board has kept.
    Capture(Box<Recording>),
}

/// Why a source delivers nothing more.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct SourceFailure(pub String);

/// One interface for everything that a panel can watch.
pub trait Source: Send {
    /// What it is.
    fn info(&self) -> SourceInfo;

    /// Its own clock, s: the time of the next sample.
    fn now_s(&self) -> f64;

    /// Hands on everything before `until_s` on its own clock; a board hands on what has come. `false` at the end.
    ///
    /// # Errors
    /// The connection is gone.
    fn advance(&mut self, until_s: f64, take: &mut dyn FnMut(Item)) -> Result<bool, SourceFailure>;

    /// The monitor's configuration for a motor file on this source, or for an unknown motor; `None` where a board judges.
    ///
    /// # Errors
    /// Effects of the motor file that the core cannot take.
    fn config(&self, motor: Option<&MotorFile>) -> Result<Option<MonitorConfig>, FileError>;

    /// Exactly these faults are in force from now on.
    ///
    /// # Errors
    /// A fault that this source does not have, in words for the person who pressed the switch.
    fn switch_faults(&mut self, _faults: &[SwitchedFault]) -> Result<(), SourceFailure> {
        Err(SourceFailure(
            "faults can only be switched on a simulated motor".into(),
        ))
    }

    /// Sensor faults that are rehearsed behind the transformation, as the published bench does.
    fn rehearsal(&self) -> Rehearsal {
        Rehearsal::default()
    }

    /// Goes to another instant on its own clock, s.
    ///
    /// # Errors
    /// A source that only goes forwards.
    fn seek(&mut self, _t_s: f64) -> Result<(), SourceFailure> {
        Err(SourceFailure("only a recording can be sought in".into()))
    }
}
