//! Directions of the weighted outputs by which nothing is judged: what parameters nobody asks about may move.
//!
//! They are taken out of measurement, model and derivatives alike, by projection (Frisch and Waugh, 1933, doi:10.2307/1907330):
//! a fit has no more coordinates, and its result is as if they had been fitted too. Of a direction whose amount has a prior, only so much is
//! taken that what may be there counts as one deviation, as if noise had made it.

use crate::data::channels::N_CHANNELS;
use std::ops::Range;

/// Share of a response that must be left beside the others to be a direction of its own.
const INDEPENDENT: f64 = 1e-4;

/// Length of what has faded at an end of a response, as a share of all of it. Of a response that is 1e5 times as long as the noise of one value,
/// a hundredth of that noise is left there.
const FADED: f64 = 1e-7;

/// Directions of unit length, at right angles to each other.
#[derive(Clone, Debug, Default)]
pub struct Nuisance {
    directions: Vec<Direction>,
}

#[derive(Clone, Debug)]
struct Direction {
    strip: Strip,
    /// Share of what lies along it that is taken: all, or with a prior of deviation `d` what makes `1 + d^2` one.
    taken: f64,
}

/// Weighted rows that are zero outside a stretch, and between its values where they are those of one channel: a long recording
/// has hundreds of responses.
#[derive(Clone, Debug)]
pub struct Strip {
    first: usize,
    /// From one value to the next: a row, or 1.
    stride: usize,
    values: Vec<f64>,
}

impl Strip {
    /// All channels: `values` begin with the row value `first`.
    pub fn new(first: usize, values: Vec<f64>) -> Self {
        Strip {
            first,
            stride: 1,
            values,
        }
    }

    /// One channel, from a row on.
    pub fn of_channel(channel: usize, row: usize, values: Vec<f64>) -> Self {
        Strip {
            first: row * N_CHANNELS + channel,
            stride: N_CHANNELS,
            values,
        }
    }

    /// Square root of the sum of its squares.
    pub fn length(&self) -> f64 {
        length(&self.values)
    }

    /// Of `values`, which begin with the row value `first`, to the length of one.
    fn direction(first: usize, values: &[f64], length: f64) -> Self {
        let is_of_one_channel = values
            .iter()
            .enumerate()
            .all(|(k, x)| k % N_CHANNELS == 0 || *x == 0.0);
        let stride = if is_of_one_channel { N_CHANNELS } else { 1 };
        let values = values.iter().step_by(stride);
        Strip {
            first,
            stride,
            values: values.map(|x| x / length).collect(),
        }
    }

    /// The row values from its first to its last.
    fn range(&self) -> Range<usize> {
        match self.values.len() {
            0 => self.first..self.first,
            count => self.first..self.first + self.stride * (count - 1) + 1,
        }
    }

    fn overlaps(&self, there: &Range<usize>) -> bool {
        let mine = self.range();
        mine.start < there.end && there.start < mine.end
    }

    fn share(&self, there: &[f64]) -> f64 {
        match self.stride {
            1 => signal::dot(&self.values, there),
            stride => {
                let both = self.values.iter().zip(there.iter().step_by(stride));
                both.map(|(d, x)| d * x).sum()
            }
        }
    }

    /// Takes so much of it, a direction, from rows that begin with the row value `begin`.
    fn take_from(&self, rows: &mut [f64], begin: usize, taken: f64) {
        let mine = self.range();
        let there = &mut rows[mine.start - begin..mine.end - begin];
        let share = taken * self.share(there);
        let both = there.iter_mut().step_by(self.stride).zip(&self.values);
        both.for_each(|(x, d)| *x -= share * d);
    }
}

impl Nuisance {
    /// Takes out of weighted rows what nobody asks about.
    pub fn project_out(&self, rows: &mut [f64]) {
        let all = self.directions.iter();
        all.for_each(|d| d.strip.take_from(rows, 0, d.taken));
    }

    /// Adds what a response, or a part of it, has beside those that are there, unless that is nothing beside the `whole` response's length.
    pub fn add(&mut self, response: &Strip, whole: f64) {
        self.add_direction(response, whole, |_| 1.0);
    }

