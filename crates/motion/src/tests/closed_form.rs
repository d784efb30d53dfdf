//! Against what can be written down: a steady state in phasors, and a shaft under a constant torque.

use num_complex::{Complex32, Complex64};

use super::plant::{MOTOR, Plant, phases};
use super::{believed, root_mean_square};
use crate::{MotionSample, MotionState};
use monitor::Supply;
use monitor::{Abc, Sample, SpeedSample};

const T: f64 = 1e-4;

/// Phasors of the T circuit at a slip: current for a voltage of `volt`.
fn current(p: &Plant, volt: Complex64, omega: f64, slip: f64) -> Complex64 {
    let j = Complex64::I;
    let rotor = p.r_r / slip + j * omega * p.l_lr;
    let magnetizing = j * omega * p.l_m;
    let z = p.r_s + j * omega * p.l_ls + rotor * magnetizing / (rotor + magnetizing);
    volt / z
}

/// A motor in steady state at this slip, in phasors; the oscillator runs at `share` of its frequency, `angle` ahead.
fn steady(slip: f64, [angle, share]: [f64; 2]) -> Vec<[f32; 9]> {
    let omega = 314.159_265;
    let volt = Complex64::new(MOTOR.volt, 0.0);
    let i = current(&MOTOR, volt, omega, slip);
    let motion = believed(&MOTOR);
    let mut state = MotionState::default();
    let shown = |x: Complex64, turn: Complex64| Abc::from_array(phases(x * turn).map(|x| x as f32));
    let sample = |k: u32| {
        let t = f64::from(k) * T;
        let turn = Complex64::cis(omega * t);
        let axis = Complex64::cis(share * omega * t + angle);
        MotionSample {
            sample: Sample {
                u_s_abc: Some(shown(volt, turn)),
                i_s_abc: Some(shown(i, turn)),
                speed: SpeedSample::RadPerSecond((omega * (1.0 - slip) / MOTOR.n_p) as f32),
                tau_load: Some(0.0),
                ..Sample::default()
            },
            supply: Some(Supply {
                axis: Complex32::new(axis.re as f32, axis.im as f32),
                omega: omega as f32,
            }),
        }
    };
    let cycles = (0..12_000).filter_map(|k| motion.update(&mut state, &sample(k)));
    cycles.skip(50).map(|cycle| cycle.rows).collect()
}

/// Tolerance: the trapezoidal rule at 200 samples a cycle, `(w T)^2/12 = 8e-5`, and rounding.
#[test]
fn a_steady_motor_leaves_nothing_unexplained_at_any_angle_and_frequency_of_the_oscillator() {
    for slip in [0.01, 0.04, 0.3, 1.0] {
        for oscillator in [[0.0, 1.0], [2.0, 1.0], [0.5, 0.9]] {
            for rows in steady(slip, oscillator) {
                let largest = rows.iter().take(4).fold(0.0_f32, |a, x| a.max(x.abs()));
                assert!(largest < 2e-4, "slip {slip}: {rows:?}");
            }
        }
    }
}

/// The test above would not pass by being blind: 1 % of the magnetizing inductance moves E by `w L_m I_m` of it, and so do the
/// closed forms.
#[test]
fn a_wrong_inductance_shows_as_the_closed_form_says() {
    let wrong = Plant {
        l_m: 1.01 * MOTOR.l_m,
        ..MOTOR
    };
    let omega = 314.159_265;
    let slip = 0.03;
    let volt = Complex64::new(MOTOR.volt, 0.0);
    let i = current(&MOTOR, volt, omega, slip);
    // What the wrong circuit would need to carry the current.
    let expected = (volt - i * (volt / current(&wrong, volt, omega, slip))) / MOTOR.volt;
    let motion = believed(&wrong);
    let mut state = MotionState::default();
    let mut last = None;
    for k in 0..10_000 {
        let turn = Complex64::cis(omega * f64::from(k) * T);
        let shown = |x: Complex64| Abc::from_array(phases(x * turn).map(|x| x as f32));
        let sample = Sample {
            u_s_abc: Some(shown(volt)),
            i_s_abc: Some(shown(i)),
            speed: SpeedSample::RadPerSecond((omega * (1.0 - slip) / MOTOR.n_p) as f32),
            tau_load: Some(0.0),
            ..Sample::default()
        };
        let axis = Complex32::new(turn.re as f32, turn.im as f32);
        let supply = Some(Supply {
            axis,
            omega: omega as f32,
        });
        last = motion
            .update(&mut state, &MotionSample { sample, supply })
            .or(last);
    }
    let [re, im, ..] = last.expect("cycles").rows;
    let got = Complex64::new(f64::from(re), f64::from(im));
    assert!(expected.norm() > 2e-3, "{expected}");
    assert!(
        (got - expected).norm() < 0.05 * expected.norm() + 2e-4,
        "{got} {expected}"
    );
}

/// A shaft that speeds up evenly without a current: Q is `-(J a + B_t w)/T_n` with the speed in the middle of three cycles.
#[test]
fn the_torque_row_sees_inertia_and_friction_of_an_even_acceleration() {
    let motion = believed(&MOTOR);
    let mut state = MotionState::default();
    let acceleration = 200.0;
    let mut seen = Vec::new();
    for k in 0..2000 {
        let t = f64::from(k) * T;
        let sample = Sample {
            u_s_abc: Some(Abc::default()),
            i_s_abc: Some(Abc::default()),
            speed: SpeedSample::RadPerSecond((acceleration * t) as f32),
            tau_load: Some(0.0),
            ..Sample::default()
        };
        let supply = None;
        if let Some(cycle) = motion.update(&mut state, &MotionSample { sample, supply }) {
            seen.push((t, cycle.rows[4]));
        }
    }
    let errors = seen.iter().skip(2).map(|(t, q)| {
        let omega = acceleration * (t - 0.03);
        let expected = -(MOTOR.inertia * acceleration + MOTOR.friction * omega) / 14.6;
        q - expected as f32
    });
    // Rounding of angles: 1e-7 of a revolution over the square of a cycle, times the inertia.
    assert!(root_mean_square(errors) < 1e-3, "{seen:?}");
}
