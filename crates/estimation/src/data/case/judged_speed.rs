//! The measured speed by which a model is judged.

use audit::refreshed_at;
use recording::{Channel, Recording};
use signal::sigma;
use std::ops::Range;

/// A measured speed as a model is judged by it: once for each value. A counter of pulses or a bus shows the same one for several rows,
/// which in a start the motor has left behind long before the next one.
pub(super) struct JudgedSpeed<'a> {
    shown: &'a [f64],
    /// Samples with a new value; `None` where each is one.
    refreshed: Option<Vec<usize>>,
    weight: f64,
}

impl<'a> JudgedSpeed<'a> {
    /// `shown`: the speed channel, rad/s.
    pub fn new(rec: &Recording, shown: &'a [f64]) -> Self {
        let refreshed = refreshed_at(shown);
        let sigma = match &refreshed {
            None => sigma(rec, Channel::SPEED, shown),
            Some(at) => {
                let values: Vec<f64> = at.iter().map(|&k| shown[k]).collect();
                sigma(rec, Channel::SPEED, &values)
            }
        };
        Self {
            shown,
            refreshed,
            weight: sigma.recip(),
        }
    }

    /// Samples for which a value is shown; zero where each sample has a new one.
    pub fn held_for(&self) -> f64 {
        let at = self.refreshed.as_deref().unwrap_or_default();
        match at {
            [first, .., last] => (last - first) as f64 / (at.len() - 1) as f64,
            _ => 0.0,
        }
    }

    /// The value and its weight in a row of these samples; nothing is judged in one without a new value.
    pub fn in_row(&self, samples: Range<usize>) -> (f64, f64) {
        let before = |at: &[usize], k: usize| at.partition_point(|&refresh| refresh < k);
        let is_new = |at: &Vec<usize>| before(at, samples.start) < before(at, samples.end);
        let weight = match self.refreshed.as_ref().is_none_or(is_new) {
            true => self.weight,
            false => 0.0,
        };
        (self.shown[samples.end - 1], weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;

    fn judged(speed: &[f64], rows: &[Range<usize>]) -> Vec<bool> {
        let rec = specimen::changed(&specimen::recording(1.0, |_| 1.0), |channel, x| {
            Some(if channel == Channel::SPEED {
                speed.to_vec()
            } else {
                x
            })
        });
        let judged = JudgedSpeed::new(&rec, speed);
        rows.iter()
            .map(|row| judged.in_row(row.clone()).1 > 0.0)
            .collect()
    }

    /// A start whose speed a counter shows every 20 samples, one refresh without a change included; rows of two samples.
    #[test]
    fn a_speed_that_is_held_is_judged_once_for_each_value() {
        let n = specimen::recording(1.0, |_| 1.0).len();
        let counted: Vec<f64> = (0..n).map(|k| ((k / 20) as f64).powi(2).min(1e4)).collect();
        let rows: Vec<Range<usize>> = (0..200).map(|k| 2 * k + 9..2 * k + 11).collect();
        let got = judged(&counted, &rows);
        for (row, is_judged) in rows.iter().zip(got) {
            assert_eq!(
                is_judged,
                row.clone().any(|k| k % 20 == 0 && k > 0),
                "{row:?}"
            );
        }
    }

    #[test]
    fn a_speed_that_goes_on_is_judged_in_every_row() {
        let n = specimen::recording(1.0, |_| 1.0).len();
        let smooth: Vec<f64> = (0..n).map(|k| (k as f64 * 1e-3).sin()).collect();
        assert!(judged(&smooth, &[0..2, 2..4, 40..42]).iter().all(|is| *is));
    }
}
