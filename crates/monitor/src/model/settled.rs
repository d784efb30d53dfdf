//! The derivative terms of (36): what a changing motor would show if it stood still at the same flux and slip.
//!
//! With `D = d psi_r/dt` and `d psi_s/dt` in the frame of the voltage the exact equations of the T model
//!
//! ```text
//! u = R_s i + d psi_s/dt + j w_s psi_s
//! D + j w_sl psi_r = -(R_r/L_r) psi_r + (R_r L_m/L_r) i
//! J dw/dt = tau_e - tau
//! ```
//!
//! are those of steady state for `i - D L_r/(R_r L_m)` in the place of `i`, a voltage that carries this current at the same
//! rotor flux, and a torque that takes the acceleration along. So everything that is computed from a steady point holds
//! while supply, frequency, speed or load move along straight lines; what bends is a transient.

use motor::Mechanics;
use motor::steady_state::rotor_flux;
use num_complex::Complex32;

use crate::model::effects::Corrected;
use crate::window::Rates;
use frames::magnitude;

/// The point at rest that a moving one stands for.
pub fn settled(
    moving: &Corrected,
    rates: &Rates,
    omega_sync: f32,
    mechanics: &Mechanics<f32>,
) -> Corrected {
    let p = &moving.params;
    let length = magnitude(moving.u_s);
    if length <= f32::MIN_POSITIVE || omega_sync <= f32::MIN_POSITIVE {
        return *moving;
    }
    let axis = moving.u_s / length;
    let (du, di) = (axis * rates.voltage, axis * rates.current);
    let turn = Complex32::new(0.0, omega_sync);
    // The stator's equation differentiated: d psi_s/dt follows the voltage, and the frequency the other way.
    let psi_s = (moving.u_s - moving.i_s * p.r_s) / turn;
    let psi_s_rate = (du - di * p.r_s) / turn - psi_s * (rates.supply / omega_sync);
    let psi_r_rate = (psi_s_rate - di * p.l_a()) * (p.l_r() / p.l_m);
    let psi_r = rotor_flux(p, moving.u_s - psi_s_rate, moving.i_s, omega_sync);
    let charging = psi_r_rate * (p.l_r() / (p.r_r * p.l_m));
    let tau_charging = 1.5 * mechanics.n_p * (psi_r.conj() * psi_r_rate).im / p.r_r;
    let impedance = Complex32::new(p.r_s, omega_sync * p.l_a());
    Corrected {
        u_s: moving.u_s - psi_s_rate - impedance * charging,
        i_s: moving.i_s - charging,
        tau_extra: moving.tau_extra + mechanics.inertia * rates.speed - tau_charging,
        ..*moving
    }
}

#[cfg(test)]
mod tests {
    use motor::TParams;
    use motor::dynamic::{Dynamic, DynamicState};
    use motor::steady_state::SteadyState;
    use num_complex::Complex64;

    use super::*;
    use crate::model::operating_point::{Frame, OperatingPoint};
    use crate::model::residuals::{FieldCurrent, ResidualModel};

    const PARAMS: TParams<f64> = TParams {
        r_s: 3.7,
        r_r: 2.3,
        l_ls: 0.0107,
        l_lr: 0.0107,
        l_m: 0.234,
    };
    const OMEGA: f64 = 314.159;

    fn single(x: Complex64) -> Complex32 {
        Complex32::new(x.re as f32, x.im as f32)
    }

    /// What moves: the supply falls by `fall` of itself and its frequency rises by `rise` of itself per second, the load
    /// grows by `growth` N m/s.
    #[derive(Clone, Copy, Debug)]
    struct Ramp {
        fall: f64,
        rise: f64,
        growth: f64,
    }

