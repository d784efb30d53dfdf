//! The state in which a motor has settled on a supply of several frequencies, at a constant speed.

use super::DynamicState;
use crate::TParams;
use crate::steady_state::SteadyState;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// A part of the supply that turns at one speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotating {
    /// Angular frequency, rad/s; negative turns backwards.
    pub omega: f64,
    /// Voltage vector at this instant, V.
    pub u: Complex64,
}

/// Highest order of a cycle that is looked for; a simulated supply has no higher one.
const HIGHEST_ORDER: i32 = 49;
/// Samples that the fastest turn of a component takes at least: fewer do not tell it from others.
const SAMPLES_PER_TURN: f64 = 4.0;

impl DynamicState {
    /// Steady state of the linear motor (theory (1) to (4)) at `omega_mech` (rad/s, mechanical) on the sum of `voltages`: at
    /// a constant speed the winding equations are linear, and each frequency settles by itself.
    pub fn settled(motor: &TParams<f64>, n_p: f64, omega_mech: f64, voltages: &[Rotating]) -> Self {
        let mut state = Self {
            omega_mech,
            ..Self::rest()
        };
        for &Rotating { omega, u } in voltages {
            let point = SteadyState::new(motor, n_p, u, omega).at_speed(omega_mech);
            state.psi_s += point.psi_s;
            state.psi_r += point.psi_r;
        }
        state
    }
}

/// What a sampled voltage vector (V) repeats in the cycle that begins with its first sample: fundamental, negative sequence and
/// harmonics. A supply that ends or stands still within the cycle counts as its fundamental.
///
/// `omega_sync` in rad/s, `t_sample` in s.
pub fn cycle_components(u_s: &[Complex64], omega_sync: f64, t_sample: f64) -> Vec<Rotating> {
    let cycle = TAU / omega_sync.abs() / t_sample;
    if !(cycle >= SAMPLES_PER_TURN && cycle + 1.0 < u_s.len() as f64) {
        let alone = |&u: &Complex64| Rotating {
            omega: omega_sync,
            u,
        };
        return u_s.first().map(alone).into_iter().collect();
    }
    let highest = HIGHEST_ORDER.min((cycle / SAMPLES_PER_TURN) as i32);
    let orders = (-highest..=highest).filter(|&order| order != 0);
    let speeds = orders.map(|order| f64::from(order) * omega_sync);
    let component = |omega| Rotating {
        omega,
        u: mean_in_turn(u_s, omega * t_sample, cycle),
    };
    speeds.map(component).collect()
}

/// Mean of samples turned back by `angle` (rad) for each of them, over `n` samples, a fraction included.
///
/// The trapezoidal rule over a whole period of a periodic signal has no error of its own; the last, broken interval is
/// interpolated.
fn mean_in_turn(u: &[Complex64], angle: f64, n: f64) -> Complex64 {
    let whole = n as usize;
    let rest = n - whole as f64;
    let back = Complex64::from_polar(1.0, -angle);
    let (mut turn, mut inner) = (Complex64::ONE, Complex64::ZERO);
    for u in &u[1..whole] {
        turn *= back;
        inner += u * turn;
    }
    let last = u[whole] * turn * back;
    let end = last + (u[whole + 1] * turn * back * back - last) * rest;
    (0.5 * (u[0] + last) + inner + 0.5 * rest * (last + end)) / n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mechanics;
    use crate::dynamic::{Dynamic, NoEffects};

    const OMEGA: f64 = TAU * 60.0;

    /// Mains with a negative sequence and two harmonics, V: order and amplitude.
    fn parts() -> [(f64, Complex64); 4] {
        [
            (1.0, Complex64::from_polar(180.0, 0.4)),
            (-1.0, Complex64::from_polar(4.0, -1.0)),
            (-5.0, Complex64::from_polar(7.0, 0.2)),
            (7.0, Complex64::from_polar(3.0, 2.0)),
        ]
    }

    fn supply(t: f64) -> Complex64 {
        let turned =
            |(order, u): (f64, Complex64)| u * Complex64::from_polar(1.0, order * OMEGA * t);
        parts().into_iter().map(turned).sum()
    }

    /// A cycle of 166.67 samples: a whole number of them is not needed.
    #[test]
    fn a_cycle_holds_its_parts() {
        let t_sample = 1e-4;
        let u: Vec<Complex64> = (0..400).map(|k| supply(k as f64 * t_sample)).collect();
        let found = cycle_components(&u, OMEGA, t_sample);
        // Up to 41 at 167 samples a cycle.
        assert_eq!(found.len(), 82);
        for part in found {
            let order = (part.omega / OMEGA).round();
            let there = parts().into_iter().find(|(n, _)| *n == order);
            let expected = there.map_or(Complex64::ZERO, |(_, u)| u);
            // The broken interval at the end, one of 167, is a straight line where the highest order turns by 86 degrees:
            // 180 V (1 - cos 43 degrees) / 167 at the most.
            assert!((part.u - expected).norm() < 0.3, "{order}: {}", part.u);
        }
    }

    /// Less than a cycle, or a supply that turns too fast for its samples, is what it is at this instant.
    #[test]
    fn too_little_is_a_fundamental() {
        let u = [Complex64::new(3.0, 4.0); 5];
        let alone = |omega| vec![Rotating { omega, u: u[0] }];
        assert_eq!(cycle_components(&u, OMEGA, 1e-4), alone(OMEGA));
        assert_eq!(cycle_components(&u, 1e6, 1e-4), alone(1e6));
        assert_eq!(cycle_components(&u, 0.0, 1e-4), alone(0.0));
        assert!(cycle_components(&[], OMEGA, 1e-4).is_empty());
    }

    /// The dynamic model, begun there at a speed that its inertia holds, repeats itself from the first cycle on.
    #[test]
    fn a_settled_motor_stays_so() {
        let motor = TParams {
            r_s: 8.0,
            r_r: 7.0,
            l_ls: 0.028,
            l_lr: 0.028,
            l_m: 0.42,
        };
        let mechanics = Mechanics {
            n_p: 2.0,
            inertia: 1e9,
            friction: 0.0,
            load_friction: 0.0,
        };
        let omega_mech = 0.97 * OMEGA / mechanics.n_p;
        let voltages = parts().map(|(order, u)| Rotating {
            omega: order * OMEGA,
            u,
        });
        let begin = DynamicState::settled(&motor, mechanics.n_p, omega_mech, &voltages);
        let model = Dynamic::with_effects(&motor, &mechanics, NoEffects);
        let (mut state, h) = (begin, 1.0 / 60.0 / 1000.0);
        for k in 0..1000 {
            model.step(&mut state, h * f64::from(k), h, supply, |_, _| 0.0);
        }
        let moved = (state.psi_s - begin.psi_s).norm() + (state.psi_r - begin.psi_r).norm();
        // A Runge-Kutta step of 2.6 degrees of the seventh harmonic, a thousand times.
        assert!(moved < 1e-7 * begin.psi_s.norm(), "{moved}");
    }
}
