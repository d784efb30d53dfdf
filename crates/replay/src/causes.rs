//! Likely causes as people read them: what the core makes of an alarm, in order, with ties, sizes and what to do.
//!
//! Terminal, report, panel and campaign all ask here, and the board asks the same function of the core.

use std::fmt;

use audit::{Code, Finding};
use monitor::{Channel, FaultId, Known, Lamp, Phase, Report, Suspicion, likely};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

/// Causes less likely than this are not listed.
const LEAST_PROBABILITY: f64 = 0.01;

/// One possible cause.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Candidate {
    /// What is wrong.
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "String")]
    pub fault: FaultId,
    /// The phase, where it is known.
    pub phase: Option<&'static str>,
    /// Probability, 0..=1.
    pub probability: f64,
    /// Change that explains the windows best, percent of the healthy value, on a calibrated motor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_percent: Option<f64>,
}

fn by_name<S: Serializer>(fault: &FaultId, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(fault.name())
}

/// Candidates in the order of probability; `load_friction` splits friction between motor and load, whose sum alone
/// ever appears.
pub fn candidates(known: &Known<'_>, load_friction: bool) -> Vec<Candidate> {
    ranked(load_friction, &mut |tell| known.weigh(tell))
}

/// The same of one window; empty while FAULT is dark.
pub fn of_report(report: &Report, wrong: &[Channel], load_friction: bool) -> Vec<Candidate> {
    if report.shown_lamps().fault != Lamp::On {
        return Vec::new();
    }
    ranked(load_friction, &mut |tell| likely(report, wrong, tell))
}

/// What is told of one suspicion after the other.
type Tell<'a> = dyn FnMut(Suspicion) + 'a;

fn ranked(load_friction: bool, weigh: &mut dyn FnMut(&mut Tell<'_>)) -> Vec<Candidate> {
    let mut all = Vec::new();
    let mut table = false;
    weigh(&mut |suspicion| {
        table |= matches!(suspicion.suspect, monitor::Suspect::Row(_));
        all.push(Candidate::of(&suspicion));
    });
    if load_friction && !table {
        split_friction(&mut all);
    }
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}

/// Puts broken bars first, as likely as all other causes together: bars shake every window, and what a shaken window says of other
/// causes may be theirs.
pub fn suspect_bars(candidates: &mut Vec<Candidate>) {
    for candidate in candidates.iter_mut() {
        candidate.probability *= 0.5;
    }
    let bars = Candidate {
        fault: FaultId::Bars,
        phase: None,
        probability: 0.5,
        size_percent: None,
    };
    candidates.insert(0, bars);
}

/// Those that are worth a line.
pub fn listed(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.retain(|candidate| candidate.probability >= LEAST_PROBABILITY);
    candidates
}

/// Where the load is friction, motor and load share what the direction of the evidence says of their sum.
fn split_friction(all: &mut Vec<Candidate>) {
    let Some(sum) = all
        .iter_mut()
        .find(|candidate| candidate.fault == FaultId::Friction)
    else {
        return;
    };
    sum.probability *= 0.5;
    let load = Candidate {
        fault: FaultId::LoadFriction,
        ..sum.clone()
    };
    all.push(load);
}

impl fmt::Display for Candidate {
    /// Cause, phase and size.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.fault.words())?;
        if let Some(phase) = self.phase {
            write!(f, ", phase {phase}")?;
        }
        if let Some(size) = self.size_percent {
            write!(f, ", {size:+.1} %")?;
        }
        Ok(())
    }
}

impl Candidate {
    fn of(suspicion: &Suspicion) -> Candidate {
        Candidate {
            fault: suspicion.suspect.fault(),
            phase: suspicion.suspect.phase().map(Phase::letter),
            probability: f64::from(suspicion.probability),
            size_percent: suspicion.size.map(|size| 100.0 * f64::from(size)),
        }
    }
}

/// How many candidates, from the first, cannot be told apart; 1 where the first stands alone.
pub fn tied(candidates: &[Candidate]) -> usize {
    let best = candidates.first().map_or(0.0, |first| first.probability);
    let least = best / f64::from(monitor::TIE_RATIO);
    let is_tied = |candidate: &&Candidate| candidate.probability > least;
    candidates.iter().take_while(is_tied).count()
}

/// What to do about causes that cannot be told apart, each step once. A motor that was not calibrated is asked first
/// whether it is merely warm: the calibration knows heat.
pub fn todo(causes: &[FaultId], calibrated: bool) -> Vec<&'static str> {
    let mut steps = Vec::new();
    if !calibrated {
        let first = causes.iter().find_map(|cause| cause.first_advice());
        steps.extend(first);
    }
    steps.extend(tests_of(causes.iter().copied()));
    if steps.is_empty() && !causes.is_empty() {
        steps.push("is it this motor's file? Then look at the residuals and the recording itself");
    }
    steps
}

/// What would prove or clear each of these causes, each test once.
pub fn tests(candidates: &[Candidate]) -> Vec<&'static str> {
    tests_of(candidates.iter().map(|candidate| candidate.fault))
}

fn tests_of(causes: impl Iterator<Item = FaultId>) -> Vec<&'static str> {
    let mut tests = Vec::new();
    for test in causes.filter_map(FaultId::separating_test) {
        if !tests.contains(&test) {
            tests.push(test);
        }
    }
    tests
}

/// Name of the channel of the speed.
const SPEED: &str = "speed";

