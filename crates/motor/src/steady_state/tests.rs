use super::*;
use num_complex::Complex64;
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::vec::Vec;

/// The parameter space: from a 100 W to a 1 MW machine, leakage factor 0.02 to 0.3.
pub(crate) fn motors() -> impl Strategy<Value = TParams<f64>> {
    (
        -2.5..1.5_f64,
        0.02..0.4_f64,
        0.02..0.4_f64,
        0.01..0.2_f64,
        0.01..0.2_f64,
    )
        .prop_map(|(scale, r_s, r_r, ls, lr)| {
            let l_m = 0.2 * 10f64.powf(scale);
            let x_m = TAU * 50.0 * l_m;
            TParams {
                r_s: 0.1 * r_s * x_m,
                r_r: 0.1 * r_r * x_m,
                l_ls: ls * l_m,
                l_lr: lr * l_m,
                l_m,
            }
        })
}

fn example() -> TParams<f64> {
    TParams {
        r_s: 3.7,
        r_r: 2.296875,
        l_ls: 0.0107,
        l_lr: 0.0107,
        l_m: 0.234,
    }
}

fn volt(amplitude: f64) -> Complex64 {
    Complex64::new(amplitude, 0.0)
}

/// The textbook circuit, with impedances and the slip: `R_s + jX_ls + jX_m || (R_r/s + jX_lr)`.
fn textbook(p: &TParams<f64>, n_p: f64, u: f64, omega: f64, slip: f64) -> (Complex64, f64) {
    let x = |l: f64| Complex64::new(0.0, omega * l);
    let rotor = p.r_r / slip + x(p.l_lr);
    let z_m = x(p.l_m);
    let i_s = u / (p.r_s + x(p.l_ls) + z_m * rotor / (z_m + rotor));
    let i_r = i_s * z_m / (z_m + rotor);
    let air_gap_power = 1.5 * i_r.norm_sqr() * p.r_r / slip;
    (i_s, air_gap_power * n_p / omega)
}

/// Seeded: the same machines in every run.
pub(crate) fn seeded() -> ProptestConfig {
    ProptestConfig {
        cases: 4000,
        rng_seed: proptest::test_runner::RngSeed::Fixed(8372),
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(seeded())]

    /// Two ways of writing the same circuit; 1e-11 leaves room for the cancellation in `z_m + rotor`.
    #[test]
    fn currents_and_torque_are_the_textbook_circuits(
        p in motors(), slip in 0.001..1.5_f64, hz in 5.0..100.0_f64
    ) {
        let omega = TAU * hz;
        let point = SteadyState::new(&p, 3.0, volt(100.0), omega).at_slip_speed(slip * omega);
        let (i_s, tau) = textbook(&p, 3.0, 100.0, omega, slip);
        prop_assert!((point.i_s - i_s).norm() < 1e-11 * i_s.norm());
        prop_assert!((point.tau_em - tau).abs() < 1e-11 * tau.abs());
    }

    /// Power balance: what enters is copper losses and air-gap torque times shaft speed.
    #[test]
    fn power_is_conserved(p in motors(), slip in -0.5..1.5_f64) {
        let omega = TAU * 50.0;
        let point = SteadyState::new(&p, 2.0, volt(300.0), omega).at_slip_speed(slip * omega);
        let copper = 1.5 * (p.r_s * point.i_s.norm_sqr() + p.r_r * point.i_r.norm_sqr());
        let out = copper + point.power_mech();
        prop_assert!((point.power_in() - out).abs() < 1e-12 * (copper + point.power_mech().abs()));
    }

    /// Every torque below breakdown comes back, on the stable side of the breakdown slip.
    #[test]
    fn a_torque_is_found_again(p in motors(), share in -0.999..0.999_f64) {
        let motor = SteadyState::new(&p, 2.0, volt(300.0), TAU * 50.0);
        let curve = motor.curve;
        let limit = curve.torque(curve.breakdown_slip().copysign(share)).abs();
        let point = motor.at_torque(share * limit).expect("below breakdown");
        prop_assert!((point.tau_em - share * limit).abs() < 1e-10 * limit);
        prop_assert!(point.omega_slip.abs() <= curve.breakdown_slip());
    }

    /// The balance holds for every friction, and the rotor flux of the terminals is the model's.
    #[test]
    fn friction_balances_torque(p in motors(), b_t in 0.0..10.0_f64) {
        let motor = SteadyState::new(&p, 2.0, volt(300.0), TAU * 50.0);
        let point = motor.at_friction(b_t);
        let load = b_t * point.omega_mech;
        let (breakdown, _) = motor.breakdown();
        prop_assert!((point.tau_em - load).abs() < 1e-9 * breakdown);
        let flux = rotor_flux(&p, point.u_s, point.i_s, point.omega_sync);
        prop_assert!((flux - point.psi_r).norm() < 1e-10 * point.psi_r.norm());
    }

    /// (13)-(29) in the rotor-flux frame: `|psi_r| = L_m I_d` and `w_sl |psi_r| = R_r (L_m/L_r) I_q`.
    #[test]
    fn the_rotor_flux_frame_decouples_flux_and_torque(p in motors(), slip in -0.5..1.0_f64) {
        let omega = TAU * 50.0;
        let point = SteadyState::new(&p, 2.0, volt(300.0), omega).at_slip_speed(slip * omega);
        let dq = point.in_rotor_flux_frame();
        let psi = point.psi_r.norm();
        prop_assert!((psi - p.l_m * dq.i_d).abs() < 1e-12 * p.l_m * point.i_s.norm());
        let q = p.r_r * p.l_m / p.l_r() * dq.i_q;
        prop_assert!((point.omega_slip * psi - q).abs() < 1e-11 * (q.abs() + p.r_r * psi / p.l_r()));
        let k_f = 1.5 * 2.0 * p.l_m * p.l_m / p.l_r() * dq.i_d;
        prop_assert!((point.tau_em - k_f * dq.i_q).abs() < 1e-11 * k_f * point.i_s.norm());
    }
}

