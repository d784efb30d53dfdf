//! What the windows measured, kept for figures over time.

use super::thinned::Thinned;
use monitor::{Report, Window};
use schemars::JsonSchema;
use serde::Serialize;

/// The residuals of one window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct WindowResiduals {
    /// End of the window, s.
    pub t: f64,
    /// r1..r4, percent of their scales.
    pub r_percent: [f64; 4],
    /// Whether thresholds were applied to them.
    pub judged: bool,
}

/// What the machine did in one window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct WindowOperation {
    /// End of the window, s.
    pub t: f64,
    /// Positive sequence of the phase voltages, V rms; absent without voltages.
    pub voltage_rms_volt: Option<f64>,
    /// Positive sequence of the phase currents, A rms; absent without currents.
    pub current_rms_amp: Option<f64>,
    /// Supply frequency, Hz.
    pub frequency_hz: f64,
    /// Mechanical speed, rad/s; absent without a speed.
    pub speed_rad_s: Option<f64>,
    /// Brake torque, N m; absent without a torque channel.
    pub torque_nm: Option<f64>,
    /// Negative over positive sequence of the currents.
    pub i2_over_i1: Option<f64>,
    /// Negative over positive sequence of the voltages.
    pub v2_over_v1: Option<f64>,
}

/// The windows in the order of time, thinned out where they are many.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Wherever residuals could be evaluated.
    pub residuals: Thinned<WindowResiduals>,
    /// Wherever a window was complete.
    pub operation: Thinned<WindowOperation>,
}

impl Trace {
    /// Adds one report; `t` is the time of the window's end, s.
    pub fn add(&mut self, t: f64, report: &Report) {
        if let Some(residuals) = WindowResiduals::of(t, report) {
            self.residuals.push(residuals);
        }
        if let Some(operation) = WindowOperation::of(t, report) {
            self.operation.push(operation);
        }
    }
}

impl Trace {
    /// One of how many windows is kept at least.
    pub fn every(&self) -> u64 {
        self.residuals.every().max(self.operation.every())
    }
}

impl WindowResiduals {
    /// Of one report, where residuals could be evaluated; `t` is the time of the window's end, s.
    pub fn of(t: f64, report: &Report) -> Option<Self> {
        let residuals = report.residuals?;
        Some(WindowResiduals {
            t,
            r_percent: residuals.r.map(|r| 100.0 * f64::from(r)),
            judged: report.is_judged(),
        })
    }
}

impl WindowOperation {
    /// Of one report, where the window was complete; `t` is the time of the window's end, s.
    pub fn of(t: f64, report: &Report) -> Option<Self> {
        let window = report.window.as_ref()?;
        Some(WindowOperation::new(t, window))
    }

    fn new(t: f64, window: &Window) -> Self {
        let present = |amplitude: f32| (amplitude > 0.0).then_some(f64::from(amplitude));
        let voltage = present(window.u_s.positive.norm());
        let current = present(window.i_s.positive.norm());
        WindowOperation {
            t,
            voltage_rms_volt: voltage.map(|peak| peak * std::f64::consts::FRAC_1_SQRT_2),
            current_rms_amp: current.map(|peak| peak * std::f64::consts::FRAC_1_SQRT_2),
            frequency_hz: f64::from(window.omega_sync) / std::f64::consts::TAU,
            speed_rad_s: window.shaft_speed().map(f64::from),
            torque_nm: window.shaft_torque().map(f64::from),
            i2_over_i1: current.map(|_| f64::from(window.i_s.unbalance().norm())),
            v2_over_v1: voltage.map(|_| f64::from(window.u_s.unbalance().norm())),
        }
    }
}