    /// The same of a response to one standard deviation of an amount that has a prior, not one whose amount may be any.
    pub fn add_expected(&mut self, response: &Strip, whole: f64) {
        self.add_direction(response, whole, |deviation| {
            1.0 - 1.0 / deviation.hypot(1.0)
        });
    }

    /// `taken`: of the length of what a response has beside the others.
    fn add_direction(&mut self, response: &Strip, whole: f64, taken: impl Fn(f64) -> f64) {
        let there = response.range();
        let overlapping = self.directions.iter().map(|d| &d.strip);
        let overlapping = overlapping.filter(|d| d.overlaps(&there));
        let ranges = overlapping.clone().map(Strip::range);
        let all = ranges.fold(there.clone(), |a, b| a.start.min(b.start)..a.end.max(b.end));
        let begin = all.start;
        let mut left = vec![0.0; all.len()];
        let mine = left[there.start - begin..].iter_mut();
        let both = mine.step_by(response.stride).zip(&response.values);
        both.for_each(|(left, x)| *left = *x);
        // Twice: rounding leaves something of the others after the first time.
        for _ in 0..2 {
            overlapping
                .clone()
                .for_each(|d| d.take_from(&mut left, begin, 1.0));
        }
        let size = length(&left);
        if size.is_finite() && size > INDEPENDENT * whole {
            let kept = unfaded(&left);
            self.directions.push(Direction {
                strip: Strip::direction(begin + kept.start, &left[kept], size),
                taken: taken(size),
            });
        }
    }
}

/// Square root of the sum of squares.
pub fn length(values: &[f64]) -> f64 {
    signal::dot(values, values).sqrt()
}

