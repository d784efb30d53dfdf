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
