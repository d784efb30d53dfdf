//! The answer in words: one wording for terminal, page and panel.

use motor::FaultId;
use schemars::JsonSchema;
use serde::Serialize;

use super::Checked;
use super::blind::NOT_CALIBRATED;
use crate::{MotionFault, VerdictState};

/// What a technician reads first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Told {
    /// The state.
    pub state: &'static str,
    /// The likeliest cause with phase and size, where there is a fault.
    pub cause: Option<String>,
    /// How sure that is, or how much was looked at.
    pub sure: String,
    /// How bad a fault is and what that means for the plant, or why that is not known.
    pub severity: Option<&'static str>,
}

impl Told {
    pub(super) fn of(checked: &Checked) -> Told {
        let verdict = &checked.verdict;
        let at_rest = verdict.state == VerdictState::Fault;
        let likeliest = verdict.candidates.first().filter(|_| at_rest);
        let in_motion = checked.motion.alarms.first().filter(|_| !at_rest);
        Told {
            state: state(checked),
            cause: likeliest
                .map(|_| causes_in_words(checked))
                .or_else(|| in_motion.and_then(MotionFault::words)),
            sure: match (checked.state, in_motion) {
                (VerdictState::Fault, Some(alarm)) => sure_in_motion(alarm),
                (VerdictState::Fault, None) => with_caveat(checked, sure_of_cause(checked)),
                (VerdictState::Healthy, _) => looked_at(checked),
                (VerdictState::NotJudged, _) => why_not(checked),
            },
            severity: likeliest
                .map(|cause| cause.fault)
                .or_else(|| in_motion.and_then(MotionFault::fault))
                .and_then(|fault| severity(checked, fault)),
        }
    }
}

/// The likeliest cause, or all that cannot be told apart.
fn causes_in_words(checked: &Checked) -> String {
    /// Names that are read at one glance.
    const MOST: usize = 4;
    let causes = &checked.verdict.candidates;
    let tied = causes.iter().take(checked.verdict.tied.max(1));
    let names: Vec<String> = tied.map(ToString::to_string).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) if names.len() <= MOST => {
            format!("{} or {last}", others.join(", "))
        }
        _ => format!("one of {} causes", names.len()),
    }
}

fn state(checked: &Checked) -> &'static str {
    let does_not_fit = !checked.doubts.is_empty() || !checked.motion.unexplained.is_empty();
    match checked.state {
        VerdictState::NotJudged if does_not_fit => "something does not fit",
        VerdictState::Healthy => "in good order, as far as can be seen here",
        VerdictState::NotJudged => "not judged",
        VerdictState::Fault => "fault",
    }
}

/// The probability of the likeliest cause, and what else it may be.
fn sure_of_cause(checked: &Checked) -> String {
    let causes = &checked.verdict.candidates;
    let Some(first) = causes.first() else {
        return "the cause is not known".to_owned();
    };
    let percent = 100.0 * first.probability;
    match (checked.verdict.tied, causes.get(1)) {
        (2.., _) => format!(
            "{percent:.1} %; the first {} causes of the list cannot be told apart with this recording",
            checked.verdict.tied
        ),
        (_, Some(next)) => format!(
            "{percent:.1} %; the next possible cause: {next}, {:.1} %",
            100.0 * next.probability
        ),
        (_, None) => format!("{percent:.1} %; no other cause of the list explains it"),
    }
}

fn with_caveat(checked: &Checked, sure: String) -> String {
    match &checked.caveat {
        Some(caveat) => format!("{sure}; {caveat}"),
        None => sure,
    }
}

/// When an alarm came in motion, and how far it stands out.
fn sure_in_motion(alarm: &MotionFault) -> String {
    let cause = match alarm.cause {
        Some(_) => "",
        None => "; the motion was over before its cause could be told",
    };
    format!(
        "it came in motion, from about {:.2} s on (T = {:.1}){cause}",
        alarm.onset_s, alarm.statistic
    )
}

fn severity(checked: &Checked, fault: FaultId) -> Option<&'static str> {
    let sensors = [
        FaultId::CurrentSensor,
        FaultId::VoltageSensor,
        FaultId::SpeedSensor,
    ];
    match checked.severity {
        Some(severity) => Some(severity.words()),
        None if sensors.contains(&fault) && checked.caveat.is_some() => Some(
            "not known: an instrument or the motor, whose parameters are not known well enough to tell",
        ),
        None if sensors.contains(&fault) => Some("an instrument is wrong, not the motor"),
        None if checked.blind.contains(&NOT_CALIBRATED) => {
            Some("not known: a size is told once a recording in good order was given")
        }
        None => None,
    }
}

/// What a dark answer rests on.
fn looked_at(checked: &Checked) -> String {
    let [judged, windows] = checked.windows;
    if judged == 0 && checked.motion.judged > 0 {
        let motion = &checked.motion;
        return format!(
            "{} of {} windows judged in motion, none at rest",
            motion.judged, motion.windows
        );
    }
    match checked.visible_percent {
        Some([r1, ..]) => format!(
            "{judged} of {windows} windows judged; the voltage balance (r1) shows a departure of {} % and more",
            two_digits(r1)
        ),
        None => {
            format!("{judged} of {windows} windows judged, by the unbalance of the currents alone")
        }
    }
}

/// As exact as a limit is known, percent.
pub fn two_digits(percent: f64) -> String {
    match percent {
        x if x < 1.0 => format!("{x:.2}"),
        x if x < 10.0 => format!("{x:.1}"),
        x => format!("{x:.0}"),
    }
}

fn why_not(checked: &Checked) -> String {
    let refusal = checked
        .audit
        .findings
        .iter()
        .find(|finding| finding.refuses);
    if let Some(doubt) = checked.motion.unexplained.first() {
        return format!(
            "in motion something does not fit, from about {:.2} s on: {}",
            doubt.onset_s,
            doubt.doubt()
        );
    }
    if let (Some(doubt), None) = (checked.doubts.first(), refusal) {
        return doubt.seen.clone();
    }
    let first = checked.not_judged.first();
    let why = refusal.map(|finding| &finding.detail).or(first);
    why.map_or("nothing in it can be judged".to_owned(), Clone::clone)
}
