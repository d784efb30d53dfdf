//! Directions of the weighted outputs by which nothing is judged: what parameters nobody asks about may move.
//!
//! They are taken out of measurement, model and derivatives alike, by projection (Frisch and Waugh, 1933, doi:10.2307/1907330):
//! a fit has no more coordinates, and its result is as if they had been fitted too.

/// Share of a response that must be left beside the others to be a direction of its own.
const INDEPENDENT: f64 = 1e-4;

/// Directions of unit length, at right angles to each other.
#[derive(Clone, Debug, Default)]
pub struct Nuisance {
    directions: Vec<Direction>,
}

/// A direction; zero outside its stretch.
#[derive(Clone, Debug)]
struct Direction {
    first: usize,
    values: Vec<f64>,
}

impl Direction {
    fn share(&self, rows: &[f64]) -> f64 {
        signal::dot(&self.values, &rows[self.first..][..self.values.len()])
    }

    fn take_from(&self, rows: &mut [f64]) {
        let share = self.share(rows);
        let there = rows[self.first..].iter_mut().zip(&self.values);
        there.for_each(|(x, d)| *x -= share * d);
    }
}

impl Nuisance {
    /// Takes out of weighted rows what nobody asks about.
    pub fn project_out(&self, rows: &mut [f64]) {
        self.directions.iter().for_each(|d| d.take_from(rows));
    }

    /// Adds what a response has beside those that are there, unless that is nothing. It begins with the row value `first`;
    /// responses that overlap begin together.
    pub fn add(&mut self, first: usize, mut values: Vec<f64>) {
        let length = |x: &[f64]| signal::dot(x, x).sqrt();
        let before = length(&values);
        // Twice: rounding leaves something of the others after the first time.
        for _ in 0..2 {
            for d in self.directions.iter().filter(|d| d.first == first) {
                let share = signal::dot(&d.values, &values);
                values
                    .iter_mut()
                    .zip(&d.values)
                    .for_each(|(x, d)| *x -= share * d);
            }
        }
        let left = length(&values);
        if left.is_finite() && left > INDEPENDENT * before {
            values.iter_mut().for_each(|x| *x /= left);
            self.directions.push(Direction { first, values });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least squares with two more columns, by hand: what they explain is gone, what is at right angles to them stays.
    #[test]
    fn what_the_responses_span_is_taken_out() {
        let mut nuisance = Nuisance::default();
        nuisance.add(1, vec![1.0, 1.0, 0.0]);
        nuisance.add(1, vec![1.0, 0.0, 1.0]);
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
        nuisance.add(0, vec![3.0, 4.0]);
        nuisance.add(0, vec![-6.0, -8.0 + 1e-6]);
        nuisance.add(0, vec![0.0, 0.0]);
        nuisance.add(0, vec![f64::NAN, 1.0]);
        assert_eq!(nuisance.directions.len(), 1);
    }

    /// Stretches know nothing of each other.
    #[test]
    fn stretches_are_apart() {
        let mut nuisance = Nuisance::default();
        nuisance.add(0, vec![1.0, 1.0]);
        nuisance.add(2, vec![1.0, 1.0]);
        let mut rows = [1.0, 3.0, 10.0, 20.0];
        nuisance.project_out(&mut rows);
        assert_eq!(rows.map(f64::round), [-1.0, 1.0, -5.0, 5.0]);
    }
}