/// The channels that an audit knows to be wrong all the time from `from_s` to `to_s`; what a channel did for a part of it
/// the windows of that part say themselves.
pub fn wrong_channels(findings: &[Finding], [from_s, to_s]: [f64; 2]) -> Vec<Channel> {
    let concerns = |finding: &&Finding| {
        finding.to_s.is_none_or(|end_s| end_s >= to_s)
            && finding.from_s.is_none_or(|begin_s| begin_s <= from_s)
    };
    let mut channels: Vec<Channel> = Vec::new();
    for channel in findings.iter().filter(concerns).filter_map(wrong_channel) {
        if !channels.contains(&channel) {
            channels.push(channel);
        }
    }
    channels
}

/// Findings that bend what is measured. A neutral that is displaced shifts all three voltages alike, which the monitor
/// does not see; an offset it subtracts; samples that clip it does not judge; a counter or a bus holds the speed, which is right while the motor
/// runs steadily.
fn wrong_channel(finding: &Finding) -> Option<Channel> {
    match finding.code {
        Code::Held if finding.channel == SPEED => None,
        Code::ZeroSequence => channel(finding.suspect.as_deref().unwrap_or(&finding.channel))
            .filter(|channel| channel.row == FaultId::CurrentSensor || finding.suspect.is_some()),
        Code::Stuck | Code::Held | Code::Polarity | Code::SpeedImplausible => {
            channel(&finding.channel)
        }
        _ => None,
    }
}

/// A sensor by the name of its channel, or of several channels separated by blanks.
fn channel(names: &str) -> Option<Channel> {
    let mut each = names.split_whitespace();
    let (first, more) = (each.next()?, each.next().is_some());
    let (quantity, phase) = first.split_at_checked(1)?;
    let row = match (first, quantity) {
        (SPEED, _) => FaultId::SpeedSensor,
        (_, "i") => FaultId::CurrentSensor,
        (_, "v") => FaultId::VoltageSensor,
        _ => return None,
    };
    let phase = Phase::ALL.into_iter().find(|known| known.letter() == phase);
    Some(Channel {
        row,
        phase: phase.filter(|_| !more),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use monitor::{Candidates, SensorFinding};

    fn report(normalised: [f32; 4]) -> Report {
        let mut report = Report {
            candidates: Some(Candidates::from_normalised(&normalised)),
            ..Report::default()
        };
        report.lamps.fault = Lamp::On;
        report
    }

    #[test]
    fn resistances_are_one_tie_and_nothing_is_named_in_the_dark() {
        let mut report = report([3.0, 0.0, 0.1, 3.0]);
        let causes = of_report(&report, &[], true);
        let names: Vec<_> = causes[..tied(&causes)].iter().map(|c| c.fault).collect();
        assert_eq!(
            names,
            [FaultId::StatorResistance, FaultId::RotorResistance],
            "{causes:?}"
        );
        assert!((0.45..0.5).contains(&causes[0].probability));
        report.lamps.fault = Lamp::Off;
        assert!(of_report(&report, &[], true).is_empty());
    }

    #[test]
    fn suspected_bars_are_tied_with_the_likeliest_of_the_others() {
        let mut causes = of_report(&report([3.0, 3.0, 3.0, 0.0]), &[], true);
        suspect_bars(&mut causes);
        assert_eq!(causes[0].fault, FaultId::Bars);
        assert_eq!(
            (causes[1].fault, tied(&causes)),
            (FaultId::CurrentSensor, 2)
        );
        let sum: f64 = causes.iter().map(|cause| cause.probability).sum();
        // Ten probabilities in single precision.
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    }

    #[test]
    fn a_row_of_its_own_is_no_tie() {
        let causes = of_report(&report([3.0, 3.0, 3.0, 0.0]), &[], true);
        assert_eq!(
            (causes[0].fault, tied(&causes)),
            (FaultId::CurrentSensor, 1)
        );
    }

    #[test]
    fn a_dead_sensor_is_the_cause_of_its_fault() {
        let mut report = Report {
            sensor: Some(SensorFinding::DeadCurrent(Phase::A)),
            ..Report::default()
        };
        report.lamps.fault = Lamp::On;
        let causes = of_report(&report, &[], true);
        assert_eq!(
            (causes[0].fault, causes[0].phase),
            (FaultId::CurrentSensor, Some("a"))
        );
        assert_eq!((causes.len(), causes[0].probability), (1, 1.0));
    }

    /// A counter shows its last count until the next one: the speed is right at rest. A current that is held is a wrong current.
    #[test]
    fn a_speed_that_is_held_is_no_wrong_channel() {
        let held = |channel: &str| Finding {
            code: Code::Held,
            channel: channel.to_owned(),
            suspect: None,
            value: 50.0,
            unit: "rows".to_owned(),
            detail: String::new(),
            refuses: false,
            from_s: None,
            to_s: None,
            share: None,
        };
        let wrong = wrong_channels(&[held("speed"), held("ib")], [0.0, f64::INFINITY]);
        let rows: Vec<_> = wrong.iter().map(|channel| channel.row).collect();
        assert_eq!(rows, [FaultId::CurrentSensor]);
    }

    #[test]
    fn channels_are_found_by_their_names() {
        let of = |names| channel(names).map(|channel| (channel.row, channel.phase));
        assert_eq!(of("ia"), Some((FaultId::CurrentSensor, Some(Phase::A))));
        assert_eq!(of("ia ib ic"), Some((FaultId::CurrentSensor, None)));
        assert_eq!(of("vc"), Some((FaultId::VoltageSensor, Some(Phase::C))));
        assert_eq!(of("speed"), Some((FaultId::SpeedSensor, None)));
        assert_eq!((of("torque"), of("")), (None, None));
    }
}
