//! Derivatives of the weighted outputs, as differences between two simulations.
//!
//! What the integration errs by is nearly the same in both: their difference is off by a share of itself, while a
//! residual would be off by a share of the signal. So differences are integrated in longer steps than residuals.

use crate::data::case::{Case, Waveform};
use crate::model::prediction::{SpeedObserver, coarse_outputs};
use crate::model::prior::{Hypothesis, Prior};
use rayon::prelude::*;
use std::borrow::Cow;

/// Longest step, as an angle of the supply, rad. A straight line between its ends is off by an eighth of its square, 0.3 %.
const LONGEST_TURN: f64 = 0.16;
/// Longest step, s: the seventh harmonic of 50 Hz still shows, and what decays in a millisecond.
const LONGEST_STEP: f64 = 0.401e-3;
/// Share of the outputs by which long steps may move them: beyond it, something happens within a step.
const FAITHFUL: f64 = 0.05;

/// Differences of the weighted outputs from those of one hypothesis.
pub struct Differences<'a> {
    case: &'a Case,
    prior: &'a Prior,
    observer: SpeedObserver,
    /// Integration steps that are taken at once.
    at_once: usize,
    base: Cow<'a, [f64]>,
}

impl<'a> Differences<'a> {
    /// From a hypothesis with these outputs, in steps as long as the supply allows.
    pub fn from(
        case: &'a Case,
        prior: &'a Prior,
        h: &Hypothesis,
        outputs: &'a [f64],
        observer: SpeedObserver,
    ) -> Self {
        let as_it_is = Self {
            case,
            prior,
            observer,
            at_once: 1,
            base: Cow::Borrowed(outputs),
        };
        match case.waveform().map_or(1, steps_at_once) {
            1 => as_it_is,
            at_once => as_it_is.coarser(h, at_once),
        }
    }

    /// The same in longer steps, where these show the same.
    fn coarser(self, h: &Hypothesis, at_once: usize) -> Self {
        let coarse = Self { at_once, ..self };
        let base = coarse.outputs(h);
        let square = |(a, b): (&f64, &f64)| (a - b) * (a - b);
        let moved: f64 = base.iter().zip(coarse.base.iter()).map(square).sum();
        let all = signal::dot(&coarse.base, &coarse.base);
        match moved < FAITHFUL * FAITHFUL * all {
            true => Self {
                base: Cow::Owned(base),
                ..coarse
            },
            false => Self {
                at_once: 1,
                ..coarse
            },
        }
    }

    fn outputs(&self, h: &Hypothesis) -> Vec<f64> {
        coarse_outputs(self.case, self.prior, h, self.observer, self.at_once)
    }

    /// What the outputs of another hypothesis differ by, over a step of a coordinate.
    pub fn of(&self, h: &Hypothesis, step: f64) -> Vec<f64> {
        let mut there = self.outputs(h);
        let base = self.base.iter();
        there
            .iter_mut()
            .zip(base)
            .for_each(|(x, b)| *x = (*x - b) / step);
        there
    }
}

/// Integration steps that make the longest one of a difference.
fn steps_at_once(waveform: &Waveform) -> usize {
    let omega = waveform.timeline.omega_sync.iter();
    let fastest = omega.fold(0.0f64, |a, b| a.max(b.abs()));
    let longest = LONGEST_STEP.min(LONGEST_TURN / fastest.max(f64::MIN_POSITIVE));
    ((longest / waveform.t_step()) as usize).max(1)
}

/// Derivatives of the weighted outputs with respect to the free coordinates, in their order; `base`: the outputs there.
pub fn jacobian(
    case: &Case,
    prior: &Prior,
    h: &Hypothesis,
    base: &[f64],
    observer: SpeedObserver,
) -> Vec<Vec<f64>> {
    let free: Vec<usize> = (0..h.z.len()).filter(|&k| h.free[k]).collect();
    columns(&Differences::from(case, prior, h, base, observer), h, &free)
}

