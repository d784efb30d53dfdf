//! `[[faults]]`: what breaks, how far, and when.

use super::PlantKind;
use document::{Bounds, Section};
use motor::FaultId;
use motor::motor_file::Frame;

/// A parameter of the motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Stator resistance.
    Rs,
    /// Rotor resistance.
    Rr,
    /// Stator inductance of the linear model.
    Ls,
    /// Rotor inductance of the linear model.
    Lr,
    /// Stator leakage of the full motor.
    Lls,
    /// Rotor leakage of the full motor.
    Llr,
    /// Magnetizing inductance of the full motor.
    Lm,
    /// Viscous friction of the motor.
    B,
    /// Load friction.
    Bl,
}

/// A signal behind the d-q transformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DqSignal {
    /// Current along d.
    Id,
    /// Current along q.
    Iq,
    /// Voltage along d.
    Vd,
    /// Voltage along q.
    Vq,
}

/// A single sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Voltage of a phase, 0..=2.
    Voltage(usize),
    /// Current of a phase, 0..=2.
    Current(usize),
    /// Shaft speed: encoder and tachometer alike.
    Speed,
}

/// What is no longer alike in all three phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asymmetry {
    /// Resistance in series with one phase, 0..=2, as a share of the stator resistance.
    Series(usize),
    /// Broken rotor bars: the asymmetry of the rotor resistance.
    RotorBars,
}

/// What breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// The motor itself.
    Parameter(Parameter),
    /// The symmetry of the motor.
    Asymmetry(Asymmetry),
    /// A d-q signal, the published way: the other component and the angle stay.
    Dq(DqSignal, Frame),
    /// One sensor.
    Probe(Probe),
}

/// How it breaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Multiplied by this factor; 0 is a dead sensor.
    Factor(f64),
    /// Shifted by this much in the sensor's own unit (V, A, rad/s).
    Offset(f64),
}

/// One fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What breaks.
    pub target: Target,
    /// How.
    pub change: Change,
    /// When it begins, s.
    pub from_s: f64,
    /// When it ends, s; infinite when it stays.
    pub to_s: f64,
}

impl Target {
    /// What to break for a fault of the catalogue, d-q signals in `frame`; `None` for one that cannot be simulated as one
    /// change.
    pub const fn of(fault: FaultId, frame: Frame) -> Option<Target> {
        Some(match fault {
            FaultId::StatorResistance => Target::Parameter(Parameter::Rs),
            FaultId::RotorResistance => Target::Parameter(Parameter::Rr),
            FaultId::StatorInductance => Target::Parameter(Parameter::Ls),
            FaultId::RotorInductance => Target::Parameter(Parameter::Lr),
            FaultId::MagnetizingInductance => Target::Parameter(Parameter::Lm),
            FaultId::Friction => Target::Parameter(Parameter::B),
            FaultId::LoadFriction => Target::Parameter(Parameter::Bl),
            FaultId::Bars => Target::Asymmetry(Asymmetry::RotorBars),
            FaultId::CurrentSensor => Target::Dq(DqSignal::Iq, frame),
            FaultId::VoltageSensor => Target::Dq(DqSignal::Vq, frame),
            FaultId::SpeedSensor => Target::Probe(Probe::Speed),
            FaultId::Leakage | FaultId::Turns | FaultId::Unknown => return None,
        })
    }
}

impl Fault {
    /// A fault by its name, with a change in percent, from the beginning to the end; d-q signals in `frame`.
    pub fn percent(name: &str, change_percent: f64, frame: Frame) -> Option<Fault> {
        let (_, target) = NAMES.iter().find(|(known, _)| *known == name)?;
        Some(Fault::of(in_frame(*target, frame), change_percent))
    }

    /// A change of a target in percent, from the beginning to the end.
    pub fn of(target: Target, change_percent: f64) -> Fault {
        Fault {
            target,
            change: Change::Factor(1.0 + change_percent / 100.0),
            from_s: 0.0,
            to_s: f64::INFINITY,
        }
    }

    /// Whether the fault is present at time `t`, s.
    pub fn is_active(&self, t: f64) -> bool {
        (self.from_s..self.to_s).contains(&t)
    }

    /// How far a parameter or gain is from its healthy value, as a share of it; an offset has none.
    pub fn share(&self) -> f64 {
        match self.change {
            Change::Factor(factor) => factor - 1.0,
            Change::Offset(_) => 0.0,
        }
    }

    /// What becomes of a value while the fault is present.
    pub fn apply(&self, x: f64) -> f64 {
        match self.change {
            Change::Factor(factor) => x * factor,
            Change::Offset(offset) => x + offset,
        }
    }
}

/// Every fault by its name in files; d-q signals stand with the paper's frame until the file says otherwise.
const NAMES: [(&str, Target); 25] = [
    known(FaultId::StatorResistance),
    known(FaultId::RotorResistance),
    known(FaultId::StatorInductance),
    known(FaultId::RotorInductance),
    ("Lls", Target::Parameter(Parameter::Lls)),
    ("Llr", Target::Parameter(Parameter::Llr)),
    known(FaultId::MagnetizingInductance),
    known(FaultId::Friction),
    known(FaultId::LoadFriction),
    ("Rsa", Target::Asymmetry(Asymmetry::Series(0))),
    ("Rsb", Target::Asymmetry(Asymmetry::Series(1))),
    ("Rsc", Target::Asymmetry(Asymmetry::Series(2))),
    known(FaultId::Bars),
    ("Id", Target::Dq(DqSignal::Id, Frame::Voltage)),
    known(FaultId::CurrentSensor),
    ("Vd", Target::Dq(DqSignal::Vd, Frame::Voltage)),
    known(FaultId::VoltageSensor),
    known(FaultId::SpeedSensor),
    ("va", Target::Probe(Probe::Voltage(0))),
    ("vb", Target::Probe(Probe::Voltage(1))),
    ("vc", Target::Probe(Probe::Voltage(2))),
    ("ia", Target::Probe(Probe::Current(0))),
    ("ib", Target::Probe(Probe::Current(1))),
    ("ic", Target::Probe(Probe::Current(2))),
    ("speed", Target::Probe(Probe::Speed)),
];

