//! The size of a cause in words.

use monitor::FaultId;
use schemars::JsonSchema;
use serde::Serialize;

use crate::Verdict;

/// How bad a cause is, by the change of its quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Below 5 %.
    Small,
    /// 5 to 20 %.
    Clear,
    /// Above 20 %.
    Large,
    /// Shorted turns: their number says nothing of the time that is left.
    Growing,
}

/// Change, percent, from which on a cause is clear, and large: a convention of this project (docs/lamps.md). The published
/// pattern has no sizes, and no standard grades faults of a running motor.
const BOUNDS_PERCENT: [f64; 2] = [5.0, 20.0];

impl Severity {
    fn of_percent(change: f64) -> Severity {
        match change.abs() {
            x if x < BOUNDS_PERCENT[0] => Severity::Small,
            x if x < BOUNDS_PERCENT[1] => Severity::Clear,
            _ => Severity::Large,
        }
    }

    /// The severity in words, with what it means for the plant.
    pub fn words(self) -> &'static str {
        match self {
            Severity::Small => "small (below 5 %): watch its trend",
            Severity::Clear => "clear (5 to 20 %): plan the repair",
            Severity::Large => {
                "large (above 20 %): take the motor out of service as soon as the plant allows"
            }
            Severity::Growing => {
                "growing, whatever its size: the shorted turns carry a large current of their own; take the motor out of service"
            }
        }
    }
}

/// Of the likeliest cause, where it lies in the motor and a calibrated motor gives its size: a sensor, however far off, is no
/// reason to stop a motor.
pub(super) fn of(verdict: &Verdict) -> Option<Severity> {
    let first = verdict.candidates.first()?;
    let size = first.size_percent.filter(|_| in_the_motor(first.fault));
    size.map(|size| match first.fault {
        FaultId::Turns => Severity::Growing,
        _ => Severity::of_percent(size),
    })
}

fn in_the_motor(fault: FaultId) -> bool {
    !matches!(
        fault,
        FaultId::CurrentSensor
            | FaultId::VoltageSensor
            | FaultId::SpeedSensor
            | FaultId::LoadFriction
            | FaultId::Unknown
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_is_no_reason_to_stop_a_motor() {
        for fault in FaultId::ALL {
            let words = fault.words();
            let elsewhere = ["sensor", "speed", "load", "voltage", "current", "none of"];
            let is_elsewhere = elsewhere.iter().any(|word| words.contains(word));
            assert_eq!(in_the_motor(fault), !is_elsewhere, "{words}");
        }
    }

    #[test]
    fn words_go_with_sizes() {
        let of = |percent| Severity::of_percent(percent);
        assert_eq!(
            [of(-4.9), of(5.0), of(-19.9), of(20.0)],
            [
                Severity::Small,
                Severity::Clear,
                Severity::Clear,
                Severity::Large
            ]
        );
    }

    #[test]
    fn shorted_turns_have_no_small_size() {
        let verdict = |fault, size_percent| Verdict {
            state: crate::VerdictState::Fault,
            candidates: vec![crate::causes::Candidate {
                fault,
                phase: Some("a"),
                probability: 0.9,
                size_percent,
            }],
            tied: 1,
            separating_tests: Vec::new(),
        };
        let small = Some(1.0);
        assert_eq!(of(&verdict(FaultId::Turns, small)), Some(Severity::Growing));
        let resistance = verdict(FaultId::StatorResistance, small);
        assert_eq!(of(&resistance), Some(Severity::Small));
        assert_eq!(of(&verdict(FaultId::VoltageSensor, Some(90.0))), None);
        assert_eq!(of(&verdict(FaultId::Turns, None)), None);
    }
}
