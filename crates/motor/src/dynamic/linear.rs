//! The linear flux-to-current map of the T model, with its divisions done once.

use super::hooks::Winding;
use crate::TParams;
use num_complex::Complex64;

/// Constant coefficients of the linear T model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Parameters the coefficients were computed from.
    pub params: TParams<f64>,
    inv_s: f64,
    inv_r: f64,
    inv_m: f64,
}

impl Linear {
    /// Computes the coefficients; the parameters must be those of a physical motor (sigma in (0, 1)).
    pub fn new(params: &TParams<f64>) -> Self {
        let (l_s, l_r) = (params.l_s(), params.l_r());
        let per_det = 1.0 / (params.l_ls * l_r + params.l_m * params.l_lr);
        Self {
            params: *params,
            inv_s: l_r * per_det,
            inv_r: l_s * per_det,
            inv_m: params.l_m * per_det,
        }
    }

    /// Winding currents for given flux linkages.
    #[inline(always)]
    pub fn winding(&self, psi_s: Complex64, psi_r: Complex64) -> Winding {
        Winding {
            i_s: psi_s * self.inv_s - psi_r * self.inv_m,
            i_r: psi_r * self.inv_r - psi_s * self.inv_m,
            r_s: self.params.r_s,
            r_r: self.params.r_r,
        }
    }
}
