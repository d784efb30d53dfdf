//! A 2.2 kW motor in steady state, solved in double precision by the crate `motor`, as sensors show it.

use std::f64::consts::TAU;

use motor::steady_state::{OperatingPoint, SteadyState};
use motor::{Mechanics, TParams};
use num_complex::Complex64;

use crate::{
    Abc, ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind, Monitor, MonitorConfig,
    MonitorState, Report, Sample, SpeedSample,
};

pub const T_SAMPLE: f64 = 1e-4;
pub const OMEGA_SYNC: f64 = TAU * 50.0;
pub const AMPLITUDE: f64 = 326.6;
const FRICTION: f64 = 0.065;

pub const PARAMS: TParams<f64> = TParams {
    r_s: 3.7,
    r_r: 2.3,
    l_ls: 0.0107,
    l_lr: 0.0107,
    l_m: 0.234,
};

pub fn config() -> MonitorConfig {
    MonitorConfig {
        t_sample: T_SAMPLE as f32,
        converter: Converter::bipolar(600.0, 60.0, 12),
        encoder_counts_per_revolution: 4096.0,
        params: TParams {
            r_s: 3.7,
            r_r: 2.3,
            l_ls: 0.0107,
            l_lr: 0.0107,
            l_m: 0.234,
        },
        effects: Default::default(),
        channel_gain: [1.0; 6],
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
    }
}

/// Steady state at the declared friction.
pub fn point_of(params: &TParams<f64>) -> OperatingPoint<f64> {
    let supply = Complex64::new(AMPLITUDE, 0.0);
    SteadyState::new(params, 2.0, supply, OMEGA_SYNC).at_friction(FRICTION)
}

pub fn phases(positive: Complex64) -> [Complex64; 3] {
    [0.0, -TAU / 3.0, TAU / 3.0].map(|shift| positive * Complex64::from_polar(1.0, shift))
}

/// Phasors of the channels and speed of the shaft.
#[derive(Clone, Copy)]
pub struct Drive {
    pub u: [Complex64; 3],
    pub i: [Complex64; 3],
    pub omega_mech: f64,
}

impl Drive {
    pub fn healthy() -> Self {
        Drive::with(&PARAMS)
    }

    pub fn with(params: &TParams<f64>) -> Self {
        let point = point_of(params);
        Drive {
            u: phases(point.u_s),
            i: phases(point.i_s),
            omega_mech: point.omega_mech,
        }
    }

    /// What the channels show at `t`, s.
    pub fn sample(&self, t: f64) -> Sample {
        let turn = Complex64::from_polar(1.0, OMEGA_SYNC * t);
        let now = |x: [Complex64; 3]| Some(Abc::from_array(x.map(|x| (x * turn).re as f32)));
        Sample {
            u_s_abc: now(self.u),
            i_s_abc: now(self.i),
            speed: SpeedSample::RadPerSecond(self.omega_mech as f32),
            ..Sample::default()
        }
    }
}

/// A monitor at work.
pub struct Bench {
    pub monitor: Monitor,
    pub state: MonitorState,
    taken: u64,
}

impl Bench {
    pub fn new(config: MonitorConfig) -> Self {
        Bench {
            monitor: Monitor::new(config).expect("a valid motor"),
            state: MonitorState::default(),
            taken: 0,
        }
    }

    /// Goes on for some seconds; `sample` is told the time since the start, s.
    pub fn run(&mut self, seconds: f64, sample: impl Fn(f64) -> Sample) -> Vec<Report> {
        let last = self.taken + (seconds / T_SAMPLE).round() as u64;
        let mut reports = Vec::new();
        while self.taken < last {
            let sample = sample(self.taken as f64 * T_SAMPLE);
            reports.extend(self.monitor.update(&mut self.state, &sample));
            self.taken += 1;
        }
        reports
    }
}

/// The last report of a second.
pub fn last(config: MonitorConfig, sample: impl Fn(f64) -> Sample) -> Report {
    *Bench::new(config)
        .run(1.0, sample)
        .last()
        .expect("a report")
}
