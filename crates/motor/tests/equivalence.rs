//! The dynamic model against two independent simulators and against the closed-form steady state.

use motor::dynamic::{Dynamic, DynamicState};
use motor::{Mechanics, TParams};
use num_complex::Complex64;
use std::io::Read;

const T_HOLD: f64 = 1e-4;
const SYNC_SPEED: f64 = 2.0 * std::f64::consts::PI * 50.0 / 2.0;

fn machine() -> (TParams<f64>, Mechanics<f64>) {
    let params = TParams {
        r_s: 3.7,
        r_r: 2.296875,
        l_ls: 0.010735192570458851,
        l_lr: 0.010735192570458851,
        l_m: 0.23426480742954114,
    };
    let mechanics = Mechanics {
        n_p: 2.0,
        inertia: 0.015,
        friction: 0.0,
        load_friction: 0.0,
    };
    (params, mechanics)
}

/// Rows of the reference: t, u_alpha, u_beta, tau_load, then i_alpha, i_beta, speed of the first simulator.
fn reference() -> Vec<[f64; 7]> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/dol_start_rated_step.csv.gz"
    );
    let mut text = String::new();
    flate2::read::GzDecoder::new(std::fs::File::open(path).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let number = |row: &csv::StringRecord, k: usize| row[k].parse().unwrap();
    rows.records()
        .map(|row| row.unwrap())
        .map(|row| std::array::from_fn(|k| number(&row, k)))
        .collect()
}

/// Relative rms error of the current and largest speed error over synchronous speed.
fn deviation(substeps: usize) -> (f64, f64) {
    let (params, mechanics) = machine();
    let motor = Dynamic::new(&params, &mechanics);
    let mut state = DynamicState::rest();
    let h = T_HOLD / substeps as f64;
    let (mut error, mut power, mut speed_error) = (0.0, 0.0, 0f64);
    for [t, u_alpha, u_beta, tau, i_alpha, i_beta, speed] in reference() {
        let u = Complex64::new(u_alpha, u_beta);
        let i = Complex64::new(i_alpha, i_beta);
        error += (motor.current(t, &state, u) - i).norm_sqr();
        power += i.norm_sqr();
        speed_error = speed_error.max((state.omega_mech - speed).abs());
        for k in 0..substeps {
            motor.step(&mut state, t + h * k as f64, h, |_| u, |_, _| tau);
        }
    }
    ((error / power).sqrt(), speed_error / SYNC_SPEED)
}

#[test]
fn agrees_with_two_foreign_simulators_at_100_us() {
    let (current, speed) = deviation(1);
    println!("100 us: current {current:.2e}, speed {speed:.2e}");
    assert!(current < 1e-6, "current {current:e}");
    assert!(speed < 1e-6, "speed {speed:e}");
}

#[test]
fn agrees_with_two_foreign_simulators_at_10_us() {
    let (current, speed) = deviation(10);
    println!("10 us: current {current:.2e}, speed {speed:.2e}");
    assert!(current < 1e-9, "current {current:e}");
    assert!(speed < 1e-9, "speed {speed:e}");
}

/// Stator current phasor of the T equivalent circuit, independent of the crate's own steady state.
fn circuit_current(params: &TParams<f64>, u: f64, omega_sync: f64, slip: f64) -> Complex64 {
    let j = Complex64::i();
    let rotor = params.r_r / slip + j * omega_sync * params.l_lr;
    let magnetizing = j * omega_sync * params.l_m;
    let parallel = rotor * magnetizing / (rotor + magnetizing);
    u / (params.r_s + j * omega_sync * params.l_ls + parallel)
}

#[test]
fn settles_on_the_closed_form_steady_state() {
    let (params, mechanics) = machine();
    let motor = Dynamic::new(&params, &mechanics);
    let omega_sync = 2.0 * std::f64::consts::PI * 50.0;
    let supply = |t: f64| Complex64::from_polar(326.6, omega_sync * t);
    let mut state = DynamicState::rest();
    let (h, steps) = (2e-5, 150_000);
    for k in 0..steps {
        motor.step(&mut state, h * k as f64, h, supply, |_, _| 10.0);
    }
    let t = h * steps as f64;
    let slip = 1.0 - state.omega_mech * mechanics.n_p / omega_sync;
    let turned = motor.current(t, &state, supply(t)) * Complex64::from_polar(1.0, -omega_sync * t);
    let expected = circuit_current(&params, 326.6, omega_sync, slip);
    assert!((turned - expected).norm() < 1e-6 * expected.norm());
    assert!((motor.torque(t, &state) - 10.0).abs() < 1e-6 * 10.0);
}
