//! The free scale of a speed channel, as an effect.

use motor::effect::EffectConfig;

/// The effect that holds what the starting value leaves open.
pub(crate) const EFFECT: &str = "speed-scale";

/// What the speed channel shows over the truth, with these effects.
pub(crate) fn gain_of(effects: &[EffectConfig]) -> f64 {
    let scale = effects
        .iter()
        .find(|c| c.effect.descriptor().name == EFFECT);
    1.0 + scale.map_or(0.0, |c| c.values[0])
}
