//! A motor that is switched off, against the closed forms of an open stator.

use super::*;
use num_complex::Complex64;

/// The speed decays with the friction, the flux of the rotor with its time constant, and no current flows.
#[test]
fn a_motor_that_is_switched_off_coasts_with_an_induced_voltage() {
    const OFF: f64 = 0.2;
    let mut scenario = ideal(1.0);
    scenario.supply.switch_off_s = Some(OFF);
    let (p, mechanics) = (&scenario.motor.parameters, &scenario.motor.mechanics);
    let (t_r, n_p) = (p.l_r() / p.r_r, mechanics.n_p);
    let t_m = mechanics.inertia / mechanics.total_friction();
    let samples = run(&scenario);
    let first = samples
        .iter()
        .find(|s| s.t >= OFF)
        .expect("it is long enough");
    let voltage = |s: &SimSample| clarke(s.truth.u_s_abc);
    // d psi_r/dt = (-1/T_r + j n_p w) psi_r, and the open stator holds L_m/L_r of it.
    let induced = |s: &SimSample| Complex64::new(-1.0 / t_r, n_p * s.truth.omega_mech).norm();
    let mut checked = 0;
    for sample in samples.iter().filter(|s| s.t >= OFF) {
        let dt = sample.t - first.t;
        assert!(
            sample.truth.i_s_abc.iter().all(|i| i.abs() < 1e-9),
            "{}",
            sample.t
        );
        let speed = first.truth.omega_mech * (-dt / t_m).exp();
        // The current that one integration step of 100 us lets flow brakes the shaft by less than this.
        assert!(
            (sample.truth.omega_mech / speed - 1.0).abs() < 1e-5,
            "{}",
            sample.t
        );
        // Within an integration step the voltage turns but does not decay: by half of 100 us over T_r, 0.8 per mille here.
        let expected = (-dt / t_r).exp() * induced(sample) / induced(first);
        let shown = voltage(sample).norm() / voltage(first).norm();
        assert!(
            (shown / expected - 1.0).abs() < 1e-3,
            "{}: {shown} {expected}",
            sample.t
        );
        checked += 1;
    }
    assert!(checked > 1000);
}