    /// The five-state motor on a ramp: residuals at half a second, when what the beginning of the ramp excited has died
    /// away.
    fn residuals_of_a_ramp(ramp: Ramp, carried: bool) -> [f32; 4] {
        let Ramp { fall, rise, growth } = ramp;
        let mechanics = Mechanics {
            n_p: 2.0,
            inertia: 0.015,
            friction: 0.0,
            load_friction: 0.0,
        };
        let motor = Dynamic::new(&PARAMS, &mechanics);
        let angle = |t: f64| OMEGA * t * (1.0 + 0.5 * rise * t);
        let supply = |t: f64| Complex64::from_polar(326.6 * (1.0 - fall * t), angle(t));
        let load = |t: f64, _| 8.0 + growth * t;
        let start = SteadyState::new(&PARAMS, 2.0, supply(0.0), OMEGA);
        let point = start.at_torque(8.0).expect("below breakdown");
        let mut state = DynamicState::rest();
        (state.psi_s, state.psi_r) = (point.psi_s, point.psi_r);
        state.omega_mech = point.omega_mech;
        let h = 5e-5;
        let seen = |state: &DynamicState<_>, t: f64| {
            let i = motor.flow(t, state, supply(t), load(t, 0.0)).terminal.i;
            (i * Complex64::cis(-angle(t)), state.omega_mech)
        };
        let (mut before, mut now, mut after) = (
            (Complex64::ZERO, 0.0),
            (Complex64::ZERO, 0.0),
            (Complex64::ZERO, 0.0),
        );
        for k in 0..10_401 {
            let t = f64::from(k) * h;
            match k {
                9_600 => before = seen(&state, t),
                10_000 => now = seen(&state, t),
                10_400 => after = seen(&state, t),
                _ => {}
            }
            motor.step(&mut state, t, h, supply, load);
        }
        let rates = Rates {
            voltage: (-326.6 * fall) as f32,
            current: single((after.0 - before.0) / (800.0 * h)),
            speed: ((after.1 - before.1) / (800.0 * h)) as f32,
            supply: (OMEGA * rise) as f32,
        };
        let t = 10_000.0 * h;
        let omega = (OMEGA * (1.0 + rise * t)) as f32;
        let moving = Corrected {
            u_s: single(supply(t) * Complex64::cis(-angle(t))),
            i_s: single(now.0),
            omega_mech: now.1 as f32,
            params: TParams {
                r_s: 3.7,
                r_r: 2.3,
                l_ls: 0.0107,
                l_lr: 0.0107,
                l_m: 0.234,
            },
            tau_extra: 0.0,
        };
        let mechanics = Mechanics {
            n_p: 2.0,
            inertia: 0.015,
            friction: 0.0,
            load_friction: 0.0,
        };
        let measured = if carried {
            settled(&moving, &rates, omega, &mechanics)
        } else {
            moving
        };
        let model = ResidualModel {
            mechanics,
            field: FieldCurrent::Live,
            rated_torque: 14.6,
        };
        let omega_el = 2.0 * measured.omega_mech;
        let point =
            OperatingPoint::new(&measured, Frame::RotorFlux, omega, omega_el).expect("a frame");
        model.evaluate(&point, Some(load(t, 0.0) as f32)).r
    }

    /// A supply that falls by 3.3 % a second or speeds up by 5 Hz a second, and a load that grows by half of rated torque a
    /// second: without the terms r1 errs by a third of a per cent and more, with them by what is of second order.
    #[test]
    fn a_motor_on_a_ramp_shows_what_it_would_show_at_rest() {
        for (fall, rise, growth) in [
            (0.033, 0.0, 0.0),
            (-0.05, 0.0, 0.0),
            (0.0, 0.0, 7.0),
            (0.02, 0.0, -5.0),
            (0.0, 0.1, 0.0),
            (0.0, -0.1, 0.0),
            (-0.1, 0.1, 3.0),
        ] {
            let ramp = Ramp { fall, rise, growth };
            let [without, with] = [false, true].map(|carried| residuals_of_a_ramp(ramp, carried));
            let largest = |r: [f32; 4]| r.iter().fold(0.0_f32, |a, x| a.max(x.abs()));
            assert!(largest(without) > 1e-3, "{without:?}");
            assert!(
                largest(with) < 2e-4,
                "{ramp:?}: {with:?} instead of {without:?}"
            );
        }
    }

    #[test]
    fn at_rest_nothing_is_carried() {
        let measured = Corrected {
            u_s: Complex32::new(300.0, 20.0),
            i_s: Complex32::new(3.0, -4.0),
            omega_mech: 150.0,
            params: TParams {
                r_s: 3.7,
                r_r: 2.3,
                l_ls: 0.0107,
                l_lr: 0.0107,
                l_m: 0.234,
            },
            tau_extra: 0.5,
        };
        let mechanics = Mechanics {
            n_p: 2.0,
            inertia: 0.015,
            friction: 0.0,
            load_friction: 0.0,
        };
        assert_eq!(
            settled(&measured, &Rates::default(), 314.0, &mechanics),
            measured
        );
        let dark = Corrected {
            u_s: Complex32::ZERO,
            ..measured
        };
        let rates = Rates {
            voltage: 1.0,
            ..Rates::default()
        };
        assert_eq!(settled(&dark, &rates, 314.0, &mechanics), dark);
    }
}
