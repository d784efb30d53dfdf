//! Electrical and mechanical parameters of an induction motor, per equivalent star phase, SI units.

use num_traits::Float;

/// T model: both leakages kept, rotor quantities referred to the stator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TParams<F> {
    /// Stator resistance, ohm, > 0.
    pub r_s: F,
    /// Rotor resistance, ohm, > 0.
    pub r_r: F,
    /// Stator leakage inductance, H, >= 0.
    pub l_ls: F,
    /// Rotor leakage inductance, H, >= 0. Not both leakages may be zero.
    pub l_lr: F,
    /// Magnetizing inductance, H, > 0.
    pub l_m: F,
}

/// The rotating masses and the speed-proportional torques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanics<F> {
    /// Pole pairs (the paper's `N_p` in (29)-(37)).
    pub n_p: F,
    /// Moment of inertia of everything on the shaft, kg m2, > 0.
    pub inertia: F,
    /// Viscous friction of the motor `B`, N m s, >= 0.
    pub friction: F,
    /// Load modelled as friction `B_l`, N m s, >= 0.
    pub load_friction: F,
}

impl<F: Float> Mechanics<F> {
    /// Total friction `B_t = B + B_l`, N m s.
    pub fn total_friction(&self) -> F {
        self.friction + self.load_friction
    }
}

impl<F: Float> TParams<F> {
    /// Stator inductance `L_s = L_ls + L_m`, H.
    pub fn l_s(&self) -> F {
        self.l_ls + self.l_m
    }

    /// Rotor inductance `L_r = L_lr + L_m`, H.
    pub fn l_r(&self) -> F {
        self.l_lr + self.l_m
    }

    /// Leakage factor `sigma = 1 - L_m^2/(L_s L_r)`, in (0, 1) for a physical motor.
    pub fn sigma(&self) -> F {
        // Written without the cancellation of 1 - L_m^2/(L_s L_r): f32 keeps its digits.
        (self.l_ls * self.l_r() + self.l_m * self.l_lr) / (self.l_s() * self.l_r())
    }

    /// Armature inductance `L_a = sigma L_s` of the matched DC motor, H.
    pub fn l_a(&self) -> F {
        self.sigma() * self.l_s()
    }

    /// Armature resistance `R_a = R_s + (L_s/L_r) R_r` of the matched DC motor, ohm.
    pub fn r_a(&self) -> F {
        self.r_s + self.l_s() / self.l_r() * self.r_r
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::steady_state::tests::{motors, seeded};
    use proptest::prelude::*;

    /// Relative difference of two positive numbers.
    fn off(a: f64, b: f64) -> f64 {
        (a / b - 1.0).abs()
    }

    proptest! {
        #![proptest_config(seeded())]

        /// `sigma` without cancellation against the definition; both rounded, hence 1e-13 at sigma >= 0.02.
        #[test]
        fn the_leakage_factor_is_its_definition(p in motors()) {
            let definition = 1.0 - p.l_m * p.l_m / (p.l_s() * p.l_r());
            prop_assert!((p.sigma() - definition).abs() < 1e-14);
            prop_assert!(p.sigma() > 0.0 && p.sigma() < 1.0);
            prop_assert!(off(p.l_a(), definition * p.l_s()) < 1e-12);
        }
    }

    #[test]
    fn frictions_add() {
        let mechanics = Mechanics {
            n_p: 2.0,
            inertia: 0.01,
            friction: 0.25,
            load_friction: 0.5,
        };
        assert_eq!(mechanics.total_friction(), 0.75);
    }
}
