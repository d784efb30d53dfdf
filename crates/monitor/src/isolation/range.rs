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
    /// Smallest active current; below 0 the motor fed it back, as a hoist does when it lowers.
    pub active: f32,
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
    /// Active current; below 0 the motor feeds it back.
    pub active: f32,
    /// Frequency in the cage: the slip's.
    pub slip: f32,
}

/// Largest frequency in the cage that steady loads have shown, a share of the rated one: a small motor of 7 % rated slip, hot and overloaded,
/// reaches 0.15. Below it (10 Hz) the current fills bars of copper as deep as 20 mm.
const SLIP_OF_LOADS: f32 = 0.2;

/// Share of the rated power that losses take before a load that drives the shaft feeds anything back: an assumption, 10 % of a large motor and
/// 20 % of a small one.
const LOSSES: f32 = 0.15;

/// What counts as the same conditions, a share: the standard band of a large grid is 50 Hz within 0.2 Hz, 0.4 %. The same for the voltage is an
/// assumption: by half a per cent of flux even a saturated motor's `L_m` moves by 1 % at most.
const WANDERING: f32 = 0.005;

/// No motor that runs draws less, of rated current.
const LEAST_CURRENT: f32 = 0.05;

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
    /// Active current fed back beyond what the calibration saw, of rated current, and what the losses take of it; never below 0.
    pub fed_back: f32,
    /// Active current below the smallest that the calibration saw, of rated current; never below 0.
    pub lighter: f32,
    /// Of a loss current that a fit at that smallest one took for resistance, the share that shows at this load, over the motor's current, of
    /// rated current.
    pub regained: f32,
    /// Frequency in the cage beyond that of any load, of the rated frequency: nearly 1 where a motor stands; never below 0.
    pub slip: f32,
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

/// Standard deviation of the magnetizing inductance per rated active current fed back: the drop over the resistance, 0.03 to 0.08 of the
/// voltage, now adds to the flux what it took, and a saturated inductance falls by up to twice as much.
const MAGNETIZING_PER_FED_BACK: f32 = 0.05;
/// Of the leakage inductances and of each resistance: what the fit has put down to them while the power came from the supply.
const LEAKAGE_PER_FED_BACK: f32 = 0.05;
/// See [`LEAKAGE_PER_FED_BACK`].
const RESISTANCE_PER_FED_BACK: f32 = 0.03;
/// Of the torque balance, of rated torque, and of the current in phase with the voltage, a share of the motor's: losses keep their sign where
/// everything else changes it, so twice what the fit has absorbed of them appears.
const TORQUE_PER_FED_BACK: f32 = 0.02;
/// See [`TORQUE_PER_FED_BACK`].
const IRON_LOSS_PER_FED_BACK: f32 = 0.03;
/// Standard deviation of the rotor's resistance per frequency in the cage beyond that of loads: the current crowds to the top of deep
/// bars, whose resistance at standstill is 1.2 to 3 times that of a load.
const ROTOR_RESISTANCE_PER_SLIP: f32 = 0.5;
/// Of the leakage inductances: the same crowding takes a tenth to a third of the bars' own.
const LEAKAGE_PER_SLIP: f32 = 0.2;
/// Of the torque balance, of rated torque: harmonics of the field brake and drive a slow cage.
const TORQUE_PER_SLIP: f32 = 0.1;

impl Conditions {
    /// From a window's corrected measurements; `rated`: amplitudes of phase voltage, V, and current, A, angular frequency, rad/s, and pairs
    /// of poles.
    pub(crate) fn of(measured: &Corrected, omega_sync: f32, rated: [f32; 4]) -> Self {
        let [voltage, current, omega, n_p] = rated;
        let frequency = omega_sync / omega;
        // Of the drop over the resistance a share that a voltage at rated frequency holds too: a drive raises its voltage by the rest.
        let raised = if frequency < 1.0 {
            1.0 - frequency
        } else {
            0.0
        };
        let drop = measured.i_s * (measured.params.r_s * raised);
        let active = measured.i_s.re * measured.u_s.re + measured.i_s.im * measured.u_s.im;
        Conditions {
            current: magnitude(measured.i_s) / current,
            volt_per_hertz: magnitude(measured.u_s - drop) / (voltage * frequency),
            frequency,
            active: active / (magnitude(measured.u_s) * current),
            slip: (omega_sync - n_p * measured.omega_mech).abs() / omega,
        }
    }
}

