//! What the monitor says about one window.

pub(crate) mod not_judged;
pub(crate) mod reason;

use crate::beside::moving::{MotionWord, Moving};
use crate::checks::cage::RotorReading;
use crate::checks::sensors::SensorFinding;
use crate::checks::supply::SupplyFinding;
use crate::isolation::Isolation;
use crate::lamps::lamp::Lamps;
use crate::lamps::signature::Candidates;
use crate::model::operating_point::OperatingPoint;
use crate::model::residuals::{RESIDUALS, Residuals};
use crate::window::Window;

pub use not_judged::NotJudged;
pub use reason::Reason;

/// One window's result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Samples seen since the start, up to and with this window's last one.
    pub sample_index: u64,
    /// The measurement; `None` while there is no complete window.
    pub window: Option<Window>,
    /// The point that the residuals were evaluated at, wherever that was possible.
    pub point: Option<OperatingPoint>,
    /// Residuals relative to their scales, wherever they could be evaluated (even in a transient).
    pub residuals: Option<Residuals>,
    /// `None` when the window was judged.
    pub not_judged: Option<NotJudged>,
    /// Finding about a sensor in this window, before persistence.
    pub sensor: Option<SensorFinding>,
    /// Finding about the supply in this window, before persistence.
    pub supply: Option<SupplyFinding>,
    /// Negative sequence of the currents beyond what the voltages explain, over what tolerances leave open: beyond 1 is a fault.
    /// Only on a motor that was not calibrated.
    pub unbalance: Option<f32>,
    /// FAULT is lit by it.
    pub is_unbalanced: bool,
    /// Residuals over what lights their lamps: beyond 1 is on.
    pub normalised: Option<[f32; RESIDUALS]>,
    /// Residuals, shares of their scales, from which on the lamps light in this window: the thresholds, and what its noise
    /// and its changes can do. `None` where there are no residuals.
    pub visible: Option<[f32; RESIDUALS]>,
    /// Which cause explains the window, where the motor was calibrated.
    pub isolation: Option<Isolation>,
    /// What the current's sidebands say about the rotor's bars.
    pub rotor: RotorReading,
    /// Lamps after this window, as the windows at rest have them.
    pub lamps: Lamps,
    /// What is said in motion, where something judges beside the windows.
    pub moving: Option<Moving>,
    /// Probability of each row of Table 1 while r1..r4 light FAULT: without a calibration.
    pub candidates: Option<Candidates>,
}

impl Report {
    /// The lamps as the door shows them: those of the windows at rest with what is said in motion.
    ///
    /// A window that is judged in motion has RUN on; LOAD goes on blinking, which says that something changes.
    pub fn shown_lamps(&self) -> Lamps {
        self.moving
            .map_or(self.lamps, |moving| moving.over(&self.lamps))
    }

    /// How the window stands in motion.
    pub fn motion_word(&self) -> MotionWord {
        let is_motion = self.not_judged.is_some_and(NotJudged::is_motion);
        self.moving
            .map_or(MotionWord::AtRest, |moving| moving.word(is_motion))
    }

    /// Why the window counts for nothing; `None` where it was judged, at rest or in motion.
    pub fn reason(&self) -> Option<Reason> {
        let moving = self.moving.unwrap_or_default();
        match moving.is_unexplained {
            true => Some(Reason::DoesNotFit),
            false if moving.is_judged => None,
            false => self.not_judged.map(NotJudged::reason),
        }
    }

    /// Whether the window was judged, at rest or in motion.
    pub fn is_judged_either_way(&self) -> bool {
        self.reason().is_none()
    }

    /// Whether thresholds were applied to this window.
    pub fn is_judged(&self) -> bool {
        self.not_judged.is_none()
    }
}
