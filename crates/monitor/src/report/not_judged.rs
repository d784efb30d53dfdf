//! Why a window was not judged, with its details.

use crate::checks::sensors::SensorFinding;
use crate::checks::supply::SupplyFinding;

/// Why a window was not judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotJudged {
    /// No periodic supply was found between 5 and 100 Hz.
    NotLocked,
    /// Fewer cycles than a window needs since the oscillator (re)started.
    Settling,
    /// A channel touched the rail of its converter.
    Clipped,
    /// Samples were not finite numbers.
    Invalid,
    /// Voltages are not measured.
    NoVoltages,
    /// Currents are not measured.
    NoCurrents,
    /// The speed is not measured.
    NoSpeed,
    /// The supply is missing.
    Supply(SupplyFinding),
    /// A sensor is dead or contradicts the others.
    Sensor(SensorFinding),
    /// Current or speed are changing, and not along straight lines.
    Transient,
    /// The motor is supplied but draws no current.
    NoLoadCurrent,
    /// The shaft turns against the field, which brakes or reverses it (slip above 1), or the field changes its direction.
    Reversing,
    /// The shaft is held or slow, at a slip that no load brings: what was never measured there says nothing of bars that are deep and leakage
    /// that saturates. Only of a motor that was not calibrated.
    Held,
    /// Noise hides what the lamps are to show: see `visible` of [`crate::Report`].
    Noise,
}

impl NotJudged {
    /// Whether the window is left to what judges in motion.
    pub const fn is_motion(self) -> bool {
        matches!(
            self,
            NotJudged::Transient | NotJudged::Settling | NotJudged::NotLocked
        )
    }
}
