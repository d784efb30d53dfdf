//! The faults that a campaign knows: what breaks in the plant, and which answers of the monitor are right.

use crate::planned::pair::{
    Pair, ROTOR_RESISTANCE, STATOR_INDUCTANCE, STATOR_RESISTANCE, VOLTAGE_SENSORS, against,
};
use motor::MotorFile;
use motor::motor_file::Frame;
use scenario::Fault;

/// A fault by the name that plans and tables use.
#[derive(Debug)]
pub struct FaultKind {
    /// Its name.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// Faults of a scenario that make it up: all of them, or one of three where it has a phase.
    parts: &'static [&'static str],
    /// Whether it strikes one phase only.
    pub has_phase: bool,
    /// Whether it is a sensor and may be dead.
    pub is_sensor: bool,
    /// Causes by which the monitor may call it. Where several stand here physics makes them one (B and B_l are only ever
    /// seen as a sum), or the monitor's words are coarser than the plan's.
    answers: &'static [&'static str],
    /// What Table 1 of the paper cannot tell it from.
    pub pair: Option<Pair>,
}

const fn motor(
    name: &'static str,
    words: &'static str,
    parts: &'static [&'static str],
    answers: &'static [&'static str],
) -> FaultKind {
    FaultKind {
        name,
        words,
        parts,
        has_phase: false,
        is_sensor: false,
        answers,
        pair: None,
    }
}

const fn sensor(
    name: &'static str,
    words: &'static str,
    parts: &'static [&'static str],
    answers: &'static [&'static str],
) -> FaultKind {
    FaultKind {
        is_sensor: true,
        ..motor(name, words, parts, answers)
    }
}

const fn paired(pair: Pair, kind: FaultKind) -> FaultKind {
    FaultKind {
        pair: Some(pair),
        ..kind
    }
}

const fn in_one_phase(kind: FaultKind) -> FaultKind {
    FaultKind {
        has_phase: true,
        ..kind
    }
}

/// Every fault of a campaign.
pub const FAULTS: [FaultKind; 15] = [
    paired(
        against("Rr", [STATOR_RESISTANCE, ROTOR_RESISTANCE]),
        motor("Rs", "stator resistance", &["Rs"], &["Rs"]),
    ),
    paired(
        against("Rs", [ROTOR_RESISTANCE, STATOR_RESISTANCE]),
        motor("Rr", "rotor resistance", &["Rr"], &["Rr"]),
    ),
    paired(
        against("V", [STATOR_INDUCTANCE, VOLTAGE_SENSORS]),
        motor("Lm", "magnetizing inductance", &["Lm"], &["Lm", "Ls", "Lr"]),
    ),
    motor(
        "Lls",
        "stator leakage",
        &["Lls"],
        &["Lls", "leakage", "Ls", "Lr"],
    ),
    motor(
        "Llr",
        "rotor leakage",
        &["Llr"],
        &["Llr", "leakage", "Ls", "Lr"],
    ),
    paired(
        against("V", [STATOR_INDUCTANCE, VOLTAGE_SENSORS]),
        motor(
            "leakage",
            "both leakages",
            &["Lls", "Llr"],
            &["leakage", "Lls", "Llr", "Ls", "Lr"],
        ),
    ),
    motor("B", "friction of the motor", &["B"], &["B", "Bl"]),
    motor("Bl", "friction of the load", &["Bl"], &["B", "Bl"]),
    in_one_phase(motor(
        "Rs-phase",
        "resistance in series with one phase",
        &["Rsa", "Rsb", "Rsc"],
        &["Rs-phase", "Rs"],
    )),
    motor("bars", "broken rotor bars", &["bars"], &["bars"]),
    in_one_phase(sensor(
        "i",
        "gain of one current sensor",
        &["ia", "ib", "ic"],
        &["Iq", "i"],
    )),
    in_one_phase(sensor(
        "v",
        "gain of one voltage sensor",
        &["va", "vb", "vc"],
        &["Vq", "v"],
    )),
    sensor(
        "i-all",
        "gain of all current sensors",
        &["ia", "ib", "ic"],
        &["Iq", "i"],
    ),
    paired(
        against("L_s", [VOLTAGE_SENSORS, STATOR_INDUCTANCE]),
        sensor(
            "v-all",
            "gain of all voltage sensors",
            &["va", "vb", "vc"],
            &["Vq", "v"],
        ),
    ),
    sensor("speed", "speed sensor", &["speed"], &["wr", "speed"]),
];

impl FaultKind {
    /// A fault by its name.
    pub fn find(name: &str) -> Option<&'static FaultKind> {
        FAULTS.iter().find(|kind| kind.name == name)
    }

    /// What breaks in the plant, by `percent`, from `from_s` on. `phase`, 0..=2, counts where the fault has one.
    pub fn faults(&self, percent: f64, phase: usize, from_s: f64) -> Vec<Fault> {
        let parts = match self.has_phase {
            true => &self.parts[phase..=phase],
            false => self.parts,
        };
        let fault = |name: &&str| {
            let fault = Fault::percent(name, percent, Frame::RotorFlux)?;
            Some(Fault { from_s, ..fault })
        };
        parts.iter().filter_map(fault).collect()
    }

    /// Whether the monitor names this fault when it says `cause`.
    pub fn is_named_by(&self, cause: &str) -> bool {
        self.answers.contains(&cause)
    }

    /// Why a motor cannot have this fault.
    pub fn obstacle(&self, motor: &MotorFile, load_is_free: bool) -> Option<&'static str> {
        match self.name {
            "Bl" if load_is_free => {
                Some("changes nothing where load_kind = \"free\": the load is whatever it is")
            }
            "B" if motor.mechanics.friction == 0.0 => {
                Some("changes nothing on a motor whose friction_nm_s is 0")
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::{Change, Probe, Target};

    #[test]
    fn every_fault_breaks_something_in_every_phase_that_it_has() {
        for kind in &FAULTS {
            for phase in 0..3 {
                let expected = if kind.has_phase { 1 } else { kind.parts.len() };
                assert_eq!(
                    kind.faults(10.0, phase, 1.0).len(),
                    expected,
                    "{}",
                    kind.name
                );
            }
        }
    }

    #[test]
    fn a_sensor_that_is_off_by_100_percent_is_dead() {
        let kind = FaultKind::find("v").expect("known");
        let faults = kind.faults(-100.0, 2, 0.5);
        assert_eq!(faults[0].target, Target::Probe(Probe::Voltage(2)));
        assert_eq!(faults[0].change, Change::Factor(0.0));
        assert_eq!(faults[0].from_s, 0.5);
    }
}
