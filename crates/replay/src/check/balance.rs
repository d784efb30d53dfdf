//! A negative sequence of the currents that the voltages do not explain, over a recording of a motor that was not calibrated: in
//! good order it stands still, whatever load and supply do.

use monitor::{MonitorConfig, Report, magnitude, unexplained_current};
use num_complex::Complex32;

use crate::timeline::Thinned;

/// Largest change in good order, share of the rated current: a tenth of the turns of a phase shorted moved a measured motor by 0.06 to
/// 0.09, its healthy windows stay within 0.02.
pub(crate) const LARGEST_CHANGE: f32 = 0.04;

/// Windows that were judged, in the order of time.
#[derive(Default)]
pub(crate) struct Balance {
    windows: Thinned<(f64, Complex32)>,
}

/// When it changed, s, and how far it was from most windows, share of the rated current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Jump {
    pub t: f64,
    pub share: f32,
}

impl Balance {
    /// Adds a window that ended at `t`, s.
    pub fn add(&mut self, t: f64, report: &Report, config: &MonitorConfig) {
        let Some(window) = report.window.filter(|_| report.is_judged()) else {
            return;
        };
        if let Some(current) = unexplained_current(config, &window) {
            // A window tells of its middle, not of its end.
            let middle = t - 0.5 * f64::from(window.span);
            self.windows.push((middle, current / config.rated_current));
        }
    }

    /// The first of the windows that stray, where they are more than single disturbances.
    pub fn jump(&self) -> Option<Jump> {
        jump(&self.windows)
    }
}

/// The same of any windows.
pub(crate) fn jump(windows: &[(f64, Complex32)]) -> Option<Jump> {
    let middle = middle(windows.iter().map(|(_, x)| *x));
    let apart = windows.iter().map(|(t, x)| Jump {
        t: *t,
        share: magnitude(x - middle),
    });
    let strays: Vec<Jump> = apart.filter(|jump| jump.share > LARGEST_CHANGE).collect();
    let first = strays.first().copied();
    let found = first.filter(|_| strays.len() > strays_allowed(windows.len()))?;
    Some(Jump {
        t: largest_step(windows).unwrap_or(found.t),
        ..found
    })
}

/// Windows on either side of a step.
const BESIDE: usize = 5;

/// When the windows after differ most from those before, s: also where most windows are those after it.
fn largest_step(windows: &[(f64, Complex32)]) -> Option<f64> {
    let mean = |part: &[(f64, Complex32)]| {
        let sum: Complex32 = part.iter().map(|(_, x)| *x).sum();
        sum / part.len() as f32
    };
    let steps = windows.windows(2 * BESIDE).map(|both| {
        let (before, after) = both.split_at(BESIDE);
        (after[0].0, magnitude(mean(after) - mean(before)))
    });
    steps
        .max_by(|(_, a), (_, b)| a.total_cmp(b))
        .map(|(t, _)| t)
}

/// Share of windows that may stray: single disturbances. A few never count: lamps want three in a row.
const STRAY_SHARE: f64 = 0.01;
const FEW_STRAYS: usize = 2;

/// How many of so many windows may stray.
pub(crate) fn strays_allowed(windows: usize) -> usize {
    ((STRAY_SHARE * windows as f64) as usize).max(FEW_STRAYS)
}

/// Median of the real and of the imaginary parts.
pub(crate) fn middle(values: impl Iterator<Item = Complex32> + Clone) -> Complex32 {
    let median = |part: fn(&Complex32) -> f32| {
        let mut sorted: Vec<f32> = values.clone().map(|x| part(&x)).collect();
        sorted.sort_by(f32::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or_default()
    };
    Complex32::new(median(|x| x.re), median(|x| x.im))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn windows(after: f32, count: usize) -> Vec<(f64, Complex32)> {
        let of = |k: usize| {
            let changed = if k >= 100 - count { after } else { 0.0 };
            (0.02 * k as f64, Complex32::new(0.01 + changed, 0.02))
        };
        (0..100).map(of).collect()
    }

    #[test]
    fn a_change_that_stays_is_told_with_its_time_and_single_disturbances_are_not() {
        let found = jump(&windows(0.07, 30)).expect("a jump");
        assert!((found.share - 0.07).abs() < 1e-6); // f32
        assert!((found.t - 1.4).abs() < 1e-9);
        let mostly = jump(&windows(0.07, 70)).expect("a jump");
        assert!((mostly.t - 0.6).abs() < 1e-9, "{}", mostly.t);
        assert_eq!(jump(&windows(0.07, 2)), None);
        assert_eq!(jump(&windows(0.02, 30)), None);
        assert_eq!(jump(&[]), None);
    }
}