#[test]
fn the_voltage_frame_puts_the_voltage_on_q() {
    let motor = SteadyState::new(
        &example(),
        2.0,
        Complex64::from_polar(326.6, 1.1),
        TAU * 50.0,
    );
    let dq = motor.at_speed(150.0).in_voltage_frame();
    assert!(dq.u_d.abs() < 1e-12 && (dq.u_q - 326.6).abs() < 1e-10);
    // Motoring: the current lags, so part of it is along +q and the magnetizing part along +d.
    assert!(dq.i_q > 0.0 && dq.i_d > 0.0);
}

#[test]
fn torque_beyond_breakdown_is_refused_with_the_limit() {
    let motor = SteadyState::new(&example(), 2.0, volt(326.6), TAU * 50.0);
    let (breakdown, slip) = motor.breakdown();
    // A scan of the textbook circuit finds the same maximum.
    let scan: Vec<f64> = (1..20_000)
        .map(|i| textbook(&example(), 2.0, 326.6, TAU * 50.0, f64::from(i) / 20_000.0).1)
        .collect();
    let largest = scan.iter().copied().fold(0.0, f64::max);
    assert!(
        (largest / breakdown - 1.0).abs() < 1e-7,
        "{largest} {breakdown}"
    );
    assert!(motor.at_torque(0.9999 * breakdown).is_ok());
    let error = motor.at_torque(1.0001 * breakdown).expect_err("beyond");
    assert!((error.breakdown_nm - breakdown).abs() < 1e-12 * breakdown);
    assert!(error.to_string().contains("breakdown torque is"));
    assert!(motor.at_torque(f64::NAN).is_err());
    assert!(motor.at_load(|_| 1.0001 * breakdown).is_err());
    let held = motor.at_load(|_| 0.5 * breakdown).expect("below");
    assert!(held.omega_slip < slip);
}

#[test]
fn single_precision_gives_the_same_point() {
    let p = example();
    let narrow = TParams {
        r_s: p.r_s as f32,
        r_r: p.r_r as f32,
        l_ls: p.l_ls as f32,
        l_lr: p.l_lr as f32,
        l_m: p.l_m as f32,
    };
    let wide = SteadyState::new(&p, 2.0, volt(326.6), TAU * 50.0).at_friction(0.09);
    let omega = core::f32::consts::TAU * 50.0;
    let point = SteadyState::new(&narrow, 2.0, Complex::new(326.6, 0.0), omega).at_friction(0.09);
    // A dozen roundings of 6e-8, amplified by w_s/w_sl = 20 where the slip is a difference of speeds.
    let error =
        (f64::from(point.i_s.re) - wide.i_s.re).hypot(f64::from(point.i_s.im) - wide.i_s.im);
    assert!(error < 2e-5 * wide.i_s.norm(), "{error}");
}

/// The torque curve is the textbook circuit's on both sides of synchronous speed; what is asked is found on the stable side.
#[test]
fn a_load_that_drives_the_motor_is_met_above_synchronous_speed() {
    let motor = SteadyState::new(&example(), 2.0, volt(326.6), TAU * 50.0);
    let (_, breakdown_slip) = motor.breakdown();
    let generating = motor.at_slip_speed(-breakdown_slip).tau_em;
    let friction = 0.001;
    for share in [1e-6, 0.05, 0.5, 0.95] {
        let load = |w: f64| share * generating + friction * w;
        let point = motor.at_load(load).expect("below the breakdown torque");
        let (_, tau) = textbook(&example(), 2.0, 326.6, TAU * 50.0, point.slip());
        let off = tau - load(point.omega_mech);
        assert!(off.abs() < 1e-9 * generating.abs(), "{share}: {off}");
        assert!(point.omega_slip.abs() < breakdown_slip, "{share}");
    }
    assert!(motor.at_load(|_| 0.05 * generating).unwrap().omega_slip < 0.0);
    // Driven, but less than its friction takes: still a motor.
    let held = motor.at_load(|w| -0.1 + 0.001 * w).expect("a motor");
    assert!(held.omega_slip > 0.0);
    let error = motor.at_load(|_| 1.001 * generating).expect_err("beyond");
    assert!((error.breakdown_nm - generating).abs() < 1e-9 * generating.abs());
    assert!((error.asked_nm - 1.001 * generating).abs() < 1e-9 * generating.abs());
}
