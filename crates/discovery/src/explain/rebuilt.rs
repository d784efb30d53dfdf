//! Models put together again from what other fits found.

use super::Step;
use estimation::data::study::{Study, Trial};
use estimation::fit::output_error::Effort;
use estimation::model::prior::N_NOMINAL;
use motor::effect::EffectConfig;

/// The effects of steps as they were fitted.
pub(super) fn effects_of(study: &Study, steps: &[Step]) -> Vec<EffectConfig> {
    let rated = &study.prior.plant.rated;
    let last = steps.last().map(|s| s.trial.fit.hypothesis.configs(rated));
    let all = last.unwrap_or_default().into_iter();
    all.skip(study.given_effects()).collect()
}

/// These effects and a law on the bare motor, with the nominals of another fit as a start.
pub(super) fn refitted(
    study: &Study,
    effects: &[EffectConfig],
    law: Option<&EffectConfig>,
    from: &Trial,
) -> Trial {
    let rated = &study.prior.plant.rated;
    let mut h = study.at_prior();
    for config in effects.iter().chain(law) {
        h = h.with(config.clone(), rated);
    }
    let nominals = &from.fit.hypothesis.z[..N_NOMINAL];
    h.z[..N_NOMINAL].copy_from_slice(nominals);
    study.trial(&h, Effort::FULL)
}
