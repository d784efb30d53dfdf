//! What a stream of reports amounts to: the only place of a campaign that looks into the monitor's answers.

use monitor::{Channel, Lamp, Lamps, MovingCause, NotJudged, Phase, Report, Suspect};

use crate::planned::fault::FaultKind;
use replay::causes::{self, Candidate};
use replay::{MotionSummary, words};

/// Probabilities closer than this are equal: the core computes them in single precision.
const EQUAL: f64 = 1e-3;

/// What the core showed in one run.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Reports.
    pub windows: u32,
    /// Windows judged.
    pub judged: u32,
    /// Windows judged while the motor was healthy.
    pub healthy_judged: u32,
    /// Windows with FAULT lit while the motor was healthy.
    pub healthy_fault: u32,
    /// Time of the first of them, s.
    pub first_false_s: Option<f64>,
    /// Whether FAULT was lit when the fault came.
    pub lit_before: bool,
    /// Time from the fault to FAULT, s; absent where it was lit before.
    pub delay_s: Option<f64>,
    /// Whether FAULT was lit at the end.
    pub lit_at_end: bool,
    /// Windows that were left to motion.
    pub moved: u32,
    /// Of these judged there.
    pub judged_in_motion: u32,
    /// Alarms in motion of the healthy motor that no fault explains: no FAULT, and nothing is called healthy.
    pub healthy_unexplained: u32,
    /// What was named in motion, where FAULT came there first.
    motion_cause: Option<MovingCause>,
    /// Whether FAULT came in motion first.
    pub found_in_motion: bool,
    /// Lamps seen while the motor was healthy, RUN apart.
    pub healthy_lamps: LampsSeen,
    /// Lamps seen with the fault.
    pub faulty_lamps: LampsSeen,
    /// Windows that were not judged, by reason.
    reasons: Vec<(NotJudged, u32)>,
    /// The likely causes when FAULT was lit last and a window named any.
    causes: Vec<Candidate>,
}

/// The monitor's answer, beside the truth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// The likeliest cause and what is tied with it ([`monitor::TIE_RATIO`]), joined by `|`; empty when nothing was said.
    pub named: String,
    /// Phase of the likeliest cause; empty without one.
    pub phase: String,
    /// Probability of the likeliest cause.
    pub probability: f64,
    /// Probability given to the true fault, under all names that are right.
    pub truth: f64,
    /// Whether no wrong cause is as likely as the right one.
    pub name_is_right: bool,
    /// Whether the right cause is among those named.
    pub truth_is_named: bool,
}

impl Outcome {
    /// Adds one report; `t` is the window's end, `fault_from_s` the time of the fault, s.
    pub fn take(&mut self, t: f64, fault_from_s: f64, report: &Report) {
        let healthy = t < fault_from_s;
        let lit = report.lamps.fault == Lamp::On;
        self.windows += 1;
        self.note_judgement(healthy, report.not_judged);
        if healthy {
            self.healthy_lamps.add(&report.lamps);
            self.healthy_fault += u32::from(lit);
            self.lit_before = lit;
            if lit && self.first_false_s.is_none() {
                self.first_false_s = Some(t);
            }
        } else {
            self.faulty_lamps.add(&report.lamps);
            if lit && !self.lit_before && self.delay_s.is_none() {
                self.delay_s = Some(t - fault_from_s);
            }
        }
        self.lit_at_end = lit;
        // Motor's and load's friction are one name here, as in the core.
        let causes = causes::of_report(report, &[], false);
        if !causes.is_empty() {
            self.causes = causes;
        }
    }

    /// Adds a window that was left to motion, and whether it was judged there.
    pub fn take_moved(&mut self, t: f64, fault_from_s: f64, judged: bool) {
        self.moved += 1;
        let judged = u32::from(judged);
        self.judged_in_motion += judged;
        self.judged += judged;
        self.healthy_judged += if t < fault_from_s { judged } else { 0 };
    }

    /// Adds the alarms that came in motion; call it last. One that came before the fault stays on.
    pub fn take_alarms(&mut self, fault_from_s: f64, motion: &MotionSummary) {
        let (alarms, unexplained) = (&motion.alarms, motion.unexplained.iter());
        let healthy = unexplained.filter(|doubt| doubt.raised_s < fault_from_s);
        self.healthy_unexplained = healthy.count() as u32;
        let (early, late): (Vec<_>, Vec<_>) = alarms
            .iter()
            .partition(|alarm| alarm.raised_s < fault_from_s);
        if let Some(first) = early.first() {
            self.healthy_fault += early.len() as u32;
            let at_rest = self.first_false_s.unwrap_or(f64::INFINITY);
            self.first_false_s = Some(first.raised_s.min(at_rest));
            self.lit_before = true;
            self.delay_s = None;
            return;
        }
        let Some(first) = late.first().filter(|_| !self.lit_before) else {
            return;
        };
        let delay_s = first.raised_s - fault_from_s;
        if self.delay_s.is_none_or(|at_rest| delay_s < at_rest) {
            self.delay_s = Some(delay_s);
            self.found_in_motion = true;
            self.motion_cause = first.cause;
        }
    }

