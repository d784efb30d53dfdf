//! Directions of the weighted outputs by which nothing is judged: what parameters nobody asks about may move.
//!
//! They are taken out of measurement, model and derivatives alike, by projection (Frisch and Waugh, 1933, doi:10.2307/1907330):
//! a fit has no more coordinates, and its result is as if they had been fitted too.

use std::ops::Range;

/// Share of a response that must be left beside the others to be a direction of its own.
const INDEPENDENT: f64 = 1e-4;

/// Length of what has faded at an end of a response, as a share of all of it: of fluxes wrong by their rated size, which may be 1e5 times the
/// noise in a recording, a hundredth of the noise is left there.
const FADED: f64 = 1e-7;

/// Directions of unit length, at right angles to each other.
#[derive(Clone, Debug, Default)]
pub struct Nuisance {
    directions: Vec<Direction>,
}

/// A direction; zero outside its stretch. In single precision, which leaves as little of what is taken out as [`FADED`] does: a
/// long recording has hundreds of them.
#[derive(Clone, Debug)]
struct Direction {
    first: usize,
    values: Vec<f32>,
}

impl Direction {
    fn end(&self) -> usize {
        self.first + self.values.len()
    }

    fn overlaps(&self, there: &Range<usize>) -> bool {
        self.first < there.end && there.start < self.end()
    }

    /// In eight sums, so that it vectorises.
    fn share(&self, there: &[f64]) -> f64 {
        let mut sums = [0.0; 8];
        for (d, x) in self.values.chunks(8).zip(there.chunks(8)) {
            let both = sums.iter_mut().zip(d).zip(x);
            both.for_each(|((sum, d), x)| *sum += f64::from(*d) * x);
        }
        sums.iter().sum()
    }

    /// Of rows that begin with the row value `begin`.
    fn take_from(&self, rows: &mut [f64], begin: usize) {
        let there = &mut rows[self.first - begin..][..self.values.len()];
        let share = self.share(there);
        let both = there.iter_mut().zip(&self.values);
        both.for_each(|(x, d)| *x -= share * f64::from(*d));
    }
}

impl Nuisance {
    /// Takes out of weighted rows what nobody asks about.
    pub fn project_out(&self, rows: &mut [f64]) {
        self.directions.iter().for_each(|d| d.take_from(rows, 0));
    }

    /// Adds what a response has beside those that are there, unless that is nothing. It is zero but for `values`, which begin with the row
    /// value `first`.
    pub fn add(&mut self, first: usize, values: &[f64]) {
        let before = length(values);
        let there = first..first + values.len();
        let overlapping = self.directions.iter().filter(|d| d.overlaps(&there));
        let begin = overlapping.clone().map(|d| d.first).fold(first, usize::min);
        let end = overlapping.clone().map(Direction::end);
        let mut left = vec![0.0; end.fold(there.end, usize::max) - begin];
        left[first - begin..][..values.len()].copy_from_slice(values);
        // Twice: rounding leaves something of the others after the first time.
        for _ in 0..2 {
            overlapping
                .clone()
                .for_each(|d| d.take_from(&mut left, begin));
        }
        let size = length(&left);
        if size.is_finite() && size > INDEPENDENT * before {
            let kept = unfaded(&left);
            self.directions.push(Direction {
                first: begin + kept.start,
                values: left[kept].iter().map(|x| (x / size) as f32).collect(),
            });
        }
    }
}

fn length(values: &[f64]) -> f64 {
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

    /// Rounding of directions to single precision, times values below ten.
    const SINGLE: f64 = 1e-6;

    /// Least squares with two more columns, by hand: what they explain is gone, what is at right angles to them stays.
    #[test]
    fn what_the_responses_span_is_taken_out() {
        let mut nuisance = Nuisance::default();
        nuisance.add(1, &[1.0, 1.0, 0.0]);
        nuisance.add(1, &[1.0, 0.0, 1.0]);
        // Outside the stretch, a combination of both responses, and (1, -1, -1), which neither of them holds.
        let mut rows = [7.0, 2.0 + 3.0 + 1.0, 2.0 - 1.0, 3.0 - 1.0, -4.0];
        nuisance.project_out(&mut rows);
        for (x, expected) in rows.iter().zip([7.0, 1.0, -1.0, -1.0, -4.0]) {
            assert!((x - expected).abs() < SINGLE, "{rows:?}");
        }
    }

    /// A response that the others hold already, or none at all, is no direction.
    #[test]
    fn what_is_nothing_new_adds_nothing() {
        let mut nuisance = Nuisance::default();
        nuisance.add(0, &[3.0, 4.0]);
        nuisance.add(0, &[-6.0, -8.0 + 1e-6]);
        nuisance.add(0, &[0.0, 0.0]);
        nuisance.add(0, &[f64::NAN, 1.0]);
        assert_eq!(nuisance.directions.len(), 1);
    }

    /// A response that ends sooner is at right angles to longer ones all the same.
    #[test]
    fn responses_of_other_lengths_are_taken_out_together() {
        let mut nuisance = Nuisance::default();
        nuisance.add(0, &[1.0, 1.0, 1.0]);
        nuisance.add(0, &[1.0, 2.0]);
        let mut rows = [3.0 + 5.0, 3.0 + 10.0, 3.0, 9.0];
        nuisance.project_out(&mut rows);
        for (x, expected) in rows.iter().zip([0.0, 0.0, 0.0, 9.0]) {
            assert!((x - expected).abs() < SINGLE, "{rows:?}");
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

    /// Stretches know nothing of each other.
    #[test]
    fn stretches_are_apart() {
        let mut nuisance = Nuisance::default();
        nuisance.add(0, &[1.0, 1.0]);
        nuisance.add(2, &[1.0, 1.0]);
        let mut rows = [1.0, 3.0, 10.0, 20.0];
        nuisance.project_out(&mut rows);
        assert_eq!(rows.map(f64::round), [-1.0, 1.0, -5.0, 5.0]);
    }
}
