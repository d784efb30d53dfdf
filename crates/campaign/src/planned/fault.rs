//! The faults that a campaign knows: what breaks in the plant, and which answers of the monitor are right.

use crate::planned::pair::{
    Pair, ROTOR_RESISTANCE, STATOR_INDUCTANCE, STATOR_RESISTANCE, VOLTAGE_SENSORS, against,
};
use motor::{FaultId, MotorFile};
use scenario::{Asymmetry, Fault, Parameter, Probe, Target};

/// A fault by the name that plans and tables use.
#[derive(Debug)]
pub struct FaultKind {
    /// Its name.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// What breaks: all of these, or one of three where it has a phase.
    parts: &'static [Target],
    /// Whether it strikes one phase only.
    pub has_phase: bool,
    /// Whether it is a sensor and may be dead.
    pub is_sensor: bool,
    /// Causes by which the monitor may call it. Where several stand here physics makes them one (B and B_l are only ever
    /// seen as a sum), or the monitor's words are coarser than the plan's.
    answers: &'static [FaultId],
    /// What Table 1 of the paper cannot tell it from.
    pub pair: Option<Pair>,
}

const fn motor(
    name: &'static str,
    words: &'static str,
    parts: &'static [Target],
    answers: &'static [FaultId],
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
    parts: &'static [Target],
    answers: &'static [FaultId],
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

/// A fault of the motor under its name and words of the catalogue.
const fn listed(
    fault: FaultId,
    parts: &'static [Target],
    answers: &'static [FaultId],
) -> FaultKind {
    motor(fault.name(), fault.words(), parts, answers)
}

const STATOR_LEAKAGE: Target = Target::Parameter(Parameter::Lls);
const ROTOR_LEAKAGE: Target = Target::Parameter(Parameter::Llr);
const VOLTAGES: &[Target] = &[
    Target::Probe(Probe::Voltage(0)),
    Target::Probe(Probe::Voltage(1)),
    Target::Probe(Probe::Voltage(2)),
];
const CURRENTS: &[Target] = &[
    Target::Probe(Probe::Current(0)),
    Target::Probe(Probe::Current(1)),
    Target::Probe(Probe::Current(2)),
];
const JOINTS: &[Target] = &[
    Target::Asymmetry(Asymmetry::Series(0)),
    Target::Asymmetry(Asymmetry::Series(1)),
    Target::Asymmetry(Asymmetry::Series(2)),
];
const OF_MAGNETIZING: &[FaultId] = &[
    FaultId::MagnetizingInductance,
    FaultId::StatorInductance,
    FaultId::RotorInductance,
];
const OF_LEAKAGE: &[FaultId] = &[
    FaultId::Leakage,
    FaultId::StatorInductance,
    FaultId::RotorInductance,
];
const OF_FRICTION: &[FaultId] = &[FaultId::Friction, FaultId::LoadFriction];

/// Every fault of a campaign.
pub const FAULTS: [FaultKind; 15] = [
    paired(
        against(
            FaultId::RotorResistance.name(),
            [STATOR_RESISTANCE, ROTOR_RESISTANCE],
        ),
        listed(
            FaultId::StatorResistance,
            &[Target::Parameter(Parameter::Rs)],
            STATOR_RESISTANCE,
        ),
    ),
    paired(
        against(
            FaultId::StatorResistance.name(),
            [ROTOR_RESISTANCE, STATOR_RESISTANCE],
        ),
        listed(
            FaultId::RotorResistance,
            &[Target::Parameter(Parameter::Rr)],
            ROTOR_RESISTANCE,
        ),
    ),
    paired(
        against("V", [STATOR_INDUCTANCE, VOLTAGE_SENSORS]),
        listed(
            FaultId::MagnetizingInductance,
            &[Target::Parameter(Parameter::Lm)],
            OF_MAGNETIZING,
        ),
    ),
    motor("Lls", "stator leakage", &[STATOR_LEAKAGE], OF_LEAKAGE),
    motor("Llr", "rotor leakage", &[ROTOR_LEAKAGE], OF_LEAKAGE),
    paired(
        against("V", [STATOR_INDUCTANCE, VOLTAGE_SENSORS]),
        motor(
            FaultId::Leakage.name(),
            "both leakages",
            &[STATOR_LEAKAGE, ROTOR_LEAKAGE],
            OF_LEAKAGE,
        ),
    ),
    listed(
        FaultId::Friction,
        &[Target::Parameter(Parameter::B)],
        OF_FRICTION,
    ),
    listed(
        FaultId::LoadFriction,
        &[Target::Parameter(Parameter::Bl)],
        OF_FRICTION,
    ),
    in_one_phase(motor(
        "Rs-phase",
        "resistance in series with one phase",
        JOINTS,
        STATOR_RESISTANCE,
    )),
    listed(
        FaultId::Bars,
        &[Target::Asymmetry(Asymmetry::RotorBars)],
        &[FaultId::Bars],
    ),
    in_one_phase(sensor(
        "i",
        "gain of one current sensor",
        CURRENTS,
        &[FaultId::CurrentSensor],
    )),
    in_one_phase(sensor(
        "v",
        "gain of one voltage sensor",
        VOLTAGES,
        VOLTAGE_SENSORS,
    )),
    sensor(
        "i-all",
        "gain of all current sensors",
        CURRENTS,
        &[FaultId::CurrentSensor],
    ),
    paired(
        against("L_s", [VOLTAGE_SENSORS, STATOR_INDUCTANCE]),
        sensor(
            "v-all",
            "gain of all voltage sensors",
            VOLTAGES,
            VOLTAGE_SENSORS,
        ),
    ),
    sensor(
        "speed",
        FaultId::SpeedSensor.words(),
        &[Target::Probe(Probe::Speed)],
        &[FaultId::SpeedSensor],
    ),
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
        let fault = |target: &Target| Fault {
            from_s,
            ..Fault::of(*target, percent)
        };
        parts.iter().map(fault).collect()
    }

    /// Whether the monitor names this fault when it says `cause`.
    pub fn is_named_by(&self, cause: FaultId) -> bool {
        self.answers.contains(&cause)
    }

    /// Why a motor cannot have this fault.
    pub fn obstacle(&self, motor: &MotorFile, load_is_free: bool) -> Option<&'static str> {
        match self.parts {
            [Target::Parameter(Parameter::Bl)] if load_is_free => {
                Some("changes nothing where load_kind = \"free\": the load is whatever it is")
            }
            [Target::Parameter(Parameter::B)] if motor.mechanics.friction == 0.0 => {
                Some("changes nothing on a motor whose friction_nm_s is 0")
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::Change;

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