    fn note_judgement(&mut self, healthy: bool, not_judged: Option<NotJudged>) {
        let Some(reason) = not_judged else {
            self.judged += 1;
            self.healthy_judged += u32::from(healthy);
            return;
        };
        match self.reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, count)) => *count += 1,
            None => self.reasons.push((reason, 1)),
        }
    }

    /// Why most of the windows that were not judged were not; empty when all were.
    pub fn main_reason(&self) -> String {
        let most = self.reasons.iter().max_by_key(|(_, count)| *count);
        most.map_or(String::new(), |(reason, _)| words::not_judged(*reason))
    }

    /// What the monitor said last, beside the fault that was there.
    pub fn answer(&self, truth: Option<&FaultKind>) -> Answer {
        if let Some(cause) = self.motion_cause {
            return answer_in_motion(cause, truth);
        }
        let causes = &self.causes;
        let is_right = |cause: &Candidate| truth.is_some_and(|kind| kind.is_named_by(cause.fault));
        let largest = |right: bool| {
            let of_kind = causes.iter().filter(|cause| is_right(cause) == right);
            of_kind.map(|cause| cause.probability).fold(0.0, f64::max)
        };
        let first = &causes[..causes::tied(causes)];
        let truth_is_named = first.iter().any(is_right);
        let right = causes.iter().filter(|cause| is_right(cause));
        Answer {
            named: first
                .iter()
                .map(|cause| cause.fault.name())
                .collect::<Vec<_>>()
                .join("|"),
            phase: first
                .first()
                .and_then(|cause| cause.phase)
                .unwrap_or("")
                .to_owned(),
            probability: largest(true).max(largest(false)),
            truth: right.map(|cause| cause.probability).sum(),
            name_is_right: largest(true) > largest(false) + EQUAL,
            truth_is_named,
        }
    }
}

/// What was named in motion: one cause, or none of a size that occurs.
fn answer_in_motion(cause: MovingCause, truth: Option<&FaultKind>) -> Answer {
    let suspect = match cause {
        MovingCause::Departure(cause) => Suspect::Cause(cause),
        MovingCause::Dead(finding) => Suspect::Channel(Channel::of(finding)),
    };
    let right = truth.is_some_and(|kind| kind.is_named_by(suspect.fault()));
    Answer {
        named: suspect.fault().name().to_owned(),
        phase: suspect.phase().map_or("", Phase::letter).to_owned(),
        probability: 1.0,
        truth: if right { 1.0 } else { 0.0 },
        name_is_right: right,
        truth_is_named: right,
    }
}

/// Lamps that were on at any time, RUN apart.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LampsSeen(Vec<&'static str>);

impl LampsSeen {
    fn add(&mut self, lamps: &Lamps) {
        for name in lamps.lit_names() {
            if !self.0.contains(&name) {
                self.0.push(name);
            }
        }
    }
}

impl std::fmt::Display for LampsSeen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use monitor::{Candidates, SensorFinding};

    fn report(fault: bool, candidates: Option<Candidates>) -> Report {
        Report {
            lamps: Lamps {
                fault: Lamp::lit(fault),
                ..Lamps::default()
            },
            candidates,
            ..Report::default()
        }
    }

    #[test]
    fn delay_counts_from_the_fault_and_false_alarms_before_it() {
        let mut outcome = Outcome::default();
        for (t, lit) in [
            (0.1, false),
            (0.2, false),
            (0.3, false),
            (0.4, true),
            (0.5, true),
        ] {
            outcome.take(t, 0.25, &report(lit, None));
        }
        assert!(
            outcome
                .delay_s
                .is_some_and(|delay| (delay - 0.15).abs() < 1e-12)
        );
        assert_eq!((outcome.healthy_judged, outcome.healthy_fault), (2, 0));
        let mut early = Outcome::default();
        for t in [0.1, 0.2, 0.3] {
            early.take(t, 0.25, &report(true, None));
        }
        assert_eq!((early.healthy_fault, early.delay_s), (2, None));
        assert!(early.lit_before && early.first_false_s == Some(0.1));
    }

    #[test]
    fn a_tie_with_a_wrong_cause_is_not_right_and_both_are_named() {
        // The pattern of Rs and Rr.
        let tie = Candidates::from_normalised(&[3.0, 0.0, 0.1, 3.0]);
        let mut outcome = Outcome::default();
        outcome.take(1.0, 0.5, &report(true, Some(tie)));
        let answer = outcome.answer(FaultKind::find("Rs"));
        assert_eq!(
            (answer.named.as_str(), answer.name_is_right),
            ("Rs|Rr", false)
        );
        assert!((0.45..0.5).contains(&answer.truth));
        // The pattern of the speed sensor belongs to it alone.
        let alone = Candidates::from_normalised(&[3.0, 3.0, 0.1, 3.0]);
        outcome.take(1.1, 0.5, &report(true, Some(alone)));
        assert!(outcome.answer(FaultKind::find("speed")).name_is_right);
        assert!(!outcome.answer(FaultKind::find("Rs")).name_is_right);
    }

    #[test]
    fn a_dead_sensor_is_named_with_its_phase() {
        let mut outcome = Outcome::default();
        let finding = SensorFinding::DeadCurrent(monitor::Phase::B);
        let report = Report {
            sensor: Some(finding),
            ..report(true, None)
        };
        outcome.take(1.0, 0.5, &report);
        let answer = outcome.answer(FaultKind::find("i"));
        assert_eq!((answer.phase.as_str(), answer.name_is_right), ("b", true));
    }
}
