//! Pole pairs and slip of a rated speed.

use super::{Printed, Problem};

/// Frequencies of public supplies, Hz.
const SUPPLIES: [f64; 2] = [50.0, 60.0];
/// Greatest rated slip of a squirrel-cage motor, design D included.
const GREATEST_SLIP: f64 = 0.25;
/// Greatest rated slip that is believed when the frequency is guessed from the speed.
const USUAL_SLIP: f64 = 0.13;
/// Least rated slip.
const LEAST_SLIP: f64 = 0.0005;
/// Most pole pairs.
const POLE_PAIRS: u32 = 50;

/// Pole pairs, slip, and half a step of the printed speed relative to the slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rotation {
    pub(super) pole_pairs: u32,
    pub(super) slip: f64,
    pub(super) slip_half_step: f64,
}

impl Rotation {
    pub(super) fn of(speed: Printed, frequency_hz: f64) -> Result<Rotation, Problem> {
        let field_rpm = 60.0 * frequency_hz;
        let pole_pairs = (field_rpm / speed.value)
            .floor()
            .clamp(1.0, f64::from(POLE_PAIRS));
        let synchronous_rpm = field_rpm / pole_pairs;
        let slip = 1.0 - speed.value / synchronous_rpm;
        if !(LEAST_SLIP..=GREATEST_SLIP).contains(&slip) {
            return Err(Problem::NoSlip {
                speed_rpm: speed.value,
                frequency_hz,
                synchronous_rpm,
            });
        }
        Ok(Rotation {
            pole_pairs: pole_pairs as u32,
            slip,
            slip_half_step: half_step_rpm(speed) / (synchronous_rpm * slip),
        })
    }
}

/// Makers print whole revolutions, most of them multiples of five.
fn half_step_rpm(speed: Printed) -> f64 {
    let fives = speed.half_step == 0.5 && speed.value % 5.0 == 0.0;
    if fives { 2.5 } else { speed.half_step }
}

/// The supply at which a speed is a usual rated speed.
pub(super) fn frequency_of(speed: Printed) -> Option<f64> {
    let usual = |frequency_hz: &f64| {
        Rotation::of(speed, *frequency_hz).is_ok_and(|rotation| rotation.slip < USUAL_SLIP)
    };
    SUPPLIES.into_iter().find(usual)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotation(rpm: &str, hz: f64) -> Rotation {
        Rotation::of(rpm.parse().unwrap(), hz).unwrap()
    }

    #[test]
    fn poles_follow_from_speed() {
        for (rpm, hz, pairs) in [
            ("2910", 50.0, 1),
            ("1455", 50.0, 2),
            ("960", 50.0, 3),
            ("1750", 60.0, 2),
            ("1165", 60.0, 3),
        ] {
            assert_eq!(rotation(rpm, hz).pole_pairs, pairs, "{rpm}");
        }
        // 45 of 1500 rpm; printed to 5 rpm: 2.5 of 45.
        assert!((rotation("1455", 50.0).slip - 0.03).abs() < 1e-12);
        assert!((rotation("1455", 50.0).slip_half_step - 2.5 / 45.0).abs() < 1e-12);
        assert!((rotation("1456", 50.0).slip_half_step - 0.5 / 44.0).abs() < 1e-12);
    }

    #[test]
    fn frequency_follows_from_speed() {
        for (rpm, hz) in [
            ("2910", 50.0),
            ("3500", 60.0),
            ("1455", 50.0),
            ("1750", 60.0),
            ("960", 50.0),
            ("1160", 60.0),
            ("720", 50.0),
            ("870", 60.0),
        ] {
            assert_eq!(frequency_of(rpm.parse().unwrap()), Some(hz), "{rpm}");
        }
    }

    #[test]
    fn a_synchronous_speed_is_refused() {
        assert!(Rotation::of("1500".parse().unwrap(), 50.0).is_err());
        assert!(Rotation::of("3600".parse().unwrap(), 60.0).is_err());
    }
}
