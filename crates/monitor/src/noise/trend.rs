//! A straight line through what the cycles of a window show: how fast it changes, and how far it is from straight.

use num_complex::Complex32;

/// A line through values at equal distances, the newest first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trend {
    /// Change from one value to the next newer one.
    pub slope: Complex32,
    /// Largest distance of a value from the line.
    pub bend: f32,
}

/// Standard deviation of a window's rate of change over that of a single cycle's value, in 1/s, for `length` cycles of
/// which the first and the last lie `span` seconds apart.
pub fn rate_noise(length: usize, span: f32) -> f32 {
    let n = length as f32;
    (n - 1.0) / span * processor::sqrtf(12.0 / (n * (n * n - 1.0)))
}

/// Standard deviation of the rate of a frequency over that of a single cycle's angle, in 1/s2: the line through the
/// differences of `length` angles, of which the first and the last lie `span` seconds apart.
pub fn frequency_rate_noise(length: usize, span: f32) -> f32 {
    let differences = length as f32 - 1.0;
    if differences < 2.0 {
        return 0.0;
    }
    let square = differences * differences;
    let per_second = differences / span;
    processor::sqrtf(72.0 / (square * (square - 1.0))) * per_second * per_second
}

impl Trend {
    /// Through `length` values, at least 2: least squares.
    pub fn of(values: impl Iterator<Item = Complex32> + Clone, length: usize) -> Self {
        let n = length as f32;
        let place = |k: usize| 0.5 * (n - 1.0) - k as f32;
        let (mut mean, mut moment) = (Complex32::ZERO, Complex32::ZERO);
        for (k, y) in values.clone().enumerate() {
            mean += y / n;
            moment += y * place(k);
        }
        let slope = moment * (12.0 / (n * (n * n - 1.0)));
        let off = |(k, y): (usize, Complex32)| (y - mean - slope * place(k)).norm_sqr();
        let farthest = values.enumerate().map(off).fold(0.0, f32::max);
        Trend {
            slope,
            bend: processor::sqrtf(farthest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_slope_and_no_bend() {
        let step = Complex32::new(0.5, -2.0);
        for length in 2..10_usize {
            // Newest first.
            let values = (0..length).map(|k| Complex32::new(3.0, 1.0) - step * k as f32);
            let trend = Trend::of(values, length);
            assert!((trend.slope - step).norm() < 1e-5, "{length}: {trend:?}");
            assert!(trend.bend < 1e-5);
        }
    }

    /// Least squares through 0, 0, 1, 1, 1: slope 0.3, the second and third value 0.4 off.
    #[test]
    fn a_step_bends() {
        let values = [1.0, 1.0, 1.0, 0.0, 0.0].map(|x| Complex32::new(x, 0.0));
        let trend = Trend::of(values.into_iter(), 5);
        assert!((trend.slope.re - 0.3).abs() < 1e-6, "{trend:?}");
        assert!((trend.bend - 0.4).abs() < 1e-6, "{trend:?}");
    }

    /// Five angles: differences weighed -3, -1, 1, 3 tenths are angles weighed 3, -2, -2, -2, 3 tenths: root of 0.3.
    #[test]
    fn the_rate_of_a_frequency_is_as_uncertain_as_its_line() {
        let expected = processor::sqrtf(0.3) / (0.02 * 0.02);
        assert!((frequency_rate_noise(5, 0.08) / expected - 1.0).abs() < 1e-6);
        assert_eq!(frequency_rate_noise(2, 0.02), 0.0);
    }

    /// The textbook's `sigma/(T sqrt(sum x^2))` for five values 20 ms apart.
    #[test]
    fn a_rate_is_as_uncertain_as_its_line() {
        let expected = 1.0 / (0.02 * processor::sqrtf(10.0));
        assert!((rate_noise(5, 0.08) / expected - 1.0).abs() < 1e-6);
    }
}
