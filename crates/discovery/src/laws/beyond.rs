//! Where another recording goes on to what the fitted one does not show of a law.

use super::menu::{elsewhere, goes_on, motion};
use super::motion::Motion;
use super::search::LawStep;
use crate::report::law::BeyondReport;
use estimation::data::question::Question;
use estimation::proof::accept::{adequate, adequate_on_folds};

/// Share of what the fitted recording visits from which the other one goes on to something else.
const FURTHER: f64 = 0.05;

/// How far the fitted and the proving recording go, where a curve is as good as the noise of the first and not of the second, which goes on
/// further; `None` of more than two recordings, and of stretches of a long one.
pub(super) fn beyond(question: &Question, step: &LawStep) -> Option<BeyondReport> {
    let (study, LawStep { action, trial, .. }) = (&question.study, step);
    let waveform = study.fitted.case.waveform()?;
    let are_two = study.proofs.len() == 1 && waveform.timeline.cuts.is_empty();
    let are_whole = question.stretches.is_empty();
    let is_curve = step.bursts.is_empty() && goes_on(*action);
    let good_there_alone = adequate_on_folds(study, &trial.folds) && !adequate(study, trial);
    if !(are_two && are_whole && is_curve && good_there_alone) {
        return None;
    }
    let range = |motion: &Motion| motion.range(action.place, action.coordinate);
    let fitted = range(&motion(study, trial, waveform));
    let other = range(elsewhere(study, trial).first()?);
    let further = (fitted[0] - other[0]).max(other[1] - fitted[1]);
    (further > FURTHER * (fitted[1] - fitted[0])).then_some(BeyondReport { fitted, other })
}
