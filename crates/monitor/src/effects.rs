//! Physical effects that the motor file adds to the T model, as the lamps need them: their steady-state terms.

use motor::TParams;
pub use motor::effects::MAX_PARAMETERS as MAX_EFFECT_PARAMETERS;
use motor::effects::{Rated, SteadyEffect, SteadyPoint};
use num_complex::Complex32;

use crate::operating_point::Rehearsal;

/// Most effects that one motor file may switch on.
pub const MAX_EFFECTS: usize = 4;

/// One effect with its parameters.
#[derive(Clone, Copy)]
pub struct ActiveEffect {
    /// The steady-state term.
    pub effect: &'static dyn SteadyEffect,
    /// Its parameters in the order of its descriptor; unused ones are 0.
    pub parameters: [f32; MAX_EFFECT_PARAMETERS],
}

/// The effects in the order in which the motor file names them.
pub type ActiveEffects = [Option<ActiveEffect>; MAX_EFFECTS];

/// What was measured in one window, as the T model without effects would have measured it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected {
    /// Stator voltage, V.
    pub u_s: Complex32,
    /// Stator current, A.
    pub i_s: Complex32,
    /// Mechanical speed, rad/s.
    pub omega_mech: f32,
    /// Parameters that hold at this point.
    pub params: TParams<f32>,
    /// Torque that the effects take from the shaft, N m.
    pub tau_extra: f32,
}

impl Corrected {
    /// The same as rehearsed sensor faults would show it.
    #[must_use]
    pub fn rehearsed(self, gains: &Rehearsal) -> Self {
        Corrected {
            u_s: self.u_s * gains.voltage_gain,
            i_s: self.i_s * gains.current_q_gain,
            omega_mech: self.omega_mech * gains.speed_gain,
            ..self
        }
    }
}

/// Applies all effects to one operating point, in the order of the motor file.
pub fn correct(
    effects: &ActiveEffects,
    rated: Rated<f32>,
    params: &TParams<f32>,
    [u_s, i_s]: [Complex32; 2],
    [omega_sync, omega_mech]: [f32; 2],
) -> Corrected {
    let mut point = SteadyPoint {
        rated,
        omega_sync,
        omega_mech,
        u_s,
        i_s,
        motor: *params,
        tau_extra: 0.0,
    };
    for active in effects.iter().flatten() {
        active.effect.correct_f32(&active.parameters, &mut point);
    }
    Corrected {
        u_s: point.u_s,
        i_s: point.i_s,
        omega_mech: point.omega_mech,
        params: point.motor,
        tau_extra: point.tau_extra,
    }
}

impl core::fmt::Debug for ActiveEffect {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ActiveEffect")
            .field("name", &self.effect.descriptor().name)
            .field("form", &self.effect.descriptor().form)
            .field("parameters", &self.parameters)
            .finish()
    }
}

impl PartialEq for ActiveEffect {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.effect.descriptor(), other.effect.descriptor())
            && self.parameters == other.parameters
    }
}
