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

/// Gamma model: the whole leakage on the rotor side of the magnetizing inductance.
///
/// Source: Slemon, IEEE Trans. Ind. Appl. 25(6), 1989, doi:10.1109/28.44251.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GammaParams<F> {
    /// Stator resistance, ohm.
    pub r_s: F,
    /// Rotor resistance, ohm, referred by `(L_s/L_m)^2`.
    pub r_r: F,
    /// Total leakage inductance, H.
    pub l_sigma: F,
    /// Magnetizing inductance, H; equals `L_s` of the T model.
    pub l_m: F,
}

/// Inverse-Gamma model: the whole leakage on the stator side of the magnetizing inductance.
///
/// Source: Slemon, IEEE Trans. Ind. Appl. 25(6), 1989, doi:10.1109/28.44251.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvGammaParams<F> {
    /// Stator resistance, ohm.
    pub r_s: F,
    /// Rotor resistance, ohm, referred by `(L_m/L_r)^2`.
    pub r_r: F,
    /// Total leakage inductance, H; equals `sigma L_s` of the T model.
    pub l_sigma: F,
    /// Magnetizing inductance, H; equals `L_m^2/L_r` of the T model.
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

    /// The same motor as a Gamma model: identical at its terminals.
    pub fn to_gamma(&self) -> GammaParams<F> {
        let g = self.l_s() / self.l_m;
        GammaParams {
            r_s: self.r_s,
            r_r: g * g * self.r_r,
            l_sigma: g * self.l_ls + g * g * self.l_lr,
            l_m: self.l_s(),
        }
    }

    /// The same motor as an inverse-Gamma model: identical at its terminals.
    pub fn to_inv_gamma(&self) -> InvGammaParams<F> {
        let k = self.l_m / self.l_r();
        InvGammaParams {
            r_s: self.r_s,
            r_r: k * k * self.r_r,
            l_sigma: self.l_ls + k * self.l_lr,
            l_m: k * self.l_m,
        }
    }
}

impl<F: Float> From<GammaParams<F>> for TParams<F> {
    /// The T model without stator leakage; the split of the leakage is not observable at the terminals.
    fn from(gamma: GammaParams<F>) -> Self {
        TParams {
            r_s: gamma.r_s,
            r_r: gamma.r_r,
            l_ls: F::zero(),
            l_lr: gamma.l_sigma,
            l_m: gamma.l_m,
        }
    }
}

impl<F: Float> From<InvGammaParams<F>> for TParams<F> {
    /// The T model without rotor leakage; the split of the leakage is not observable at the terminals.
    fn from(inv: InvGammaParams<F>) -> Self {
        TParams {
            r_s: inv.r_s,
            r_r: inv.r_r,
            l_ls: inv.l_sigma,
            l_lr: F::zero(),
            l_m: inv.l_m,
        }
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

        /// What the terminals can see: `L_s`, `sigma L_s` and the rotor time constant.
        #[test]
        fn all_models_have_the_same_invariants(p in motors()) {
            let (gamma, inv) = (p.to_gamma(), p.to_inv_gamma());
            for other in [TParams::from(gamma), TParams::from(inv)] {
                prop_assert!(off(other.l_s(), p.l_s()) < 1e-14);
                prop_assert!(off(other.l_a(), p.l_a()) < 1e-13);
                // The rotor time constant.
                prop_assert!(off(other.l_r() / other.r_r, p.l_r() / p.r_r) < 1e-14);
            }
            // sigma L_s and L_m^2/L_r, as documented on the type.
            prop_assert!(off(inv.l_sigma, p.l_a()) < 1e-13);
            prop_assert!(off(inv.l_m, p.l_m * p.l_m / p.l_r()) < 1e-15);
        }

        /// Converting there and back is the same model.
        #[test]
        fn gamma_and_inverse_gamma_convert_into_each_other(p in motors()) {
            let inv = p.to_inv_gamma();
            let back = TParams::from(TParams::from(inv).to_gamma()).to_inv_gamma();
            for (a, b) in [(inv.r_r, back.r_r), (inv.l_sigma, back.l_sigma), (inv.l_m, back.l_m)] {
                prop_assert!(off(a, b) < 1e-13);
            }
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
