//! The free scale of a speed channel, as an effect.

use motor::effect::{Effect, EffectConfig, Instrument};
use motor::effects;

/// Whether an effect holds what the starting value leaves open.
pub fn is_scale(effect: &dyn Effect) -> bool {
    effect.gain_of() == Some(Instrument::Speed)
}

/// Name of that effect.
pub fn name() -> &'static str {
    effects::gain_of(Instrument::Speed).map_or("", |effect| effect.descriptor().name)
}

/// What the speed channel shows over the truth, with these effects.
pub fn gain_of(effects: &[EffectConfig]) -> f64 {
    let scale = effects.iter().find(|c| is_scale(c.effect));
    1.0 + scale.map_or(0.0, |c| c.values[0])
}
