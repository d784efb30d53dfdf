//! The same motor at its terminals with the whole leakage on one side: what other simulators take.

use motor::TParams;

/// Gamma model: the whole leakage on the rotor side of the magnetizing inductance.
///
/// Source: Slemon, IEEE Trans. Ind. Appl. 25(6), 1989, doi:10.1109/28.44251.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GammaParams {
    /// Stator resistance, ohm.
    pub r_s: f64,
    /// Rotor resistance, ohm, referred by `(L_s/L_m)^2`.
    pub r_r: f64,
    /// Total leakage inductance, H.
    pub l_sigma: f64,
    /// Magnetizing inductance, H; equals `L_s` of the T model.
    pub l_m: f64,
}

/// Inverse-Gamma model: the whole leakage on the stator side of the magnetizing inductance.
///
/// Source: Slemon, IEEE Trans. Ind. Appl. 25(6), 1989, doi:10.1109/28.44251.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvGammaParams {
    /// Stator resistance, ohm.
    pub r_s: f64,
    /// Rotor resistance, ohm, referred by `(L_m/L_r)^2`.
    pub r_r: f64,
    /// Total leakage inductance, H; equals `sigma L_s` of the T model.
    pub l_sigma: f64,
    /// Magnetizing inductance, H; equals `L_m^2/L_r` of the T model.
    pub l_m: f64,
}

impl From<&TParams<f64>> for GammaParams {
    fn from(motor: &TParams<f64>) -> Self {
        let g = motor.l_s() / motor.l_m;
        Self {
            r_s: motor.r_s,
            r_r: g * g * motor.r_r,
            l_sigma: g * motor.l_ls + g * g * motor.l_lr,
            l_m: motor.l_s(),
        }
    }
}

impl From<&TParams<f64>> for InvGammaParams {
    fn from(motor: &TParams<f64>) -> Self {
        let k = motor.l_m / motor.l_r();
        Self {
            r_s: motor.r_s,
            r_r: k * k * motor.r_r,
            l_sigma: motor.l_ls + k * motor.l_lr,
            l_m: k * motor.l_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motor::MotorFile;
    use motor::steady_state::SteadyState;
    use num_complex::Complex64;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;
    use std::f64::consts::TAU;
    use std::path::Path;

    /// The T model without leakage on one side: how the split of the leakage is written, the terminals cannot see.
    fn as_t_models(motor: &TParams<f64>) -> [TParams<f64>; 2] {
        let (gamma, inverse) = (GammaParams::from(motor), InvGammaParams::from(motor));
        [
            TParams {
                r_s: gamma.r_s,
                r_r: gamma.r_r,
                l_ls: 0.0,
                l_lr: gamma.l_sigma,
                l_m: gamma.l_m,
            },
            TParams {
                r_s: inverse.r_s,
                r_r: inverse.r_r,
                l_ls: inverse.l_sigma,
                l_lr: 0.0,
                l_m: inverse.l_m,
            },
        ]
    }

    fn motors() -> impl Iterator<Item = (TParams<f64>, Pcg64)> {
        (0..200).map(|seed| {
            let mut random = Pcg64::seed_from_u64(seed);
            let mut scale = |low: f64, high: f64| low * (high / low).powf(random.random());
            let l_m = scale(0.01, 1.0);
            let motor = TParams {
                r_s: scale(0.01, 20.0),
                r_r: scale(0.01, 20.0),
                l_ls: l_m * scale(0.01, 0.2),
                l_lr: l_m * scale(0.01, 0.2),
                l_m,
            };
            (motor, random)
        })
    }

    /// Identical at the terminals: 1e-12 is the project's requirement.
    #[test]
    fn t_gamma_and_inverse_gamma_are_one_motor() {
        for (motor, mut random) in motors() {
            let omega = TAU * random.random_range(5.0..100.0);
            let slip = random.random_range(-0.5..1.5);
            let volt = Complex64::new(300.0, 0.0);
            let at = |params: &TParams<f64>| {
                SteadyState::new(params, 2.0, volt, omega).at_slip_speed(slip * omega)
            };
            let t = at(&motor);
            for other in as_t_models(&motor).map(|params| at(&params)) {
                assert!((other.i_s - t.i_s).norm() <= 1e-12 * t.i_s.norm());
                assert!((other.psi_s - t.psi_s).norm() <= 1e-12 * t.psi_s.norm());
                // Torque vanishes at synchronous speed: relative to what the flux and the current could give.
                let scale = 3.0 * t.psi_s.norm() * t.i_s.norm();
                assert!((other.tau_em - t.tau_em).abs() <= 1e-12 * scale);
            }
        }
    }

    /// `sigma L_s` and `L_m^2/L_r`, as documented on the type.
    #[test]
    fn the_inverse_gamma_model_has_the_transient_inductance() {
        for (motor, _) in motors() {
            let inverse = InvGammaParams::from(&motor);
            assert!((inverse.l_sigma / motor.l_a() - 1.0).abs() < 1e-13);
            assert!((inverse.l_m * motor.l_r() / motor.l_m.powi(2) - 1.0).abs() < 1e-14);
        }
    }

    /// The source gives an inverse-Gamma model with four numbers; the file's T model must be that machine.
    #[test]
    fn the_peer_motor_is_the_published_inverse_gamma_machine() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../motors/peer-2k2.toml");
        let file = MotorFile::read(path).expect("shipped");
        let ours = InvGammaParams::from(&file.parameters);
        for (ours, published) in [
            (ours.r_s, 3.7),
            (ours.r_r, 2.1),
            (ours.l_sigma, 0.021),
            (ours.l_m, 0.224),
        ] {
            assert!((ours / published - 1.0).abs() < 1e-12, "{ours} {published}");
        }
    }
}
