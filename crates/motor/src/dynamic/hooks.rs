//! Places where a physical effect can enter the dynamic model.

use super::{DynamicState, Extra, Flow, Linear};
use num_complex::Complex64;

/// What the windings carry at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// Stator winding current, A.
    pub i_s: Complex64,
    /// Rotor current referred to the stator, A.
    pub i_r: Complex64,
    /// Stator resistance at this instant, ohm.
    pub r_s: f64,
    /// Rotor resistance at this instant, ohm.
    pub r_r: f64,
}

/// What the stator terminals see at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terminal {
    /// Voltage of the supply, before anything between it and the motor, V.
    pub supply: Complex64,
    /// Voltage that drives the stator circuit, V.
    pub u: Complex64,
    /// Current through the stator resistance, A: what an ammeter in the supply line reads.
    pub i: Complex64,
}

/// Effects acting inside the dynamic model. Every method's default is the model without effects.
pub trait Hooks {
    /// States that the effects add.
    type Extra: Extra;

    /// What the effects know of an instant beside the state: asked once, used by all methods.
    type Moment: Copy;

    /// Looks at an instant.
    fn moment(&self, t: f64, state: &DynamicState<Self::Extra>) -> Self::Moment;

    /// Whether [`Hooks::held_voltage`] is in use. Adding a zero is not free: it may not be optimised away,
    /// because `-0.0 + 0.0` is `0.0`.
    const HOLDS: bool = false;

    /// Voltage added for a whole step, decided once at its beginning (dead time: the inverter
    /// samples the sign of the current once per period), V.
    #[inline(always)]
    fn held_voltage(
        &self,
        _linear: &Linear,
        _moment: &Self::Moment,
        _state: &DynamicState<Self::Extra>,
    ) -> Complex64 {
        Complex64::new(0.0, 0.0)
    }

    /// Currents and resistances of the windings (saturation, heating, skin effect).
    #[inline(always)]
    fn winding(
        &self,
        linear: &Linear,
        _moment: &Self::Moment,
        state: &DynamicState<Self::Extra>,
    ) -> Winding {
        linear.winding(state.psi_s, state.psi_r)
    }

    /// Voltage and current at the stator terminals (core loss, supply impedance).
    #[inline(always)]
    fn terminal(
        &self,
        _moment: &Self::Moment,
        _state: &DynamicState<Self::Extra>,
        winding: &Winding,
        u: Complex64,
    ) -> Terminal {
        Terminal {
            supply: u,
            u,
            i: winding.i_s,
        }
    }

    /// Last word on the rates: extra voltages, torques and the rates of extra states.
    #[inline(always)]
    fn finish(
        &self,
        _moment: &Self::Moment,
        _flow: &Flow,
        _state: &DynamicState<Self::Extra>,
        _rate: &mut DynamicState<Self::Extra>,
    ) {
    }
}

/// The linear motor without any effect.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoEffects;

impl Hooks for NoEffects {
    type Extra = ();
    type Moment = ();

    #[inline(always)]
    fn moment(&self, _t: f64, _state: &DynamicState) {}
}
