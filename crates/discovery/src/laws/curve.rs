//! From the modes of a fit to the knots of a motor file.

use crate::laws::formula::write::as_written;
use crate::laws::modes::Modes;
use motor::effect::EffectConfig;
use motor::effect::curve::curve;

/// A fitted law as a motor file holds it, knots and values or a formula; `None` for any other effect.
pub(crate) fn as_knots(config: &EffectConfig) -> Option<EffectConfig> {
    let Some(modes) = Modes::of(config) else {
        return as_written(config);
    };
    let knots = modes.knots(&config.values);
    let values: Vec<f64> = knots
        .iter()
        .map(|&x| modes.value(&config.values, x))
        .collect();
    curve(modes.action, &knots, &values).ok()
}
