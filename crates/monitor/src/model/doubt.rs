//! How uncertain the parameters of a motor are that was not measured.

use crate::model::effects::{MAX_EFFECT_PARAMETERS, MAX_EFFECTS};

/// Standard deviations of the parameters' logarithms; 0 for a parameter that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParameterDoubt {
    /// Stator resistance, rotor resistance, stator leakage, rotor leakage, magnetizing inductance.
    pub circuit: [f32; CIRCUIT],
    /// Parameters of the effects, in their order.
    pub effects: [[f32; MAX_EFFECT_PARAMETERS]; MAX_EFFECTS],
}

/// Parameters of the T model.
pub const CIRCUIT: usize = 5;
/// A lamp needs so many standard deviations, as it does of noise: one healthy motor of 150 000 lights.
pub(crate) const DEVIATIONS: f32 = 4.5;
impl ParameterDoubt {
    /// Whether any parameter is in doubt.
    pub fn is_any(&self) -> bool {
        let effects = self.effects.iter().flatten();
        self.circuit.iter().chain(effects).any(|sigma| *sigma > 0.0)
    }
}
