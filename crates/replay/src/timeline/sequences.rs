//! Sequence components over a recording.

use monitor::Report;
use num_complex::Complex64;
use schemars::JsonSchema;
use serde::Serialize;

use super::thinned::MOST;

/// Sequence components over the recording. Angles refer to phase a.
///
/// The windows are averaged as complex ratios under a Hann weight over the recording, so that what was
/// cut off at its beginning and end counts little; `largest` looks at single windows instead. Of many windows neighbours have
/// one weight: against the length of the recording they are close.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct SequenceSummary {
    /// Negative over positive sequence of the currents.
    pub i2_over_i1: Option<f64>,
    /// Angle of that ratio, degrees.
    pub i2_over_i1_angle_deg: Option<f64>,
    /// Negative over positive sequence of the voltages.
    pub v2_over_v1: Option<f64>,
    /// Zero over positive sequence of the currents.
    pub i0_over_i1: Option<f64>,
    /// Largest negative over positive sequence of the currents in a single window.
    pub largest_i2_over_i1: Option<f64>,
}

/// Ratios of the sequence components of the complete windows.
#[derive(Clone, Debug, Default)]
pub(super) struct Sequences {
    /// Negative and zero over positive sequence of the currents.
    current: Averages<2>,
    /// Negative over positive sequence of the voltages.
    voltage: Averages<1>,
    largest: Option<f64>,
}

/// Complex values over time; neighbours are averaged where they are many.
#[derive(Clone, Debug)]
struct Averages<const N: usize> {
    groups: Vec<Group<N>>,
    /// Values of a whole group.
    size: f64,
}

/// The mean of neighbouring values, at the mean of their times, s.
#[derive(Clone, Copy, Debug)]
struct Group<const N: usize> {
    t: f64,
    values: [Complex64; N],
    count: f64,
}

impl<const N: usize> Default for Averages<N> {
    fn default() -> Self {
        Averages {
            groups: Vec::new(),
            size: 1.0,
        }
    }
}

impl<const N: usize> Group<N> {
    fn joined(&self, other: &Group<N>) -> Group<N> {
        let count = self.count + other.count;
        let share = other.count / count;
        let mut values = self.values;
        for (x, y) in values.iter_mut().zip(other.values) {
            *x += (y - *x) * share;
        }
        Group {
            t: self.t + (other.t - self.t) * share,
            values,
            count,
        }
    }
}

impl<const N: usize> Averages<N> {
    fn add(&mut self, t: f64, values: [Complex64; N]) {
        let one = Group {
            t,
            values,
            count: 1.0,
        };
        match self.groups.last_mut() {
            Some(last) if last.count < self.size => *last = last.joined(&one),
            _ => self.groups.push(one),
        }
        if self.groups.len() > MOST {
            let pairs = self.groups.chunks(2);
            let joined = pairs.map(|pair| match pair {
                [first, second] => first.joined(second),
                _ => pair[0],
            });
            self.groups = joined.collect();
            self.size *= 2.0;
        }
    }

    /// Mean over time under a Hann weight that spans the values; `None` without any.
    fn mean(&self, k: usize) -> Option<Complex64> {
        let (first, last) = (self.groups.first()?.t, self.groups.last()?.t);
        // Half a step beyond either end, so that a single value has a weight.
        let span = (last - first).max(f64::MIN_POSITIVE) * 1.001;
        let hann = |t: f64| 1.0 - (std::f64::consts::TAU * ((t - first) / span + 0.0005)).cos();
        let groups = self.groups.iter();
        let (sum, weights) = groups.fold((Complex64::ZERO, 0.0), |(sum, weights), group| {
            let weight = hann(group.t) * group.count;
            (sum + group.values[k] * weight, weights + weight)
        });
        Some(sum / weights)
    }
}

impl Sequences {
    /// `t` is the time of the window's end; what it measured belongs to its middle.
    pub fn add(&mut self, t: f64, report: &Report) {
        let Some(window) = &report.window else {
            return;
        };
        let half_cycle = std::f64::consts::PI / f64::from(window.omega_sync);
        let t = t - 0.5 * f64::from(window.span) - half_cycle;
        let wide = |x: num_complex::Complex32| Complex64::new(f64::from(x.re), f64::from(x.im));
        if window.i_s.positive.norm_sqr() > 0.0 {
            let negative = wide(window.i_s.unbalance());
            self.current
                .add(t, [negative, wide(window.i_s.zero_ratio())]);
            let sizes = self.largest.into_iter().chain([negative.norm()]);
            self.largest = sizes.max_by(f64::total_cmp);
        }
        if window.u_s.positive.norm_sqr() > 0.0 {
            self.voltage.add(t, [wide(window.u_s.unbalance())]);
        }
    }

    pub fn summary(&self) -> SequenceSummary {
        let i2 = self.current.mean(0);
        SequenceSummary {
            i2_over_i1: i2.map(Complex64::norm),
            i2_over_i1_angle_deg: i2.map(|x| x.arg().to_degrees()),
            v2_over_v1: self.voltage.mean(0).map(Complex64::norm),
            i0_over_i1: self.current.mean(1).map(Complex64::norm),
            largest_i2_over_i1: self.largest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: under `1 - cos x` the mean of `cos x` over a turn is -1/2, and that of a constant itself; the weight goes on
    /// for a two-thousandth of the turn at either end.
    #[test]
    fn many_values_have_the_mean_of_a_hann_weight() {
        let mut all = Averages::<1>::default();
        let n = 200_000;
        for k in 0..n {
            let x = f64::from(k) / f64::from(n);
            let wave = (std::f64::consts::TAU * x).cos();
            all.add(x, [Complex64::new(0.3 + wave, 1.0)]);
        }
        assert!(all.groups.len() <= MOST);
        let mean = all.mean(0).expect("values");
        assert!(
            (mean - Complex64::new(0.3 - 0.5, 1.0)).norm() < 1e-3,
            "{mean}"
        );
    }
}