/// A fault of the catalogue under its name there.
const fn known(fault: FaultId) -> (&'static str, Target) {
    match Target::of(fault, Frame::Voltage) {
        Some(target) => (fault.name(), target),
        None => panic!("not one change of the motor"),
    }
}

const FRAMES: [(&str, Frame); 2] = [
    ("voltage", Frame::Voltage),
    ("rotor-flux", Frame::RotorFlux),
];
const PERCENT: Bounds = Bounds::above(-100.0, 1000.0, "percent")
    .hint("-50 halves it; a sensor that is off is dead = true");
const GAIN: Bounds = Bounds::between(-10.0, 10.0, "").hint("1 is healthy, 0.9 reads 10 % low");
const OFFSET: Bounds = Bounds::between(-1e6, 1e6, "in V, A or rad/s");
const TIME: Bounds = Bounds::between(0.0, 86_400.0, "s");

pub(super) fn read(root: &Section<'_>, plant: PlantKind) -> Option<Vec<Fault>> {
    let sections = root.sections("faults")?;
    sections
        .into_iter()
        .map(|section| read_fault(section, plant))
        .collect()
}

fn read_fault(section: Section<'_>, plant: PlantKind) -> Option<Fault> {
    let choice: [_; NAMES.len()] = std::array::from_fn(|i| (NAMES[i].0, i));
    let index = section.choice("fault", &choice);
    let target = index.and_then(|i| read_target(&section, NAMES[i].0, NAMES[i].1, plant));
    let change = read_change(&section, index.map(|i| NAMES[i].1));
    let from = section.number_or("from_s", &TIME, 0.0);
    let to = section.optional_number("to_s", &TIME);
    if let (Some(from), Some(Some(to))) = (from, to)
        && to <= from
    {
        section.report(
            "to_s",
            format!("{to} s is not after from_s = {from}: write a later time, or leave it out"),
        );
    }
    section.finish();
    Some(Fault {
        target: target?,
        change: change?,
        from_s: from?,
        to_s: to?.unwrap_or(f64::INFINITY),
    })
}

/// Refuses a parameter that the plant does not have; gives d-q signals their frame.
fn read_target(
    section: &Section<'_>,
    name: &str,
    target: Target,
    plant: PlantKind,
) -> Option<Target> {
    use Parameter::{Llr, Lls, Lm, Lr, Ls};
    let remedy = match (target, plant) {
        (Target::Parameter(Ls), PlantKind::Full) => "\"Lls\" or \"Lm\"",
        (Target::Parameter(Lr), PlantKind::Full) => "\"Llr\" or \"Lm\"",
        (Target::Parameter(Lls | Llr | Lm), PlantKind::Linear) => "\"Ls\" or \"Lr\"",
        (Target::Asymmetry(_), PlantKind::Linear) => "\"Rs\" or \"Rr\", or plant = \"full\"",
        (Target::Dq(..), _) => {
            let frame = section.choice_or("frame", &FRAMES, Frame::Voltage)?;
            return Some(in_frame(target, frame));
        }
        _ => return Some(target),
    };
    let plant = match plant {
        PlantKind::Full => "full motor",
        PlantKind::Linear => "linear model",
    };
    section.report(
        "fault",
        format!("the {plant} has no \"{name}\" of its own: write {remedy}"),
    );
    None
}

fn in_frame(target: Target, frame: Frame) -> Target {
    match target {
        Target::Dq(signal, _) => Target::Dq(signal, frame),
        other => other,
    }
}

/// Exactly one of `change_percent`, and for single sensors also `gain`, `offset`, `dead`.
fn read_change(section: &Section<'_>, target: Option<Target>) -> Option<Change> {
    let percent = section.optional_number("change_percent", &PERCENT);
    let mut changes: Vec<_> = percent?
        .map(|percent| Change::Factor(1.0 + percent / 100.0))
        .into_iter()
        .collect();
    let mut keys = "change_percent";
    if matches!(target, Some(Target::Probe(_))) {
        keys = "change_percent, gain, offset and dead = true";
        let gain = section.optional_number("gain", &GAIN);
        let offset = section.optional_number("offset", &OFFSET);
        let dead = section.flag_or("dead", false);
        changes.extend(gain?.map(Change::Factor));
        changes.extend(offset?.map(Change::Offset));
        changes.extend(dead?.then_some(Change::Factor(0.0)));
    }
    match (changes.as_slice(), target) {
        ([change], _) => check_change(section, *change),
        // The name is wrong already: what it could change is not known.
        (_, None) => None,
        // `finish` refuses those keys, and that is the remedy.
        ([], Some(Target::Parameter(_) | Target::Asymmetry(_) | Target::Dq(..)))
            if ["gain", "offset", "dead"]
                .iter()
                .any(|key| section.has(key)) =>
        {
            None
        }
        (found, Some(_)) => {
            let count = found.len();
            section.report(
                "change_percent",
                format!("{count} changes are given: give exactly one of {keys}"),
            );
            None
        }
    }
}

fn check_change(section: &Section<'_>, change: Change) -> Option<Change> {
    if change == Change::Factor(1.0) || change == Change::Offset(0.0) {
        section.report(
            "change_percent",
            "this fault changes nothing: give a change, or remove the fault",
        );
        return None;
    }
    Some(change)
}
