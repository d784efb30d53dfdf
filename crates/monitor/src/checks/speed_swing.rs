//! What a swing of the speed alone leaves in the current: a pair of sidebands that belong together.
//!
//! A load that swings at twice the slip frequency sets the speed swinging, and the current has lines at `(1 - 2 s)` and
//! `(1 + 2 s)` times the supply's frequency as with broken bars. But a speed is one real number: both lines answer the same
//! swing, so one follows from the other by the motor's circuit, whatever the load and the inertia. What stands at the lower
//! one beside that comes from the cage itself, whose field turns backwards and has no such twin.

use motor::TParams;
use num_complex::Complex32;

use crate::window::Window;
use frames::magnitude;

/// The motor on its supply, while the speed swings by little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven<'a> {
    /// Circuit.
    pub params: &'a TParams<f32>,
    /// Voltage, V, amplitude: the axis from which currents are seen.
    pub voltage: f32,
    /// Supply frequency, rad/s, > 0.
    pub omega_sync: f32,
}

impl<'a> Driven<'a> {
    /// A motor with these parameters as the window shows it.
    pub fn of(params: &'a TParams<f32>, window: &Window) -> Self {
        Driven {
            params,
            voltage: magnitude(window.u_s.positive),
            omega_sync: window.omega_sync,
        }
    }

    /// The line at `(1 - 2 s)` of a swing of the speed whose line at `(1 + 2 s)` is `upper`, A, about a mean current, A, at a
    /// slip of `s`.
    ///
    /// The T model in the supply's frame, `0 = R_s i~ + (p + j w) psi_s~` and `0 = R_r i_r~ + (p + j s w) psi_r~ - j w_r~ psi_r`,
    /// answers a swing `w_r~` of the speed with `i~ = -j psi_r (p + j w) L_m/D(p) w_r~`. At `p = 2 j s w` and `p = -2 j s w`
    /// the swings are conjugates of each other, so
    /// `i-~ = (1 - 2 s)/(1 + 2 s) conj(D+)/D- psi_r^2/|psi_r|^2 conj(i+~)`.
    ///
    /// Zero without a voltage: then only the current's length is known, and of it both lines are alike whatever makes them.
    pub fn mirrored(&self, upper: Complex32, mean: Complex32, slip: f32) -> Complex32 {
        if self.voltage <= 0.0 {
            return Complex32::ZERO;
        }
        let two = 2.0 * slip;
        let above = self.determinant(3.0 * slip, 1.0 + two);
        let below = self.determinant(-slip, 1.0 - two);
        let flux = self.rotor_flux_direction(mean);
        let answer = above.conj() / below * (flux * flux / flux.norm_sqr());
        answer * upper.conj() * ((1.0 - two) / (1.0 + two))
    }

    /// `D = (R_s + j b L_s)(R_r + j a L_r) - (j a L_m)(j b L_m)` where the rotor sees `a` and the stator `b` times the supply's
    /// frequency; `L_s L_r - L_m^2 = L_a L_r` without its cancellation.
    fn determinant(&self, a: f32, b: f32) -> Complex32 {
        let p = self.params;
        let (a, b) = (a * self.omega_sync, b * self.omega_sync);
        Complex32::new(
            p.r_s * p.r_r - a * b * p.l_a() * p.l_r(),
            a * p.l_r() * p.r_s + b * p.l_s() * p.r_r,
        )
    }

