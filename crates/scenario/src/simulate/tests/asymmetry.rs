//! Resistance in series with one phase against symmetrical components by hand; broken bars by their sideband.

use crate::simulate::*;
use crate::tests::parse;
use crate::{Fault, SensorSpec};
use motor::dynamic::clarke;
use std::f64::consts::TAU;

/// Share of R_s in series with one phase, percent.
const SERIES_PERCENT: f64 = 30.0;
/// Long enough to part sidebands of some Hz.
const DURATION_S: f64 = 3.0;

fn scenario(faults: &[(&str, f64)]) -> Scenario {
    let mut scenario = parse(&format!("start = \"running\"\nduration_s = {DURATION_S}"));
    scenario.sensors = SensorSpec::ideal(scenario.sensors);
    let fault = |(name, percent): &(&str, f64)| Fault::percent(name, *percent, Frame::Voltage);
    scenario.faults = faults
        .iter()
        .map(|named| fault(named).expect("known"))
        .collect();
    scenario
}

fn samples(scenario: &Scenario) -> Vec<SimSample> {
    Simulation::new(scenario).expect("runs").collect()
}

/// The component of a current vector that turns at `hz`, over the last half second: whole cycles of 60 Hz.
fn component(samples: &[SimSample], hz: f64) -> Complex64 {
    let last = &samples[samples.len() - 5000..];
    let turned = |sample: &SimSample| {
        clarke(sample.truth.i_s_abc) * Complex64::from_polar(1.0, -TAU * hz * sample.t)
    };
    last.iter().map(turned).sum::<Complex64>() / last.len() as f64
}

/// Negative sequence of the T model at slip `2 - s`: `R_s + j w L_ls + j w L_m || (R_r/(2 - s) + j w L_lr)`.
fn negative_impedance(scenario: &Scenario, omega_mech: f64) -> Complex64 {
    let p = &scenario.motor.parameters;
    let omega = scenario.motor.nameplate.omega_sync();
    let slip = 1.0 - omega_mech * scenario.motor.mechanics.n_p / omega;
    let x = |l: f64| Complex64::new(0.0, omega * l);
    let rotor = p.r_r / (2.0 - slip) + x(p.l_lr);
    p.r_s + x(p.l_ls) + x(p.l_m) * rotor / (x(p.l_m) + rotor)
}

/// `R` in series with phase a: `0 = Z_2 I_2 + R/3 (I_1 + I_2)`; in b and c the first current turns by 120 degrees each.
#[test]
fn resistance_in_one_phase_drives_the_negative_sequence_of_symmetrical_components() {
    let hz = scenario(&[]).motor.nameplate.frequency_hz;
    for (k, name) in ["Rsa", "Rsb", "Rsc"].into_iter().enumerate() {
        let scenario = scenario(&[(name, SERIES_PERCENT)]);
        let samples = samples(&scenario);
        let omega_mech = samples.last().expect("some").truth.omega_mech;
        let series = SERIES_PERCENT / 100.0 * scenario.motor.parameters.r_s / 3.0;
        let own = negative_impedance(&scenario, omega_mech) + series;
        let turn = Complex64::from_polar(1.0, TAU / 3.0 * k as f64);
        // The space vector of the negative sequence is the conjugate of its phasor.
        let i_1 = component(&samples, hz);
        let expected = -series * turn * i_1 / own;
        let measured = component(&samples, -hz).conj();
        let error = (measured - expected).norm() / expected.norm();
        // RK4 settles to 1e-7, the shaft trembles at twice the frequency by less than 1e-3 of the slip.
        assert!(error < 1e-2, "{name}: {measured} for {expected}");
    }
}

#[test]
fn the_same_resistance_in_all_phases_is_a_higher_stator_resistance() {
    let all = samples(&scenario(&[("Rsa", 20.0), ("Rsb", 20.0), ("Rsc", 20.0)]));
    let one = samples(&scenario(&[("Rs", 20.0)]));
    for (a, b) in all.iter().zip(&one) {
        // Rounding of three vectors that cancel.
        assert!((a.truth.i_s_abc[1] - b.truth.i_s_abc[1]).abs() < 1e-9);
    }
}

#[test]
fn broken_bars_are_switched_in_and_show_at_twice_the_slip() {
    let mut broken = scenario(&[("bars", 10.0)]);
    broken.faults[0].from_s = 0.2;
    let (broken, healthy) = (samples(&broken), samples(&scenario(&[])));
    let at = |samples: &[SimSample], k: usize| samples[k].truth.i_s_abc[0];
    assert_eq!(at(&broken, 1999), at(&healthy, 1999));
    let truth = broken.last().expect("some").truth;
    let slip = 1.0 - truth.omega_mech / scenario(&[]).motor.nameplate.synchronous_speed_mech();
    let sideband = |samples: &[SimSample]| hann(samples, 60.0 * (1.0 - 2.0 * slip)).norm();
    // The window leaks the fundamental into both alike, some 1e-4 of it.
    assert!(sideband(&broken) > 5.0 * sideband(&healthy));
}

/// As [`component`], over the last two seconds under a Hann window: 1 Hz to either side.
fn hann(samples: &[SimSample], hz: f64) -> Complex64 {
    let last = &samples[samples.len() - 20_000..];
    let turned = |(k, sample): (usize, &SimSample)| {
        let weight = 1.0 - (TAU * k as f64 / last.len() as f64).cos();
        weight * clarke(sample.truth.i_s_abc) * Complex64::from_polar(1.0, -TAU * hz * sample.t)
    };
    last.iter().enumerate().map(turned).sum::<Complex64>() / last.len() as f64
}

#[test]
fn broken_bars_beyond_the_whole_cage_are_refused() {
    let error = Simulation::new(&scenario(&[("bars", 900.0)])).expect_err("too large");
    assert!(error.to_string().contains("another size"), "{error}");
}
