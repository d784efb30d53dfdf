//! Where the calibration saw the motor, and what is known less surely beyond.
//!
//! A fit holds where it was made. A motor file without saturation fits one voltage: its magnetizing inductance is that voltage's own. The
//! main flux follows voltage over frequency and sinks with the load; leakage paths saturate and bars deepen with the current; losses
//! of the iron follow flux and frequency. Recordings of one voltage and light loads show none of that.

use crate::config::{ConfigError, check_range};
use crate::model::effects::Corrected;
use frames::magnitude;

/// Where the windows of a calibration lay, shares of the rated values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibratedRange {
    /// Largest positive-sequence current.
    pub current: f32,
    /// Smallest and largest voltage over frequency.
    pub volt_per_hertz: [f32; 2],
    /// Lowest and highest supply frequency.
    pub frequency: [f32; 2],
}

/// What a window was measured at, shares of the rated values as in [`CalibratedRange`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Positive-sequence current.
    pub current: f32,
    /// Voltage over frequency.
    pub volt_per_hertz: f32,
    /// Supply frequency.
    pub frequency: f32,
}

/// What counts as the same conditions, a share: the standard band of a large grid is 50 Hz within 0.2 Hz, 0.4 %. The same for the voltage is an
/// assumption: by half a per cent of flux even a saturated motor's `L_m` moves by 1 % at most.
const WANDERING: f32 = 0.005;

/// How far a window lies beyond the calibration and what a grid wanders by, 0 within: 0.1 is a tenth more than the largest, -0.1 a tenth
/// less than the smallest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beyond {
    /// Current, never below 0: a motor without load has less of everything that current makes.
    pub current: f32,
    /// Voltage over frequency.
    pub volt_per_hertz: f32,
    /// Supply frequency.
    pub frequency: f32,
}

/// The magnetizing current of a saturated motor grows with the second to third power of the flux, that of one in the straight part
/// with the first: `d ln L_m/d ln psi` lies between -2 and 0.
const SATURATION: f32 = -1.0;
/// Its standard deviation; where an effect or a law of the motor file makes the inductance follow the flux, that of what is left.
const SATURATION_DEVIATION: f32 = 0.3;
/// Standard deviation of the magnetizing inductance per square of the current beyond, and per frequency: resistance and leakage take
/// 0.05 to 0.15 of the main flux at rated current, of which the calibration has seen the straight part; at half the frequency the
/// resistance takes twice as much.
const MAGNETIZING_PER_DROP: f32 = 0.1;
/// Standard deviation of the leakage inductances per square of the current beyond: closed slots lose a tenth to a quarter up to
/// several times the rated current.
const LEAKAGE_PER_CURRENT: f32 = 0.1;
/// Standard deviation of each resistance per square of the current beyond: deep bars, at a slip that grows with the load, and a cage
/// that warms more than its winding.
const RESISTANCE_PER_CURRENT: f32 = 0.03;
/// Standard deviation of the torque balance per square of the current beyond, of rated torque: stray-load loss is 0.5 to 2 % of
/// the rated power (IEC 60034-2-1) and follows the square of the current.
const TORQUE_PER_CURRENT: f32 = 0.03;
/// Standard deviation of the current in phase with the voltage, a share of the motor's, per voltage over frequency or frequency beyond:
/// iron losses are 1 to 3 % of the rated power.
const IRON_LOSS: f32 = 0.015;

impl Conditions {
    /// From a window's corrected measurements; `rated`: amplitudes of phase voltage, V, and current, A, and angular frequency, rad/s.
    pub(crate) fn of(measured: &Corrected, omega_sync: f32, rated: [f32; 3]) -> Self {
        let [voltage, current, omega] = rated;
        let frequency = omega_sync / omega;
        // Of the drop over the resistance a share that a voltage at rated frequency holds too: a drive raises its voltage by the rest.
        let raised = if frequency < 1.0 {
            1.0 - frequency
        } else {
            0.0
        };
        let drop = measured.i_s * (measured.params.r_s * raised);
        Conditions {
            current: magnitude(measured.i_s) / current,
            volt_per_hertz: magnitude(measured.u_s - drop) / (voltage * frequency),
            frequency,
        }
    }
}

impl CalibratedRange {
    /// How far `at` lies beyond.
    pub fn beyond(&self, at: &Conditions) -> Beyond {
        Beyond {
            current: farther(at.current, [0.0, self.current]),
            volt_per_hertz: farther(at.volt_per_hertz, self.volt_per_hertz),
            frequency: farther(at.frequency, self.frequency),
        }
    }

    /// Checks the ranges.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        let share = [0.0, 100.0];
        check_range(("healthy.range.current", self.current, share))?;
        for (name, [low, high]) in [
            ("healthy.range.volt_per_hertz", self.volt_per_hertz),
            ("healthy.range.frequency", self.frequency),
        ] {
            check_range((name, low, [0.0, high]))?;
            check_range((name, high, share))?;
        }
        Ok(())
    }
}

/// 0 between `low` and `high`, else the distance from the nearer of both as a share of it.
fn farther(x: f32, [low, high]: [f32; 2]) -> f32 {
    let (low, high) = (low * (1.0 - WANDERING), high * (1.0 + WANDERING));
    let limit = if x > high {
        high
    } else if x < low {
        low
    } else {
        return 0.0;
    };
    if limit > f32::MIN_POSITIVE {
        (x - limit) / limit
    } else {
        0.0
    }
}

impl Beyond {
    /// Whether the window lies within what the calibration saw.
    pub fn is_within(&self) -> bool {
        *self == Beyond::default()
    }

    /// How far the window lies from what the calibration saw itself: current, voltage over frequency and frequency, shares.
    pub fn from_seen(&self) -> [f32; 3] {
        [self.current, self.volt_per_hertz, self.frequency].map(|share| {
            let wandering = if share > 0.0 { WANDERING } else { -WANDERING };
            if share != 0.0 {
                (1.0 + share) * (1.0 + wandering) - 1.0
            } else {
                0.0
            }
        })
    }

    /// What is to be added to the uncertainties of the calibration.
    pub(super) fn added(&self) -> Added {
        let current = self.current * self.current;
        let saturation = SATURATION_DEVIATION * self.volt_per_hertz;
        let drop = MAGNETIZING_PER_DROP * (current + self.frequency.abs());
        Added {
            resistance: RESISTANCE_PER_CURRENT * current,
            magnetizing_inductance: length([saturation, drop]),
            leakage: LEAKAGE_PER_CURRENT * current,
        }
    }

    /// By how much the magnetizing inductance is expected to differ where nothing in the motor file makes it follow the flux, a share.
    pub(super) fn saturation(&self) -> f32 {
        SATURATION * self.volt_per_hertz
    }

    /// Standard deviation of the torque balance, of rated torque.
    pub(super) fn torque(&self) -> f32 {
        TORQUE_PER_CURRENT * self.current * self.current
    }

    /// Standard deviation of the current that feeds the iron's losses, a share of the motor's.
    pub(super) fn iron_loss(&self) -> f32 {
        IRON_LOSS * (self.volt_per_hertz.abs() + self.frequency.abs())
    }
}

/// Standard deviations beside those of a calibration, shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Added {
    /// Each resistance.
    pub resistance: f32,
    /// Magnetizing inductance.
    pub magnetizing_inductance: f32,
    /// Leakage inductances.
    pub leakage: f32,
}

/// Root of the sum of squares.
pub(super) fn length([x, y]: [f32; 2]) -> f32 {
    processor::sqrtf(x * x + y * y)
}
