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
