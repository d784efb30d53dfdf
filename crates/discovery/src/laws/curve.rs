//! From the modes of a fit to the knots of a motor file.

use crate::laws::modes::Modes;
use motor::effect::EffectConfig;
use motor::effect::curve::curve;

/// A fitted law as knots and values; `None` for any other effect.
pub(crate) fn as_knots(config: &EffectConfig) -> Option<EffectConfig> {
    let modes = Modes::of(config)?;
    let knots = modes.knots(&config.values);
    let values: Vec<f64> = knots
        .iter()
        .map(|&x| modes.value(&config.values, x))
        .collect();
    curve(modes.action, &knots, &values).ok()
}
