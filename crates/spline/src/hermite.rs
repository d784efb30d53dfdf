//! Cubic polynomials between points at equal distances whose slopes are known (Hermite).

/// Values and slopes of a function at equal distances from zero on.
///
/// Between two points it is off by `h^4/384` of its fourth derivative at most.
#[derive(Clone, Debug)]
pub struct Hermite {
    points: Vec<[f64; 2]>,
    per_unit: f64,
}

impl Hermite {
    /// Of `count` points, two or more, `distance` apart, above zero; `point` gives value and slope at each, from zero on.
    pub fn of(count: usize, distance: f64, mut point: impl FnMut(f64) -> [f64; 2]) -> Self {
        let mut one = |k: usize| {
            let [value, slope] = point(distance * k as f64);
            [value, slope * distance]
        };
        Self {
            points: (0..count).map(&mut one).collect(),
            per_unit: 1.0 / distance,
        }
    }

    /// Value at `x`, zero or more; `None` beyond the last point.
    #[inline]
    pub fn at(&self, x: f64) -> Option<f64> {
        let place = x * self.per_unit;
        let k = place as usize;
        let &[[y0, d0], [y1, d1]] = self.points.get(k..k.saturating_add(2))? else {
            return None;
        };
        let (t, rise) = (place - k as f64, y1 - y0);
        Some(y0 + t * (d0 + t * ((3.0 * rise - 2.0 * d0 - d1) + t * (d0 + d1 - 2.0 * rise))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is met everywhere, a sine within `h^4/384`; beyond the end there is nothing.
    #[test]
    fn a_cubic_is_exact_and_a_sine_is_off_by_the_fourth_derivative() {
        let cubic = |x: f64| 1.0 + x * (2.0 - x * (0.5 - 0.1 * x));
        let of_cubic = Hermite::of(5, 0.5, |x| [cubic(x), 2.0 - x * (1.0 - 0.3 * x)]);
        let of_sine = Hermite::of(101, 0.1, |x| [x.sin(), x.cos()]);
        for k in 0..200 {
            let x = 0.0099 * f64::from(k);
            let error = of_cubic.at(x).map_or(f64::NAN, |y| (y - cubic(x)).abs());
            assert!(error < 1e-14, "{x}: {error:e}");
            let error = of_sine
                .at(5.0 * x)
                .map_or(f64::NAN, |y| (y - (5.0 * x).sin()).abs());
            assert!(error <= 0.1f64.powi(4) / 384.0 + 1e-15, "{x}: {error:e}");
        }
        assert!(of_cubic.at(2.1).is_none() && of_cubic.at(f64::INFINITY).is_none());
    }
}
