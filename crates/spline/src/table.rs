//! A curve as a dense table, for inner loops.

use core::f64::consts::TAU;

/// Points of a dense table.
pub const TABLE_POINTS: usize = 513;

/// A curve at equal distances, written into a slice: begin, points per unit, values.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a>(&'a [f64]);

/// Writes the table of `value` between `low` and `high`; `per_unit` of the coordinate is one on the table's axis.
pub fn tabulated([low, high]: [f64; 2], per_unit: f64, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let last = (TABLE_POINTS - 1) as f64;
    let at = |k: usize| value(low + (high - low) * k as f64 / last);
    let mut table = vec![low / per_unit, last * per_unit / (high - low)];
    table.extend((0..TABLE_POINTS).map(at));
    table
}

/// Writes the table of values at equal distances `step` from zero on; at least two.
pub fn traced(step: f64, values: &[f64]) -> Vec<f64> {
    [&[0.0, 1.0 / step], values].concat()
}

impl<'a> Table<'a> {
    /// Reads what [`tabulated`] or [`traced`] wrote.
    pub fn of(written: &'a [f64]) -> Self {
        Self(written)
    }

    /// Number of the last point.
    #[inline]
    fn last(&self) -> usize {
        self.0.len() - 3
    }

    /// Index and fraction of the interval at the place `u`, points.
    #[inline]
    fn interval(&self, u: f64) -> (usize, f64) {
        let last = self.last() as f64;
        // A number that left the finite ones counts as the beginning: the simulation itself says what is wrong.
        let u = if u.is_finite() {
            u.clamp(0.0, last)
        } else {
            0.0
        };
        let k = (u as usize).min(self.last() - 1);
        (k, u - k as f64)
    }

    #[inline]
    fn between(&self, (k, share): (usize, f64)) -> f64 {
        let (a, b) = (self.0[k + 2], self.0[k + 3]);
        a + share * (b - a)
    }

    /// Value at `x`; beyond the ends it stays.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        self.between(self.interval((x - self.0[0]) * self.0[1]))
    }

    /// Value at the angle `x`, rad, of any turn.
    #[inline]
    pub fn at_angle(&self, x: f64) -> f64 {
        let turn = x / TAU;
        self.at(TAU * (turn - turn.floor()))
    }

    /// Value and slope at `x`.
    #[inline]
    pub fn with_slope(&self, x: f64) -> (f64, f64) {
        let u = (x - self.0[0]) * self.0[1];
        let (k, share) = self.interval(u);
        let inside = u >= 0.0 && u <= self.last() as f64;
        let slope = (self.0[k + 3] - self.0[k + 2]) * self.0[1];
        (self.between((k, share)), if inside { slope } else { 0.0 })
    }

    /// Mean of all values: what a curve over an angle does in steady state.
    pub fn mean(&self) -> f64 {
        let values = &self.0[2..self.last() + 2];
        values.iter().sum::<f64>() / values.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_gives_the_curve_and_its_slope_and_stays_beyond_its_ends() {
        let written = tabulated([-10.0, 150.0], 1.0, |x| 0.01 * x * x);
        let table = Table::of(&written);
        // Linear interpolation errs by h^2/8 times the second derivative.
        let bound = (160.0f64 / 512.0).powi(2) / 8.0 * 0.02;
        for x in [-10.0, -3.3, 0.0, 77.7, 149.9] {
            assert!((table.at(x) - 0.01 * x * x).abs() <= 1.001 * bound, "{x}");
            assert!((table.with_slope(x).1 - 0.02 * x).abs() < 0.02 * 160.0 / 512.0);
        }
        assert_eq!(table.at(900.0), 225.0);
        assert_eq!(table.with_slope(900.0), (225.0, 0.0));
        assert_eq!(table.at(f64::NAN), table.at(-10.0));
    }

    #[test]
    fn a_trace_is_its_values_with_lines_between_them() {
        let written = traced(0.5, &[1.0, 3.0, -1.0]);
        let table = Table::of(&written);
        let at = [-1.0, 0.0, 0.25, 0.5, 0.75, 1.0, 9.0].map(|x| table.at(x));
        assert_eq!(at, [1.0, 1.0, 2.0, 3.0, 1.0, -1.0, -1.0]);
    }

    #[test]
    fn an_angle_repeats_and_has_a_mean() {
        let written = tabulated([0.0, TAU], 1.0, |x| 2.0 + x.sin());
        let table = Table::of(&written);
        assert!((table.at_angle(7.0 * TAU + 1.0) - table.at_angle(1.0)).abs() < 1e-9);
        assert!((table.at_angle(-1.0) - (2.0 - 1f64.sin())).abs() < 1e-4);
        assert!((table.mean() - 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_table_over_another_unit_reads_in_that_unit() {
        let written = tabulated([0.2, 1.2], 0.5, |x| 3.0 * x);
        assert!((Table::of(&written).at(1.4) - 2.1).abs() < 1e-12);
    }
}
