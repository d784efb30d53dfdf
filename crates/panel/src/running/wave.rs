//! The latest supply period as it is, in phases and in the monitor's d-q frame.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use monitor::Report;
use num_complex::Complex64;
use serde::Serialize;

use crate::source::Instant;

/// Points of a period that are shown.
const POINTS: usize = 120;
/// Samples that are kept: one period at 5 Hz and 10 kHz.
const MOST_SAMPLES: usize = 2_000;

/// One supply period.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WaveMessage {
    /// Time since the beginning of the period, ms.
    pub t_ms: Vec<f64>,
    /// Phase voltages a, b, c, V.
    pub u_abc_volt: [Vec<f64>; 3],
    /// Phase currents a, b, c, A.
    pub i_abc_amp: [Vec<f64>; 3],
    /// Voltage along d and q, V; empty without an operating point.
    pub u_dq_volt: [Vec<f64>; 2],
    /// Current along d and q, A; empty without an operating point.
    pub i_dq_amp: [Vec<f64>; 2],
}

/// The latest samples.
#[derive(Clone, Debug, Default)]
pub struct Wave {
    samples: VecDeque<Instant>,
}

impl Wave {
    /// Keeps a sample.
    pub fn sample(&mut self, instant: &Instant) {
        if self.samples.len() >= MOST_SAMPLES {
            self.samples.pop_front();
        }
        self.samples.push_back(*instant);
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// The period that ended with the newest sample; `None` while there is no frequency or not yet a whole period.
    pub fn period(&self, report: &Report) -> Option<WaveMessage> {
        let omega = f64::from(report.window?.omega_sync);
        let last = self.samples.back()?.t_s;
        let first = self
            .samples
            .partition_point(|instant| instant.t_s < last - TAU / omega);
        if first == 0 {
            return None;
        }
        let period: Vec<&Instant> = self.samples.range(first..).collect();
        let stride = period.len().div_ceil(POINTS);
        let shown: Vec<&Instant> = period.iter().step_by(stride).copied().collect();
        let mut message = WaveMessage::of(&shown);
        if let Some(point) = report.point {
            let angle = f64::from(point.u_s_dq.q).atan2(f64::from(point.u_s_dq.d));
            message.turn(&shown, omega, phase(&period, omega) - angle);
        }
        Some(message)
    }
}

/// Angle of the voltage vector at the beginning of a period, rad.
fn phase(period: &[&Instant], omega: f64) -> f64 {
    let begin = period[0].t_s;
    let turned = |instant: &&Instant| {
        vector(instant.u_volt) * Complex64::from_polar(1.0, -omega * (instant.t_s - begin))
    };
    period.iter().map(turned).sum::<Complex64>().arg()
}

fn vector(abc: [f32; 3]) -> Complex64 {
    motor::dynamic::clarke(abc.map(f64::from))
}

impl WaveMessage {
    fn of(shown: &[&Instant]) -> WaveMessage {
        let begin = shown[0].t_s;
        let mut message = WaveMessage::default();
        for instant in shown {
            message.t_ms.push(1e3 * (instant.t_s - begin));
            for k in 0..3 {
                message.u_abc_volt[k].push(rounded(f64::from(instant.u_volt[k])));
                message.i_abc_amp[k].push(rounded(f64::from(instant.i_amp[k])));
            }
        }
        message
    }

    /// Adds d and q for a d axis that lies at `theta` at the beginning and turns with the supply.
    fn turn(&mut self, shown: &[&Instant], omega: f64, theta: f64) {
        let begin = shown[0].t_s;
        for instant in shown {
            let back = Complex64::from_polar(1.0, -theta - omega * (instant.t_s - begin));
            let (u, i) = (vector(instant.u_volt) * back, vector(instant.i_amp) * back);
            for (column, x) in self.u_dq_volt.iter_mut().zip([u.re, u.im]) {
                column.push(rounded(x));
            }
            for (column, x) in self.i_dq_amp.iter_mut().zip([i.re, i.im]) {
                column.push(rounded(x));
            }
        }
    }
}

/// Four digits behind the point: finer than any converter, shorter on the way.
fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

#[cfg(test)]
mod tests {
    use super::*;
    use monitor::{Dq, OperatingPoint, Window};
    use motor::TParams;

    #[test]
    fn a_clean_supply_stands_still_in_its_frame() {
        let omega = TAU * 50.0;
        let mut wave = Wave::default();
        for k in 0..1000 {
            let t_s = f64::from(k) * 1e-4;
            let along = |amplitude: f64, lag: f64| {
                let vector = Complex64::from_polar(amplitude, omega * t_s - lag);
                motor::dynamic::phases(vector).map(|x| x as f32)
            };
            wave.sample(&Instant {
                t_s,
                u_volt: along(100.0, 0.0),
                i_amp: along(2.0, 0.5),
                omega_mech: 0.0,
            });
        }
        let window = Window {
            omega_sync: omega as f32,
            ..Window::default()
        };
        let report = Report {
            window: Some(window),
            point: Some(point(omega as f32)),
            ..Report::default()
        };
        let message = wave.period(&report).expect("a whole period");
        assert_eq!(message.t_ms.len(), 100);
        // d = 60, q = 80 at every instant; f32 samples and four digits.
        assert!(message.u_dq_volt[0].iter().all(|d| (d - 60.0).abs() < 0.01));
        assert!(message.u_dq_volt[1].iter().all(|q| (q - 80.0).abs() < 0.01));
        let expected = Complex64::from_polar(2.0, (80.0_f64).atan2(60.0) - 0.5);
        assert!((message.i_dq_amp[0][7] - expected.re).abs() < 1e-3);
    }

    fn point(omega_sync: f32) -> OperatingPoint {
        OperatingPoint {
            u_s_dq: Dq { d: 60.0, q: 80.0 },
            i_s_dq: Dq { d: 1.0, q: 1.0 },
            u_amplitude: 100.0,
            psi_r: 0.3,
            params: TParams {
                r_s: 1.0,
                r_r: 1.0,
                l_ls: 0.01,
                l_lr: 0.01,
                l_m: 0.2,
            },
            tau_extra: 0.0,
            omega_sync,
            omega_el: 300.0,
        }
    }
}
