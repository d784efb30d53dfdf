//! Where the calibration saw the motor, and what is known less surely beyond.
//!
//! A fit holds where it was made. A motor file without saturation fits one voltage: its magnetizing inductance is that voltage's own. The
//! main flux follows voltage over frequency and sinks with the load; leakage paths saturate and bars deepen with the current; losses
//! of the iron follow flux and frequency. Recordings of one voltage and light loads show none of that.

use super::healthy::Uncertainty;
use crate::config::{ConfigError, check_range};
use crate::frames::magnitude;
use crate::model::effects::Corrected;

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

/// How far a window lies beyond the calibration, 0 within: 0.1 is a tenth more than the largest or a tenth less than the smallest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Beyond {
    /// Current.
    pub current: f32,
    /// Voltage over frequency.
    pub volt_per_hertz: f32,
    /// Supply frequency.
    pub frequency: f32,
}

/// What stator resistance and leakage take of the main flux at rated current, a share of it: 0.05 to 0.15; at a lower frequency the
/// resistance takes more.
const DROPS: f32 = 0.1;
/// Standard deviation of the magnetizing inductance per flux beyond: the magnetizing current of a saturated motor grows with the
/// second to third power of the flux, so that `d ln L_m/d ln psi` is -1 to -2; that of one in the straight part not at all.
const MAGNETIZING_PER_FLUX: f32 = 1.0;
/// The same where an effect or a law of the motor file makes the inductance follow the flux.
const KNOWN_SATURATION: f32 = 0.3;
/// Standard deviation of the leakage inductances per current beyond: closed slots lose a tenth to a quarter up to several times
/// the rated current.
const LEAKAGE_PER_CURRENT: f32 = 0.1;
/// Standard deviation of each resistance per current beyond: deep bars, at a slip that grows with the load, and a cage that warms
/// more than its winding.
const RESISTANCE_PER_CURRENT: f32 = 0.03;
/// Standard deviation of the torque balance per square of the current beyond, of rated torque: stray-load loss is 0.5 to 2 % of
/// the rated power (IEC 60034-2-1) and follows the square of the current.
const TORQUE_PER_CURRENT: f32 = 0.01;
/// Standard deviation of the current in phase with the voltage, a share of the motor's, per frequency or flux beyond: iron losses are 1 to 3 % of
/// the rated power.
const IRON_LOSS: f32 = 0.015;

impl Conditions {
    /// From a window's corrected measurements; `rated` holds voltage, current and angular frequency.
    pub(crate) fn of(measured: &Corrected, omega_sync: f32, rated: [f32; 3]) -> Self {
        let [voltage, current, omega] = rated;
        let frequency = omega_sync / omega;
        Conditions {
            current: magnitude(measured.i_s) / current,
            volt_per_hertz: magnitude(measured.u_s) / (voltage * frequency),
            frequency,
        }
    }
}

impl CalibratedRange {
    /// How far `at` lies beyond.
    pub fn beyond(&self, at: &Conditions) -> Beyond {
        Beyond {
            // A motor without load has less of everything that current makes.
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

/// 0 between `low` and `high`, else the distance as a share of the nearer of both.
fn farther(x: f32, [low, high]: [f32; 2]) -> f32 {
    let (limit, distance) = if x > high {
        (high, x - high)
    } else if x < low {
        (low, low - x)
    } else {
        return 0.0;
    };
    if limit > f32::MIN_POSITIVE {
        distance / limit
    } else {
        0.0
    }
}

impl Beyond {
    /// Whether the window lies within what the calibration saw.
    pub fn is_within(&self) -> bool {
        *self == Beyond::default()
    }

    /// The uncertainties out there; `saturating`: the motor file's inductance follows the flux.
    pub(super) fn widened(&self, known: &Uncertainty, saturating: bool) -> Uncertainty {
        let slope = if saturating {
            MAGNETIZING_PER_FLUX * KNOWN_SATURATION
        } else {
            MAGNETIZING_PER_FLUX
        };
        let resistance = RESISTANCE_PER_CURRENT * self.current;
        Uncertainty {
            stator_resistance: root_of_squares(known.stator_resistance, resistance),
            rotor_resistance: root_of_squares(known.rotor_resistance, resistance),
            magnetizing_inductance: root_of_squares(
                known.magnetizing_inductance,
                slope * self.flux(),
            ),
            leakage: root_of_squares(known.leakage, LEAKAGE_PER_CURRENT * self.current),
            ..*known
        }
    }

    /// Standard deviation of the main flux beyond: its own, and what the drops over resistance and leakage take of it.
    fn flux(&self) -> f32 {
        let drops = DROPS * root_of_squares(self.current, self.frequency);
        root_of_squares(self.volt_per_hertz, drops)
    }

    /// Standard deviation that the square of the current adds to the torque balance, of rated torque; `largest`: the largest current of
    /// the calibration, a share of the rated one.
    pub(super) fn torque(&self, largest: f32) -> f32 {
        let more = self.current * (2.0 + self.current);
        TORQUE_PER_CURRENT * largest * largest * more
    }

    /// Standard deviation of the current that feeds the iron's losses, a share of the motor's.
    pub(super) fn iron_loss(&self) -> f32 {
        IRON_LOSS * root_of_squares(self.volt_per_hertz, self.frequency)
    }
}

fn root_of_squares(x: f32, y: f32) -> f32 {
    processor::sqrtf(x * x + y * y)
}
