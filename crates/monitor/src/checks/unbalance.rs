//! Currents that are unbalanced further than the supply makes them, on a motor that was not calibrated.
//!
//! A symmetrical motor draws `I_2 = V_2/Z_2`. What is drawn beyond that comes from the motor (a resistance in one phase, shorted
//! turns) or from a current sensor, and r1..r4, which see the positive sequence alone, show little of it.

use motor::TParams;
use num_complex::Complex32;

use crate::config::MonitorConfig;
use crate::frames::magnitude;
use crate::isolation::impedance;
use crate::window::Window;

/// Share of the current that the channels' tolerances leave open: gains that are 15 % apart.
const OF_CURRENT: f32 = 0.05;
/// The same of the voltage: gains that are 6 % apart, whose negative sequence a motor answers as if it were the supply's.
const OF_VOLTAGE: f32 = 0.02;
/// Share of `V_2/Z_2` that an impedance from a plate or a data sheet leaves open.
const OF_IMPEDANCE: f32 = 0.5;

/// Negative sequence of the currents beyond what the voltages explain, over the most that tolerances leave open: beyond 1 it is a
/// fault. `None` without a supply, a current or a speed.
pub fn unexplained(params: &TParams<f32>, n_p: f32, window: &Window) -> Option<f32> {
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
    use crate::frames::Sequence;

    /// The 2.2 kW motor; an impedance of the negative sequence near 8.3 ohm.
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

    /// 35 % without any unbalance of the supply, as three times the resistance in one phase leaves it.
    #[test]
    fn an_unbalance_that_the_supply_does_not_explain_is_a_fault() {
        let beyond = unexplained(&MOTOR, 2.0, &window(0.0, 7.0, 2.45)).expect("a speed");
        assert!(beyond > 1.5, "{beyond}");
        assert_eq!(unexplained(&MOTOR, 2.0, &Window::default()), None);
    }

    /// 3 % of negative sequence draw 1.18 A (326.6 V x 0.03/8.3 ohm), whichever phase it has; sensors that are 3 % apart add a hundredth
    /// of the currents and of the voltages.
    #[test]
    fn what_the_supply_and_tolerances_make_is_none() {
        for i_1 in [2.8, 7.0] {
            let drawn = window(9.8, i_1, 1.18);
            for turn in [Complex32::ONE, Complex32::I, -Complex32::ONE] {
                let mut window = drawn;
                let z_2 = impedance(&MOTOR, 314.16, 1.95);
                window.u_s.negative *= turn;
                window.i_s.negative =
                    window.u_s.negative / z_2 + Complex32::new(0.01 * i_1 + 0.39, 0.0);
                let beyond = unexplained(&MOTOR, 2.0, &window).expect("a speed");
                assert!(beyond < 0.7, "{i_1} A: {beyond}");
            }
        }
    }
}
