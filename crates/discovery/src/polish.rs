//! The parameters of a model beside the voltage channels' own errors.
//!
//! Channels of class 0.5 show an unbalance that is not there. The negative-sequence current that a model answers with
//! is the smaller the larger its leakage: with no other way out a fit turns the error of the channels into leakage. For
//! the parameters that are reported the gains of the three channels are fitted too, believed to be right within their
//! class. What effects are missing is asked without them: a channel that is further off is a finding.

use crate::belief::N_NOMINAL;
use crate::fit::Effort;
use crate::study::{Study, Trial};
use motor::effects::{EffectConfig, find};

/// The effect that holds the gains of the voltage channels.
const GAINS: &str = "phase-voltage-gain";
/// Effects that a gain of one channel cannot be told from.
const SAME: [&str; 2] = [GAINS, "voltage-asymmetry"];

/// The trial refitted beside the gains of the voltage channels; `None` where they cannot be fitted: a load table, or a
/// model that holds an unbalance already.
pub(crate) fn polished(study: &Study, trial: &Trial) -> Option<Trial> {
    let h = &trial.fit.hypothesis;
    let held = h.effects.iter().chain(&study.belief.plant.effects);
    let mut names = held.map(|c| c.effect.descriptor().name);
    if study.fitted.case.table.is_some() || names.any(|name| SAME.contains(&name)) {
        return None;
    }
    let rated = &study.belief.plant.rated;
    let gains = EffectConfig::absent(find(GAINS, "")?, rated);
    let here = h.with_instrument(gains, rated);
    let mut believed = here.clone();
    believed.z[..N_NOMINAL].fill(0.0);
    // A trial whose nominals had to make up for the gains stands far up a bent valley: from the beliefs it is a few steps.
    let polished = study.trial(&believed, Effort::FULL);
    if polished.fit.cost() <= trial.fit.cost() {
        return Some(polished);
    }
    let other = study.trial(&here, Effort::FULL);
    Some(if other.fit.cost() < polished.fit.cost() {
        other
    } else {
        polished
    })
}

/// The hypothesis of a trial with the nominals of another one.
pub(crate) fn with_nominals(trial: &Trial, of: &Trial) -> crate::belief::Hypothesis {
    let mut h = trial.fit.hypothesis.clone();
    h.z[..N_NOMINAL].copy_from_slice(&of.fit.hypothesis.z[..N_NOMINAL]);
    h
}

#[cfg(test)]
mod tests;