/// The values without what has faded at either end: a minute of a motor forgets in seconds how it began.
pub fn unfaded(values: &[f64]) -> Range<usize> {
    let limit = FADED * FADED * signal::dot(values, values);
    let faded = |from: &mut dyn Iterator<Item = &f64>| {
        let mut rest = 0.0;
        let small = from.take_while(|x| {
            rest += *x * *x;
            rest <= limit
        });
        small.count()
    };
    let end = values.len() - faded(&mut values.iter().rev());
    faded(&mut values.iter()).min(end)..end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::channels::SPEED;

    fn add(nuisance: &mut Nuisance, first: usize, values: &[f64]) {
        nuisance.add(&Strip::new(first, values.to_vec()), length(values));
    }

    /// Least squares with two more columns, by hand: what they explain is gone, what is at right angles to them stays.
    #[test]
    fn what_the_responses_span_is_taken_out() {
        let mut nuisance = Nuisance::default();
        add(&mut nuisance, 1, &[1.0, 1.0, 0.0]);
        add(&mut nuisance, 1, &[1.0, 0.0, 1.0]);
        // Outside the stretch, a combination of both responses, and (1, -1, -1), which neither of them holds.
        let mut rows = [7.0, 2.0 + 3.0 + 1.0, 2.0 - 1.0, 3.0 - 1.0, -4.0];
        nuisance.project_out(&mut rows);
        for (x, expected) in rows.iter().zip([7.0, 1.0, -1.0, -1.0, -4.0]) {
            assert!((x - expected).abs() < 1e-12, "{rows:?}");
        }
    }

    /// A response that the others hold already, or none at all, is no direction.
    #[test]
    fn what_is_nothing_new_adds_nothing() {
        let mut nuisance = Nuisance::default();
        add(&mut nuisance, 0, &[3.0, 4.0]);
        add(&mut nuisance, 0, &[-6.0, -8.0 + 1e-6]);
        add(&mut nuisance, 0, &[0.0, 0.0]);
        add(&mut nuisance, 0, &[f64::NAN, 1.0]);
        assert_eq!(nuisance.directions.len(), 1);
    }

    /// One channel alone takes a place a row; it is taken out as well as what all of them share.
    #[test]
    fn what_is_in_one_channel_is_kept_in_one() {
        let mut nuisance = Nuisance::default();
        let mut speed = |x: [f64; 3]| {
            nuisance.add(&Strip::of_channel(SPEED, 0, x.to_vec()), length(&x));
        };
        speed([2.0, 1.0, 0.0]);
        speed([2.0, 1.0, 5.0]);
        let all = [[1.0, 0.0, 0.0, 7.0, 1.0], [0.0; 5], [0.0; 5]].concat();
        add(&mut nuisance, 0, &all);
        let places = nuisance.directions.iter().map(|d| d.strip.values.len());
        assert_eq!(places.collect::<Vec<_>>(), [2, 1, 9]);
        // Once each of the three, and what is at right angles to all of them.
        let left = [[-6.0, 0.0, 0.0, 1.0, -1.0], [0.0, 0.0, 0.0, -2.0, 0.0]].concat();
        let mut rows = [[-5.0, 0.0, 0.0, 10.0, 0.0], [0.0, 0.0, 0.0, -1.0, 0.0]].concat();
        rows.extend([0.0, 0.0, 0.0, 4.0, 0.0]);
        nuisance.project_out(&mut rows);
        for (x, expected) in rows.iter().zip(left.iter().chain(&[0.0; 5])) {
            assert!((x - expected).abs() < 1e-12, "{rows:?}");
        }
    }

    /// A response that ends sooner is at right angles to longer ones all the same.
    #[test]
    fn responses_of_other_lengths_are_taken_out_together() {
        let mut nuisance = Nuisance::default();
        add(&mut nuisance, 0, &[1.0, 1.0, 1.0]);
        add(&mut nuisance, 0, &[1.0, 2.0]);
        let mut rows = [3.0 + 5.0, 3.0 + 10.0, 3.0, 9.0];
        nuisance.project_out(&mut rows);
        for (x, expected) in rows.iter().zip([0.0, 0.0, 0.0, 9.0]) {
            assert!((x - expected).abs() < 1e-12, "{rows:?}");
        }
    }

    /// What has faded is not kept; what has not, is, and so is what never fades.
    #[test]
    fn a_response_ends_where_it_has_faded() {
        let fading = (0..1000).map(|k| 0.9_f64.powi(k));
        let late: Vec<f64> = [0.0; 7].into_iter().chain(fading).collect();
        // The length of what is left from k on is 0.9^k of the whole.
        let expected = (FADED.ln() / 0.9_f64.ln()).ceil() as usize;
        assert_eq!(unfaded(&late), 7..7 + expected);
        assert_eq!(unfaded(&[1.0, 0.0, 1.0]), 0..3);
        assert_eq!(unfaded(&[1.0, f64::NAN]), 0..2);
        assert_eq!(unfaded(&[0.0, 0.0]).len(), 0);
        assert_eq!(unfaded(&[]), 0..0);
    }

    /// With a prior: the covariance of the noise and of the amount, `I + d d'`, becomes `I`.
    #[test]
    fn what_is_expected_counts_as_noise() {
        let mut nuisance = Nuisance::default();
        let d = [3.0, 4.0];
        nuisance.add_expected(&Strip::new(0, d.to_vec()), 5.0);
        let mut whitened = [[1.0, 0.0], [0.0, 1.0]];
        for column in &mut whitened {
            nuisance.project_out(column);
        }
        let covariance = |i: usize, j: usize| f64::from(i == j) + d[i] * d[j];
        for i in 0..2 {
            for j in 0..2 {
                let terms = (0..4)
                    .map(|k| whitened[i][k / 2] * covariance(k / 2, k % 2) * whitened[j][k % 2]);
                assert!((terms.sum::<f64>() - f64::from(i == j)).abs() < 1e-12);
            }
        }
    }

    /// Stretches know nothing of each other.
    #[test]
    fn stretches_are_apart() {
        let mut nuisance = Nuisance::default();
        add(&mut nuisance, 0, &[1.0, 1.0]);
        add(&mut nuisance, 2, &[1.0, 1.0]);
        let mut rows = [1.0, 3.0, 10.0, 20.0];
        nuisance.project_out(&mut rows);
        assert_eq!(rows.map(f64::round), [-1.0, 1.0, -5.0, 5.0]);
    }
}
