//! What may be wrong, in the order of probability, ties marked as ties.

use monitor::{ALL_CAUSES, Candidates, Cause, Isolation, Lamp, Phase, Report, TABLE_1};
use serde::Serialize;

use crate::words;

/// Causes less likely than this are not shown.
const LEAST_PROBABILITY: f32 = 0.01;
/// Probabilities of one pattern differ by no more than their rounding.
const TIE: f32 = 1e-6;

/// One possible cause.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LikelyCause {
    /// Row of Table 1, a cause of a calibrated motor, or `unknown`.
    pub name: &'static str,
    /// The same in plain words.
    pub words: &'static str,
    /// `a`, `b` or `c`, where the cause has a phase.
    pub phase: Option<&'static str>,
    /// Probability, percent.
    pub probability_percent: f32,
    /// Change of the quantity that explains the window best, percent; only of a calibrated motor.
    pub size_percent: Option<f32>,
    /// Causes with the same number cannot be told apart; `None` for one that stands alone.
    pub tie: Option<u32>,
}

/// Everything that may have lit FAULT, the likeliest first; empty while it is dark.
pub fn likely_causes(report: &Report, load_friction: bool) -> Vec<LikelyCause> {
    let fault = report.lamps.fault == Lamp::On;
    let mut causes = match (&report.isolation, &report.candidates) {
        _ if !fault => return Vec::new(),
        _ if report.rotor.is_broken => vec![cause("bars", None, 1.0, None)],
        (Some(isolation), _) => isolated(isolation, load_friction),
        (None, Some(candidates)) => rows(candidates),
        (None, None) => Vec::new(),
    };
    causes.retain(|cause| cause.probability_percent >= 100.0 * LEAST_PROBABILITY);
    causes.sort_by(|a, b| b.probability_percent.total_cmp(&a.probability_percent));
    mark_ties(&mut causes);
    causes
}

fn cause(name: &'static str, phase: Option<Phase>, p: f32, size: Option<f32>) -> LikelyCause {
    LikelyCause {
        name,
        words: words::fault(name),
        phase: phase.map(Phase::letter),
        probability_percent: 100.0 * p,
        size_percent: size.map(|size| 100.0 * size),
        tie: None,
    }
}

fn rows(candidates: &Candidates) -> Vec<LikelyCause> {
    let rows = TABLE_1.iter().zip(candidates.faults);
    rows.map(|((fault, _), p)| cause(fault.name(), None, p, None))
        .chain([cause("unknown", None, candidates.unknown, None)])
        .collect()
}

/// Friction of motor and load only ever appear as their sum: where the load is friction they share the probability.
fn isolated(isolation: &Isolation, load_friction: bool) -> Vec<LikelyCause> {
    let (probabilities, unknown) = isolation.probabilities();
    let mut causes = vec![cause("unknown", None, unknown, None)];
    for ((kind, p), size) in ALL_CAUSES
        .into_iter()
        .zip(probabilities)
        .zip(isolation.sizes)
    {
        if kind == Cause::Friction && load_friction {
            causes.extend(["B", "Bl"].map(|name| cause(name, None, 0.5 * p, Some(size))));
        } else {
            causes.push(cause(kind.name(), kind.phase(), p, Some(size)));
        }
    }
    causes
}

/// Neighbours in the order of probability that are equal to rounding.
fn mark_ties(causes: &mut [LikelyCause]) {
    let mut number = 0;
    for k in 1..causes.len() {
        let (before, this) = (
            causes[k - 1].probability_percent,
            causes[k].probability_percent,
        );
        if before - this > 100.0 * TIE {
            continue;
        }
        let tie = causes[k - 1].tie.unwrap_or_else(|| {
            number += 1;
            number
        });
        causes[k - 1].tie = Some(tie);
        causes[k].tie = Some(tie);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(normalised: [f32; 4]) -> Report {
        let mut report = Report {
            candidates: Some(Candidates::from_normalised(&normalised)),
            ..Report::default()
        };
        report.lamps.fault = Lamp::On;
        report
    }

    #[test]
    fn resistances_are_one_tie_and_nothing_is_shown_in_the_dark() {
        let mut report = report([3.0, 0.0, 0.1, 3.0]);
        let causes = likely_causes(&report, true);
        let tied: Vec<_> = causes.iter().filter(|cause| cause.tie == Some(1)).collect();
        let names: Vec<_> = tied.iter().map(|cause| cause.name).collect();
        assert_eq!(names, ["Rs", "Rr"], "{causes:?}");
        assert!((45.0..50.0).contains(&tied[0].probability_percent));
        report.lamps.fault = Lamp::Off;
        assert!(likely_causes(&report, true).is_empty());
    }

    #[test]
    fn a_row_of_its_own_is_no_tie() {
        let causes = likely_causes(&report([3.0, 3.0, 3.0, 0.0]), true);
        assert_eq!((causes[0].name, causes[0].tie), ("Iq", None));
    }
}
