//! Currents that are unbalanced further than the supply makes them, on a motor that was not calibrated.
//!
//! A symmetrical motor draws `I_2 = V_2/Z_2`. What is drawn beyond that comes from the motor (a resistance in one phase, shorted
//! turns) or from a current sensor, and r1..r4, which see the positive sequence alone, show little of it.

use motor::TParams;
use num_complex::Complex32;

use crate::config::MonitorConfig;
use crate::isolation::impedance;
use crate::window::Window;
use frames::magnitude;

/// Share of the current that the channels' tolerances leave open: gains that are 15 % apart.
const OF_CURRENT: f32 = 0.05;
/// The same of the voltage: gains that are 6 % apart, whose negative sequence a motor answers as if it were the supply's.
const OF_VOLTAGE: f32 = 0.02;
/// Share of `V_2/Z_2` that an impedance from a plate or a data sheet leaves open.
const OF_IMPEDANCE: f32 = 0.5;

/// Negative sequence of the currents beyond what the voltages explain, over the most that tolerances leave open: beyond 1 it is a
/// fault. `None` without a supply, a current or a speed, and for a calibrated motor, whose evidence holds its unbalance.
pub fn unexplained(config: &MonitorConfig, window: &Window) -> Option<f32> {
    if config.healthy.is_some() {
        return None;
    }
    unexplained_by(&config.params, config.mechanics.n_p, window)
}

fn unexplained_by(params: &TParams<f32>, n_p: f32, window: &Window) -> Option<f32> {
    let z_2 = impedance_of_negative(params, n_p, window)?;
    let (v, i) = (&window.u_s, &window.i_s);
    let explained: Complex32 = v.negative / z_2;
    let per_ohm = 1.0 / magnitude(z_2);
    let open = OF_CURRENT * magnitude(i.positive)
        + OF_VOLTAGE * magnitude(v.positive) * per_ohm
        + OF_IMPEDANCE * magnitude(explained);
    let beyond = magnitude(i.negative - explained) / open;
    beyond.is_finite().then_some(beyond)
}

fn impedance_of_negative(params: &TParams<f32>, n_p: f32, window: &Window) -> Option<Complex32> {
    let slip = (window.omega_sync + n_p * window.omega_mech?) / window.omega_sync;
    Some(impedance(params, window.omega_sync, slip))
}

/// Negative sequence of the currents beyond `V_2/Z_2`, A, seen in the channels' order of phases; `None` without a supply or a speed.
pub fn unexplained_current(config: &MonitorConfig, window: &Window) -> Option<Complex32> {
    let z_2 = impedance_of_negative(&config.params, config.mechanics.n_p, window)?;
    let has_voltages = window.u_s.positive.norm_sqr() > 0.0;
    let turned = magnitude(window.i_s.positive) / window.i_s.positive;
    let beyond = (window.i_s.negative - window.u_s.negative / z_2) * turned;
    (has_voltages && beyond.is_finite()).then(|| window.in_channels(beyond))
}

#[cfg(test)]
mod tests {
    use super::*;
    use frames::Sequence;
    use num_complex::Complex64;

    /// The 2.2 kW motor.
    const MOTOR: TParams<f32> = TParams {
        r_s: 3.706,
        r_r: 2.296,
        l_ls: 0.010_748,
        l_lr: 0.010_748,
        l_m: 0.234_12,
    };

    fn window(v_2: f32, i_1: f32, i_2: f32) -> Window {
        let sequence = |positive: f32, negative: f32| Sequence {
            positive: Complex32::new(positive, 0.0),
            negative: Complex32::new(negative, 0.0),
            zero: Complex32::ZERO,
        };
        Window {
            u_s: sequence(326.6, v_2),
            i_s: sequence(i_1, i_2),
            omega_sync: 314.16,
            omega_mech: Some(149.0),
            ..Window::default()
        }
    }

    /// `Z_2` of the T circuit at the slip of these windows, in double precision: 8.1 ohm.
    fn z_2() -> Complex64 {
        let slip = (314.16 + 2.0 * 149.0) / 314.16;
        let (r_s, r_r, l_l, l_m) = (3.706, 2.296, 0.010_748, 0.234_12);
        let reactance = |l: f64| Complex64::new(0.0, 314.16 * l);
        let (rotor, main) = (reactance(l_l) + r_r / slip, reactance(l_m));
        reactance(l_l) + r_s + main * rotor / (main + rotor)
    }

    /// The supply is sound: the limit is 5 % of the current and 2 % of the voltage over `Z_2`. 16 % of 7 A, a third of 2.8 A.
    #[test]
    fn without_an_unbalance_of_the_supply_the_limit_is_what_tolerances_leave_open() {
        for (i_1, share) in [(7.0, 0.16), (2.8, 0.33)] {
            let open = 0.05 * i_1 + 0.02 * 326.6 / z_2().norm();
            assert!((open / i_1 - share).abs() < 0.01, "{}", open / i_1);
            let beyond = unexplained_by(&MOTOR, 2.0, &window(0.0, i_1 as f32, open as f32));
            // Single precision, some ten operations.
            assert!((beyond.expect("a speed") - 1.0).abs() < 1e-5, "{beyond:?}");
        }
        assert_eq!(unexplained_by(&MOTOR, 2.0, &Window::default()), None);
    }

    /// 3 % of negative sequence draw `V_2/Z_2`, whichever angle they have. What sensors of their class add, gains 3 % apart, stays
    /// within the limit: a hundredth of the current and of the voltage over `Z_2`.
    #[test]
    fn what_the_supply_and_sensors_of_their_class_make_is_none() {
        for i_1 in [2.8, 7.0] {
            for turn in [Complex64::ONE, Complex64::I, -Complex64::ONE] {
                let v_2 = 0.03 * 326.6 * turn;
                let drawn = v_2 / z_2();
                let narrow = |x: Complex64| Complex32::new(x.re as f32, x.im as f32);
                let mut window = window(0.0, i_1 as f32, 0.0);
                window.u_s.negative = narrow(v_2);
                window.i_s.negative = narrow(drawn);
                let explained = unexplained_by(&MOTOR, 2.0, &window).expect("a speed");
                assert!(explained < 1e-5, "{i_1} A: {explained}");
                let tolerance = 0.01 * i_1 + 0.01 * 326.6 / z_2().norm();
                window.i_s.negative = narrow(drawn + tolerance);
                let beyond = unexplained_by(&MOTOR, 2.0, &window).expect("a speed");
                assert!(beyond < 1.0, "{i_1} A: {beyond}");
            }
        }
    }
}
