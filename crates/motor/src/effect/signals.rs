//! Whole signals on their way into and out of the simulated motor, where sensors go wrong.

use num_complex::Complex64;

/// What drives a simulation: what was measured, corrected to what was there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// Sampling time, s.
    pub t_sample: f64,
    /// Stator voltage vector, V.
    pub u_s: Vec<Complex64>,
    /// Load torque, N m.
    pub tau_load: Vec<f64>,
}

/// What the instruments would show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Time of the first sample, s.
    pub t_start: f64,
    /// Time between these samples, s.
    pub t_sample: f64,
    /// Phase currents, A.
    pub i_s_abc: Vec<[f64; 3]>,
    /// Mechanical speed, rad/s.
    pub omega_mech: Vec<f64>,
    /// Shaft angle, rad, not wrapped.
    pub theta_mech: Vec<f64>,
    /// Zero sequence that the voltage channels show, V.
    pub u_zero: Vec<f64>,
    /// Believed phase voltages behind `u_zero`, V: what the voltage channels show.
    pub u_measured: Vec<Complex64>,
}

/// Catmull-Rom interpolation of `x` at the fractional index `at`; held beyond both ends.
pub(crate) fn interpolate(x: &[f64], at: f64) -> f64 {
    let last = x.len() as i64 - 1;
    let k = (at.floor() as i64).clamp(0, last);
    let get = |j: i64| x[(k + j).clamp(0, last) as usize];
    let s = (at - k as f64).clamp(0.0, 1.0);
    let (a, b, c, d) = (get(-1), get(0), get(1), get(2));
    let slope = c - a;
    let bend = 2.0 * a - 5.0 * b + 4.0 * c - d;
    let twist = 3.0 * (b - c) + d - a;
    b + 0.5 * s * (slope + s * (bend + s * twist))
}

/// The signal delayed by `samples` (may be negative or fractional).
pub(crate) fn delayed(x: &[f64], samples: f64) -> Vec<f64> {
    (0..x.len())
        .map(|k| interpolate(x, k as f64 - samples))
        .collect()
}

/// The mean of the signal over the last `samples` (may be fractional), which was constant before it began.
///
/// The signal is taken as straight lines between samples.
pub(crate) fn averaged(x: &[f64], samples: f64) -> Vec<f64> {
    let Some(&first) = x.first().filter(|_| samples > 0.0) else {
        return x.to_vec();
    };
    let lines = x.windows(2).scan(0.0, |sum, pair| {
        *sum += 0.5 * (pair[0] + pair[1]);
        Some(*sum)
    });
    let integral: Vec<f64> = std::iter::once(0.0).chain(lines).collect();
    let until = |at: f64| {
        if at <= 0.0 {
            return first * at;
        }
        let (k, part) = (at as usize, at.fract());
        let slope = x.get(k + 1).map_or(0.0, |next| next - x[k]);
        integral[k] + part * (x[k] + 0.5 * part * slope)
    };
    let mean = |k: usize| (integral[k] - until(k as f64 - samples)) / samples;
    (0..x.len()).map(mean).collect()
}

/// The signal behind a first-order low-pass of time constant `tau` (s), started in equilibrium.
///
/// The input is taken as straight lines between samples, for which the recursion is exact. A negative `tau`
/// is the linear continuation `2 x - filtered(-tau)`, so that a fit can cross zero.
pub(crate) fn low_passed(x: &[f64], tau: f64, t_sample: f64) -> Vec<f64> {
    let Some(&first) = x.first() else {
        return Vec::new();
    };
    let tau_abs = tau.abs().max(1e-9 * t_sample);
    let decay = (-t_sample / tau_abs).exp();
    let ramp = tau_abs / t_sample * (1.0 - decay);
    let mut y = first;
    let mut out = Vec::with_capacity(x.len());
    out.push(y);
    for pair in x.windows(2) {
        y = decay * y + (ramp - decay) * pair[0] + (1.0 - ramp) * pair[1];
        out.push(y);
    }
    if tau < 0.0 {
        out.iter_mut().zip(x).for_each(|(y, x)| *y = 2.0 * x - *y);
    }
    out
}

impl Outputs {
    /// Applies `f` to the signal of each phase current.
    pub(crate) fn each_current(&mut self, f: impl Fn(usize, &[f64]) -> Vec<f64>) {
        for phase in 0..3 {
            let channel: Vec<f64> = self.i_s_abc.iter().map(|i| i[phase]).collect();
            for (i, x) in self.i_s_abc.iter_mut().zip(f(phase, &channel)) {
                i[phase] = x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_2_PI, TAU};

    /// Half a turn of a sinusoid: its amplitude falls to `sin(pi/2) / (pi/2)`, and it is late by a quarter of a turn.
    #[test]
    fn a_mean_over_half_a_turn_is_late_and_flat() {
        let turn = 400.0;
        let at = |k: f64| 150.0 + (TAU * k / turn).sin();
        let x: Vec<f64> = (0..2000).map(|k| at(f64::from(k))).collect();
        let shown = averaged(&x, 0.5 * turn);
        for k in 400..2000 {
            let late = at(f64::from(k) - 0.25 * turn) - 150.0;
            // Straight lines between samples of a 400th of a turn cut (TAU/400)^2/12 of the amplitude off.
            let error = shown[k as usize] - 150.0 - FRAC_2_PI * late;
            assert!(error.abs() < 3e-5, "{k}: {error}");
        }
    }

    /// A ramp is only late, by any fraction of a sample; before it began it was constant.
    #[test]
    fn a_mean_of_a_ramp_is_a_late_ramp() {
        let x: Vec<f64> = (0..50).map(|k| 3.0 + f64::from(k)).collect();
        for samples in [1e-3, 0.4, 1.0, 2.7, 9.3] {
            let shown = averaged(&x, samples);
            assert!((shown[0] - 3.0).abs() < 1e-12);
            for k in 10..50 {
                let expected = x[k] - 0.5 * samples;
                assert!(
                    (shown[k] - expected).abs() < 1e-9,
                    "{samples}, {k}: {}",
                    shown[k]
                );
            }
        }
        assert_eq!(averaged(&x, 0.0), x);
    }
}
