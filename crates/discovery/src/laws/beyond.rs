//! Where other recordings go on to what the fitted one does not show of a law.

use super::motion::Motion;
use super::sensitivity::Sensitivities;
use crate::report::law::BeyondReport;
use estimation::data::case::Waveform;
use estimation::data::study::{Study, Trial};
use estimation::proof::accept::{adequate, adequate_on_folds};
use motor::effect::curve::{Action, Coordinate};

/// Share of what the fitted recording visits from which another one goes on to something else.
const FURTHER: f64 = 0.05;

/// Motions of the recordings that prove, as a trial predicts them; `None` of a load table.
pub(super) fn elsewhere(study: &Study, trial: &Trial) -> Vec<Option<Motion>> {
    let waveforms = study.proofs.iter().map(|subject| subject.case.waveform());
    let moved = |w: Option<&Waveform>| w.map(|w| motion(study, trial, w));
    waveforms.map(moved).collect()
}

fn motion(study: &Study, trial: &Trial, waveform: &Waveform) -> Motion {
    Sensitivities::of(waveform, &study.prior, &trial.fit).into_motion()
}

/// Whether a curve over this coordinate can be continued: a turn is whole, and what rises over time in one recording need not rise in
/// the next.
pub(super) fn goes_on(action: Action) -> bool {
    !action.coordinate.is_angle() && action.coordinate != Coordinate::Time
}

/// The recording that goes on furthest to where the fitted one does not show a law that is as good as the noise there, and there alone.
pub(super) fn beyond(study: &Study, action: Action, trial: &Trial) -> Option<BeyondReport> {
    let good_there_alone = adequate_on_folds(study, &trial.folds) && !adequate(study, trial);
    if !goes_on(action) || !good_there_alone {
        return None;
    }
    let range = |motion: &Motion| motion.range(action.place, action.coordinate);
    let fitted = range(&motion(study, trial, study.fitted.case.waveform()?));
    let width = fitted[1] - fitted[0];
    let further = |other: [f64; 2]| (fitted[0] - other[0]).max(other[1] - fitted[1]);
    let others = elsewhere(study, trial).into_iter().enumerate();
    let others = others.filter_map(|(k, motion)| {
        Some(BeyondReport {
            // The fitted recording is the first one.
            recording: k + 2,
            fitted,
            other: range(&motion?),
        })
    });
    let goes_further = |one: &BeyondReport| further(one.other) > FURTHER * width;
    let furthest =
        |a: &BeyondReport, b: &BeyondReport| further(a.other).total_cmp(&further(b.other));
    others.filter(goes_further).max_by(furthest)
}