impl CalibratedRange {
    /// How far `at` lies beyond.
    pub fn beyond(&self, at: &Conditions) -> Beyond {
        let lighter = more(self.active.max(0.0) - WANDERING, at.active.max(0.0));
        Beyond {
            current: farther(at.current, [0.0, self.current]),
            volt_per_hertz: farther(at.volt_per_hertz, self.volt_per_hertz),
            frequency: farther(at.frequency, self.frequency),
            lighter,
            regained: match lighter {
                lighter if lighter > 0.0 => lighter / (self.active * at.current.max(LEAST_CURRENT)),
                _ => 0.0,
            },
            fed_back: match more(-at.active, (-self.active).max(0.0) + WANDERING) {
                more if more > 0.0 => more + LOSSES,
                _ => 0.0,
            },
            slip: more(at.slip, SLIP_OF_LOADS),
        }
    }

    /// Checks the ranges.
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        let share = [0.0, 100.0];
        check_range(("healthy.range.current", self.current, share))?;
        check_range(("healthy.range.active", self.active, [-100.0, 100.0]))?;
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

/// By how much `x` is larger than `limit`, else 0.
fn more(x: f32, limit: f32) -> f32 {
    if x > limit { x - limit } else { 0.0 }
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

    /// How far the window lies from what the calibration saw itself: current, voltage over frequency and frequency as shares of it; what is
    /// fed back, what is lighter and the slip as they are.
    pub fn from_seen(&self) -> Beyond {
        let seen = |share: f32| {
            let wandering = if share > 0.0 { WANDERING } else { -WANDERING };
            if share != 0.0 {
                (1.0 + share) * (1.0 + wandering) - 1.0
            } else {
                0.0
            }
        };
        let fed_back = if self.fed_back > 0.0 {
            self.fed_back - LOSSES + WANDERING
        } else {
            0.0
        };
        let lighter = match self.lighter {
            lighter if lighter > 0.0 => lighter + WANDERING,
            _ => 0.0,
        };
        Beyond {
            lighter,
            current: seen(self.current),
            volt_per_hertz: seen(self.volt_per_hertz),
            frequency: seen(self.frequency),
            fed_back,
            ..*self
        }
    }

    /// What is to be added to the uncertainties of the calibration.
    pub(super) fn added(&self) -> Added {
        let current = self.current * self.current;
        let saturation = SATURATION_DEVIATION * self.volt_per_hertz;
        let drop = MAGNETIZING_PER_DROP * (current + self.frequency.abs())
            + MAGNETIZING_PER_FED_BACK * self.fed_back;
        let resistance = RESISTANCE_PER_CURRENT * current + RESISTANCE_PER_FED_BACK * self.fed_back;
        Added {
            stator_resistance: resistance,
            rotor_resistance: resistance + ROTOR_RESISTANCE_PER_SLIP * self.slip,
            magnetizing_inductance: length([saturation, drop]),
            leakage: LEAKAGE_PER_CURRENT * current
                + LEAKAGE_PER_FED_BACK * self.fed_back
                + LEAKAGE_PER_SLIP * self.slip,
        }
    }

    /// By how much the magnetizing inductance is expected to differ where nothing in the motor file makes it follow the flux, a share.
    pub(super) fn saturation(&self) -> f32 {
        SATURATION * self.volt_per_hertz
    }

    /// Standard deviation of the torque balance, of rated torque.
    pub(super) fn torque(&self) -> f32 {
        TORQUE_PER_CURRENT * self.current * self.current
            + TORQUE_PER_FED_BACK * self.fed_back
            + TORQUE_PER_SLIP * self.slip
    }

    /// Standard deviation of the current that feeds the iron's losses, a share of the motor's; `uncertain`: at rated voltage, of rated
    /// current.
    ///
    /// At one load a fit takes it for resistance of the rotor, which then is that load's own.
    pub(super) fn iron_loss(&self, uncertain: f32) -> f32 {
        uncertain * (self.volt_per_hertz.abs() + self.frequency.abs() + self.regained)
            + IRON_LOSS_PER_FED_BACK * self.fed_back
    }
}

/// Standard deviations beside those of a calibration, shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Added {
    /// Resistance of the stator.
    pub stator_resistance: f32,
    /// Resistance of the rotor.
    pub rotor_resistance: f32,
    /// Magnetizing inductance.
    pub magnetizing_inductance: f32,
    /// Leakage inductances.
    pub leakage: f32,
}

/// Root of the sum of squares.
pub(crate) fn length([x, y]: [f32; 2]) -> f32 {
    processor::sqrtf(x * x + y * y)
}
