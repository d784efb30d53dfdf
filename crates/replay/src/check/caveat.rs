//! When kind, phase and size of a fault rest on parameters that are hardly known.

use motor::MotorFile;

use crate::{Timeline, Verdict};

/// A 95 % interval whose ends are further apart than this, as a ratio, leaves the negative sequence's impedance open in angle and size.
const LARGEST_RATIO: f64 = 1.5;
const DECISIVE: [(&str, &str, &str); 2] = [
    ("stator_resistance_ohm", "stator resistance", "ohm"),
    ("stator_leakage_henry", "stator leakage", "H"),
];

/// What a fault's cause rests on, where it is hardly known. By currents alone a motor is judged by what they were in good order.
pub(super) fn caveat(motor: &MotorFile, timeline: &Timeline, verdict: &Verdict) -> Option<String> {
    let by_voltages = timeline.sequence().v2_over_v1.is_some();
    let rests = by_voltages && verdict.rests_on_parameters();
    rests.then(|| hardly_known(motor)).flatten()
}

/// The parameters that are hardly known, in words.
fn hardly_known(motor: &MotorFile) -> Option<String> {
    let intervals = &motor.uncertainty.as_ref()?.intervals;
    let wide = DECISIVE.iter().filter_map(|(key, words, unit)| {
        let known = intervals.iter().find(|one| one.key == *key)?;
        let is_wide = known.high > LARGEST_RATIO * known.low;
        is_wide.then(|| format!("{words} {:.3} to {:.3} {unit}", known.low, known.high))
    });
    let wide: Vec<String> = wide.collect();
    (!wide.is_empty()).then(|| {
        format!(
            "cause, phase and size are uncertain as long as the motor is known so little ({}); the winding's DC resistance, a no-load and a \
             locked-rotor test narrow that",
            wide.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use motor::motor_file::{ParameterInterval, Uncertainty};

    #[test]
    fn a_motor_known_by_its_plate_has_a_caveat_and_a_measured_one_has_none() {
        let mut motor = MotorFile::read("../../motors/peer-2k2.toml").expect("it ships");
        assert_eq!(hardly_known(&motor), None);
        let of = |low, high| Uncertainty {
            intervals: vec![ParameterInterval {
                key: "stator_resistance_ohm".to_owned(),
                low,
                high,
            }],
            correlations: Vec::new(),
        };
        motor.uncertainty = Some(of(1.16, 3.18));
        assert!(
            hardly_known(&motor)
                .expect("wide")
                .contains("1.160 to 3.180 ohm")
        );
        motor.uncertainty = Some(of(3.6, 3.8));
        assert_eq!(hardly_known(&motor), None);
    }
}
