//! A 2.2 kW motor in steady state, solved in double precision by the crate `motor`, as sensors show it.

use std::f64::consts::TAU;

use motor::TParams;
use motor::steady_state::{OperatingPoint, SteadyState};
use num_complex::Complex64;

use super::motor_2200_watt::FRICTION;
pub use super::motor_2200_watt::{AMPLITUDE, OMEGA_SYNC, PARAMS, config};
use crate::{Abc, Monitor, MonitorConfig, MonitorState, Report, Sample, SpeedSample};

pub const T_SAMPLE: f64 = 1e-4;

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
