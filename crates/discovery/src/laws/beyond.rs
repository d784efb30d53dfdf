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

/// Motions of the recordings that prove, as a trial predicts them; none of load tables.
pub(super) fn elsewhere(study: &Study, trial: &Trial) -> Vec<Motion> {
    let waveforms = study.proofs.iter().filter_map(|s| s.case.waveform());
    waveforms.map(|w| motion(study, trial, w)).collect()
}

fn motion(study: &Study, trial: &Trial, waveform: &Waveform) -> Motion {
    Sensitivities::of(waveform, &study.prior, &trial.fit).into_motion()
}

/// Whether a curve over this coordinate can be continued: a turn is whole, and what rises over time in one recording need not rise in
/// the next.
pub(super) fn goes_on(action: Action) -> bool {
    !action.coordinate.is_angle() && action.coordinate != Coordinate::Time
}

/// How far the fitted and the proving recording go, where the law is as good as the noise of the first and not of the second, which goes on
/// further; `None` of more than two recordings.
pub(super) fn beyond(study: &Study, action: Action, trial: &Trial) -> Option<BeyondReport> {
    let waveform = study.fitted.case.waveform()?;
    let are_two = study.proofs.len() == 1 && waveform.timeline.cuts.is_empty();
    let good_there_alone = adequate_on_folds(study, &trial.folds) && !adequate(study, trial);
    if !are_two || !goes_on(action) || !good_there_alone {
        return None;
    }
    let range = |motion: &Motion| motion.range(action.place, action.coordinate);
    let fitted = range(&motion(study, trial, waveform));
    let other = range(elsewhere(study, trial).first()?);
    let further = (fitted[0] - other[0]).max(other[1] - fitted[1]);
    (further > FURTHER * (fitted[1] - fitted[0])).then_some(BeyondReport { fitted, other })
}
