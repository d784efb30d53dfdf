//! Physical effects that the motor file adds to the T model, as the lamps need them: their steady-state terms.

use motor::TParams;
pub use motor::effect::MAX_PARAMETERS as MAX_EFFECT_PARAMETERS;
use motor::effect::curve::SteadyCurve;
use motor::effect::{Rated, SteadyEffect, SteadyPoint};
use num_complex::Complex32;

use crate::rehearsal::Rehearsal;

/// Most effects that one motor file may switch on.
pub const MAX_EFFECTS: usize = 8;

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

/// Most laws that one motor file may hold.
pub const MAX_LAWS: usize = 2;

/// The laws in the order in which the motor file names them; they act after the effects.
pub type ActiveLaws = [Option<SteadyCurve<f32>>; MAX_LAWS];

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

/// Applies all effects to one operating point, in the order of the motor file, then all laws.
pub fn correct(
    (effects, laws): (&ActiveEffects, &ActiveLaws),
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
    for law in laws.iter().flatten() {
        law.correct(&mut point);
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

#[cfg(test)]
mod tests {
    use motor::effects::find_steady;

    use super::*;

    const PARAMS: TParams<f32> = TParams {
        r_s: 3.7,
        r_r: 2.3,
        l_ls: 0.0107,
        l_lr: 0.0107,
        l_m: 0.234,
    };
    const RATED: Rated<f32> = Rated {
        voltage: 326.6,
        current: 7.07,
        omega_sync: 314.2,
        n_p: 2.0,
        torque: 14.6,
    };

    fn effect(name: &str, parameter: f32) -> ActiveEffect {
        let mut parameters = [0.0; MAX_EFFECT_PARAMETERS];
        parameters[0] = parameter;
        ActiveEffect {
            effect: find_steady(name, "").expect("in the library"),
            parameters,
        }
    }

    fn corrected(effects: &[ActiveEffect]) -> Corrected {
        let mut active = [None; MAX_EFFECTS];
        for (slot, effect) in active.iter_mut().zip(effects) {
            *slot = Some(*effect);
        }
        let (u_s, i_s) = (Complex32::new(300.0, 20.0), Complex32::new(3.0, -4.0));
        correct(
            (&active, &[None; MAX_LAWS]),
            RATED,
            &PARAMS,
            [u_s, i_s],
            [314.2, 150.0],
        )
    }

    #[test]
    fn without_effects_the_measurement_is_what_it_was() {
        let plain = Corrected {
            u_s: Complex32::new(300.0, 20.0),
            i_s: Complex32::new(3.0, -4.0),
            omega_mech: 150.0,
            params: PARAMS,
            tau_extra: 0.0,
        };
        assert_eq!(corrected(&[]), plain);
    }

    /// A speed channel that shows 2 % too much, and windage of `c w^2` at the speed that is left.
    #[test]
    fn effects_apply_in_their_order() {
        let speed = effect("speed-scale", 0.02);
        let windage = effect("windage", 1e-4);
        let truth = 150.0 / 1.02;
        let after = corrected(&[speed, windage]);
        assert!((after.omega_mech - truth).abs() < 1e-4);
        assert!((after.tau_extra - 1e-4 * truth * truth).abs() < 1e-5);
        let before = corrected(&[windage, speed]);
        assert!((before.tau_extra - 1e-4 * 150.0 * 150.0).abs() < 1e-5);
    }

    #[test]
    fn effects_are_equal_in_kind_and_parameters_only() {
        assert_eq!(effect("windage", 1.0), effect("windage", 1.0));
        assert_ne!(effect("windage", 1.0), effect("windage", 2.0));
        assert_ne!(effect("windage", 1.0), effect("speed-scale", 1.0));
    }

    #[test]
    fn rehearsed_gains_act_on_their_signals() {
        let gains = Rehearsal {
            voltage_gain: 2.0,
            current_q_gain: 3.0,
            speed_gain: 4.0,
        };
        let plain = corrected(&[]);
        let expected = Corrected {
            u_s: plain.u_s * 2.0,
            i_s: plain.i_s * 3.0,
            omega_mech: plain.omega_mech * 4.0,
            ..plain
        };
        assert_eq!(plain.rehearsed(&gains), expected);
    }
}
