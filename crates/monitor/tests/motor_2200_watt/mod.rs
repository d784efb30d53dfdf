//! The 2.2 kW motor of the tests: 50 Hz, two pole pairs, a fan of 10 N m at rated speed. Used by unit and integration tests.

use std::f64::consts::TAU;

use motor::{Mechanics, TParams};

// Named by the parent: to the unit tests it is this crate, to the others another one.
use super::monitor::{
    CHANNELS, Cage, ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind, MAX_EFFECTS,
    MonitorConfig,
};

/// Synchronous, electrical, rad/s.
pub const OMEGA_SYNC: f64 = TAU * 50.0;
/// Crest of the rated phase voltage, V.
pub const AMPLITUDE: f64 = 326.6;
/// Of motor and load together, N m s.
pub const FRICTION: f64 = 0.065;
/// Crest that a sensor can show: V, A.
pub const FULL_SCALE: [f64; 2] = [600.0, 60.0];
pub const COUNTS_PER_REVOLUTION: f64 = 4096.0;

pub const PARAMS: TParams<f64> = TParams {
    r_s: 3.7,
    r_r: 2.3,
    l_ls: 0.0107,
    l_lr: 0.0107,
    l_m: 0.234,
};

/// A monitor that knows this motor, at 10 kHz, without a calibration.
pub fn config() -> MonitorConfig {
    let [volt, ampere] = FULL_SCALE.map(|x| x as f32);
    MonitorConfig {
        t_sample: 1e-4,
        converter: Converter::bipolar(volt, ampere, 12),
        encoder_counts_per_revolution: COUNTS_PER_REVOLUTION as f32,
        params: single(PARAMS),
        effects: [None; MAX_EFFECTS],
        laws: Default::default(),
        channel_gain: [1.0; CHANNELS],
        mechanics: Mechanics {
            n_p: 2.0,
            inertia: 0.015,
            friction: 0.0,
            load_friction: FRICTION as f32,
        },
        rated_voltage: AMPLITUDE as f32,
        rated_current: 7.07,
        rated_omega: OMEGA_SYNC as f32,
        rated_torque: 14.6,
        frame: Frame::RotorFlux,
        field: FieldCurrent::Live,
        load: LoadKind::Friction,
        thresholds: [0.006, 0.05, 0.04, 0.003],
        window_cycles: 5,
        comparator: ComparatorConfig {
            persistence: 3,
            hysteresis: 0.8,
        },
        healthy: None,
        cage: Cage::UNKNOWN,
        doubt: Default::default(),
    }
}

fn single(params: TParams<f64>) -> TParams<f32> {
    TParams {
        r_s: params.r_s as f32,
        r_r: params.r_r as f32,
        l_ls: params.l_ls as f32,
        l_lr: params.l_lr as f32,
        l_m: params.l_m as f32,
    }
}