/// Those with respect to some coordinates; `differences`: from `h`.
pub fn columns(
    differences: &Differences<'_>,
    h: &Hypothesis,
    coordinates: &[usize],
) -> Vec<Vec<f64>> {
    let column = |&k: &usize| {
        let mut step = h.step(k);
        if h.z[k] + step > h.bounds(k, differences.prior)[1] {
            step = -step;
        }
        let mut moved = h.clone();
        moved.z[k] += step;
        differences.of(&moved, step)
    };
    coordinates.par_iter().map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::prediction::outputs;
    use crate::specimen;

    /// Central differences, which err by the square of the step.
    #[test]
    fn derivatives_are_those_of_the_outputs() {
        let study = specimen::table_study(|_| ());
        let (case, prior) = (&study.fitted.case, &study.prior);
        let h = study.at_prior();
        let base = outputs(case, prior, &h, SpeedObserver::Off);
        let free: Vec<usize> = (0..h.z.len()).filter(|&k| h.free[k]).collect();
        let columns = jacobian(case, prior, &h, &base, SpeedObserver::Off);
        assert_eq!(columns.len(), free.len());
        for (column, k) in columns.iter().zip(free) {
            let at = |dz: f64| {
                let mut moved = h.clone();
                moved.z[k] += dz;
                outputs(case, prior, &moved, SpeedObserver::Off)
            };
            let (up, down) = (at(1e-3), at(-1e-3));
            let size = column.iter().fold(0.0f64, |a, b| a.max(b.abs()));
            for (n, got) in column.iter().enumerate() {
                let expected = (up[n] - down[n]) / 2e-3;
                assert!(
                    (got - expected).abs() < 5e-3 * size,
                    "{k}: {got} {expected}"
                );
            }
        }
    }

    /// At the upper bound the derivative is taken downwards.
    #[test]
    fn derivatives_stay_inside_the_bounds() {
        let study = specimen::table_study(|_| ());
        let (case, prior) = (&study.fitted.case, &study.prior);
        let mut h = study.at_prior();
        h.z[0] = h.bounds(0, prior)[1];
        let base = outputs(case, prior, &h, SpeedObserver::Off);
        let column = &jacobian(case, prior, &h, &base, SpeedObserver::Off)[0];
        let mut moved = h.clone();
        moved.z[0] -= h.step(0);
        let there = outputs(case, prior, &moved, SpeedObserver::Off);
        for ((got, b), t) in column.iter().zip(&base).zip(&there) {
            assert!((got - (b - t) / h.step(0)).abs() < 1e-6 * (1.0 + got.abs()));
        }
    }

    /// Long steps against central differences of short ones. A step of 0.3 rad: its straight line is off by an eighth of its
    /// square, 1.1 %; leakage, whose difference is a quarter of a cycle apart, by twice that.
    #[test]
    fn long_steps_show_the_same_differences() {
        let study = specimen::study(1.0, |t| if t < 0.5 { 0.4 } else { 1.0 });
        let (case, prior) = (&study.fitted.case, &study.prior);
        let h = study.at_prior();
        let base = outputs(case, prior, &h, SpeedObserver::Off);
        let short = Differences::from(case, prior, &h, &base, SpeedObserver::Off);
        assert_eq!(short.at_once, 1);
        let long = short.coarser(&h, 2);
        assert_eq!(long.at_once, 2);
        for k in (0..h.z.len()).filter(|&k| h.free[k]) {
            let moved = |dz: f64| {
                let mut moved = h.clone();
                moved.z[k] += dz;
                moved
            };
            let at = |dz: f64| outputs(case, prior, &moved(dz), SpeedObserver::Off);
            let step = h.step(k);
            let (up, down) = (at(step), at(-step));
            let both = up.iter().zip(&down);
            let expected: Vec<f64> = both.map(|(a, b)| (a - b) / (2.0 * step)).collect();
            let got = long.of(&moved(step), step);
            let missed = got.iter().zip(&expected).map(|(a, b)| (a - b) * (a - b));
            let share = (missed.sum::<f64>() / signal::dot(&expected, &expected)).sqrt();
            assert!(share < 0.03, "{k}: {share}");
        }
        // Ten steps of 0.3 rad leave nothing of a cycle: it is seen that they show something else.
        assert_eq!(long.coarser(&h, 10).at_once, 1);
    }

    #[test]
    fn a_step_is_as_long_as_the_supply_allows() {
        let mut study = specimen::study(1.0, |_| 1.0);
        let waveform = specimen::waveform_mut_of(&mut study);
        // 60 Hz: 0.15 rad in 0.4 ms.
        waveform.inputs.t_sample = 1e-4;
        assert_eq!(steps_at_once(waveform), 2);
        waveform.inputs.t_sample = 5e-5;
        assert_eq!(steps_at_once(waveform), 4);
        let mut timeline = (*waveform.timeline).clone();
        timeline
            .omega_sync
            .iter_mut()
            .for_each(|omega| *omega *= 3.0);
        waveform.timeline = timeline.into();
        assert_eq!(steps_at_once(waveform), 1);
    }
}