    /// `psi_s - L_a i`, which has the direction of the rotor's flux; `psi_s = (u - R_s i)/(j w)`.
    fn rotor_flux_direction(&self, i: Complex32) -> Complex32 {
        let emf = self.voltage - i * self.params.r_s;
        Complex32::new(emf.im, -emf.re) / self.omega_sync - i * self.params.l_a()
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use num_complex::Complex64;

    use super::*;

    const OMEGA: f64 = TAU * 50.0;
    const VOLTAGE: f64 = 325.0;
    /// `R_s`, `R_r` in ohm, `L_ls`, `L_lr`, `L_m` in H.
    const CIRCUITS: [[f32; 5]; 3] = [
        [2.0, 1.8, 0.011, 0.011, 0.22],
        [24.0, 19.0, 0.07, 0.09, 0.9],
        [0.2, 0.15, 0.002, 0.003, 0.05],
    ];

    /// A circuit in either precision.
    fn circuit<F: From<f32>>(values: [f32; 5]) -> TParams<F> {
        let [r_s, r_r, l_ls, l_lr, l_m] = values.map(F::from);
        TParams {
            r_s,
            r_r,
            l_ls,
            l_lr,
            l_m,
        }
    }

    /// Stator and rotor current, A, of these fluxes.
    fn currents(p: &TParams<f64>, [s, r]: [Complex64; 2]) -> [Complex64; 2] {
        let (l_s, l_r) = (p.l_ls + p.l_m, p.l_lr + p.l_m);
        let det = l_s * l_r - p.l_m * p.l_m;
        [(s * l_r - r * p.l_m) / det, (r * l_s - s * p.l_m) / det]
    }

    /// `d psi/dt` in the supply's frame, written out from the T model.
    fn rates(p: &TParams<f64>, psi: [Complex64; 2], omega_slip: f64) -> [Complex64; 2] {
        let [i_s, i_r] = currents(p, psi);
        let j = Complex64::I;
        [
            VOLTAGE - i_s * p.r_s - j * OMEGA * psi[0],
            -i_r * p.r_r - j * omega_slip * psi[1],
        ]
    }

    fn moved(psi: [Complex64; 2], rates: [Complex64; 2], by: f64) -> [Complex64; 2] {
        [psi[0] + rates[0] * by, psi[1] + rates[1] * by]
    }

    /// Mean current and both lines of a run whose slip swings by a tenth about `slip`, after eight seconds for what dies out.
    fn simulated(p: &TParams<f64>, slip: f64) -> [Complex64; 3] {
        let swing = 2.0 * slip * OMEGA;
        let turns = TAU / swing.abs();
        let steps_a_turn = (turns / 1e-4).round();
        let h = turns / steps_a_turn;
        let omega_slip = |t: f64| slip * OMEGA * (1.0 + 0.1 * (swing * t).cos());
        let mut psi = [Complex64::new(0.0, -VOLTAGE / OMEGA); 2];
        let (before, turns_seen) = ((8.0 / turns).ceil() * steps_a_turn, 4.0 * steps_a_turn);
        let mut lines = [Complex64::ZERO; 3];
        for k in 0..(before + turns_seen) as u32 {
            let t = f64::from(k) * h;
            if f64::from(k) >= before {
                let i = currents(p, psi)[0] / turns_seen;
                let turned = Complex64::from_polar(1.0, swing * t);
                lines[0] += i;
                lines[1] += i * turned;
                lines[2] += i * turned.conj();
            }
            let k1 = rates(p, psi, omega_slip(t));
            let k2 = rates(p, moved(psi, k1, 0.5 * h), omega_slip(t + 0.5 * h));
            let k3 = rates(p, moved(psi, k2, 0.5 * h), omega_slip(t + 0.5 * h));
            let k4 = rates(p, moved(psi, k3, h), omega_slip(t + h));
            for n in 0..2 {
                psi[n] += (k1[n] + (k2[n] + k3[n]) * 2.0 + k4[n]) * (h / 6.0);
            }
        }
        lines
    }

    /// Motors of which only currents are measured are judged by the lower line alone.
    #[test]
    fn without_a_voltage_nothing_is_said_of_the_speed() {
        let driven = Driven {
            params: &circuit(CIRCUITS[0]),
            voltage: 0.0,
            omega_sync: OMEGA as f32,
        };
        let (upper, mean) = (Complex32::new(0.1, 0.05), Complex32::new(5.0, 0.0));
        assert_eq!(driven.mirrored(upper, mean, 0.03), Complex32::ZERO);
    }

    /// What is quadratic in a swing of a tenth is below a hundredth of it.
    #[test]
    fn one_line_of_a_swing_of_the_speed_follows_from_the_other() {
        for values in CIRCUITS {
            let p: TParams<f64> = circuit(values);
            for slip in [0.01, 0.035, -0.03] {
                let [mean, lower, upper] = simulated(&p, slip);
                let cast = |x: Complex64| Complex32::new(x.re as f32, x.im as f32);
                let driven = Driven {
                    params: &circuit(values),
                    voltage: VOLTAGE as f32,
                    omega_sync: OMEGA as f32,
                };
                let told = driven.mirrored(cast(upper), cast(mean), slip as f32);
                let off = (told - cast(lower)).norm() / cast(lower).norm();
                assert!(off < 0.01, "{p:?} at {slip}: {told} for {lower}, {off}");
            }
        }
    }
}
