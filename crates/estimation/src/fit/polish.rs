//! The parameters of a model beside the channels' own errors.
//!
//! Channels of class 0.5 show an unbalance that is not there. The negative-sequence current that a model answers with
//! is the smaller the larger its leakage: with no other way out a fit turns the error of the channels into leakage. For
//! the parameters that are reported the gains of the voltage and current channels are fitted too, believed to be right
//! within their class. So are their offsets: a constant voltage that is not there drives a large constant current through the
//! model, and the fit takes a resistance of several times the motor's for the reason why none is measured. What effects are
//! missing is asked without them: a channel that is further off is a finding.

use crate::data::study::{Study, Trial};
use crate::fit::output_error::Effort;
use crate::model::prior::{Hypothesis, N_NOMINAL};
use motor::effect::{EffectConfig, Instrument};
use motor::effects::{gain_of, offset_of};

/// The instruments whose gains and offsets are fitted.
pub const INSTRUMENTS: [Instrument; 2] = [Instrument::Voltages, Instrument::Currents];

/// The trial refitted beside gains and offsets of the channels; `None` where they cannot be fitted: a load table, or a motor file that
/// holds an unbalance of voltages and currents already, or a study that takes them as unknown. Gains that were found are held to their class, too: the data tell
/// how they differ, and nothing tells what all three have in common from the impedances of another motor.
pub fn polished(study: &Study, trial: &Trial) -> Option<Trial> {
    let here = beside_channels(study, &trial.fit.hypothesis)?;
    let mut believed = here.clone();
    believed.z[..N_NOMINAL].fill(0.0);
    // A trial whose nominals had to make up for the gains starts far from the minimum; from the prior it takes a few steps.
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

/// A hypothesis with gains and offsets of the channels to be refitted, those that it holds already included.
fn beside_channels(study: &Study, h: &Hypothesis) -> Option<Hypothesis> {
    if study.fitted.case.is_table() || study.plain.is_some() {
        return None;
    }
    let held = h.effects.iter().chain(&study.prior.plant.effects);
    let rated = &study.prior.plant.rated;
    let mut here = h.clone();
    let mut any = false;
    for instrument in INSTRUMENTS {
        let is_gain = |c: &EffectConfig| c.effect.gain_of() == Some(instrument);
        let hides = |c: &EffectConfig| c.effect.hides_gain_of() == Some(instrument);
        let found = h.effects.iter().position(is_gain);
        here = match found {
            Some(found) => here.taken_for_instrument(found),
            None if held.clone().any(hides) => continue,
            None => {
                let gains = EffectConfig::absent(gain_of(instrument)?, rated);
                here.with_instrument(gains, rated)
            }
        };
        any = true;
    }
    for instrument in INSTRUMENTS {
        let is_offset = |c: &EffectConfig| c.effect.offset_of() == Some(instrument);
        if !held.clone().any(is_offset) {
            let offsets = EffectConfig::absent(offset_of(instrument)?, rated);
            here = here.with_instrument(offsets, rated);
            any = true;
        }
    }
    any.then_some(here)
}

/// The hypothesis of a trial with the nominals of another one.
pub fn with_nominals(trial: &Trial, of: &Trial) -> Hypothesis {
    let mut h = trial.fit.hypothesis.clone();
    h.z[..N_NOMINAL].copy_from_slice(&of.fit.hypothesis.z[..N_NOMINAL]);
    h
}

#[cfg(test)]
mod tests;
