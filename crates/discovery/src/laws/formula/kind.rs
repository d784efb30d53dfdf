//! What a shape parameter is: where it is looked for, how it is fitted, in which unit it is told.

use std::f64::consts::TAU;

/// Points of a grid over widths and over phases.
const WIDTHS: usize = 16;
const PHASES: usize = 32;
/// Least and largest width, in largest |x|.
const WIDTH: [f64; 2] = [0.02, 3.0];
/// Exponents that are tried.
const EXPONENTS: [f64; 13] = [
    0.3, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 6.0, 9.0,
];
/// Places that are tried: so many steps over the range.
const PLACES: usize = 20;
/// Harmonics that are tried.
const HARMONICS: usize = 8;

/// Kind of a shape parameter. Its coordinate is what a fit moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// A number; coordinate: its logarithm.
    Exponent,
    /// A length along x; coordinate: the logarithm of its ratio to the largest |x|.
    Width,
    /// A point of x; coordinate: 0 at the low end of the range, 1 at the high one.
    Place,
    /// An angle, rad; coordinate: itself.
    Phase,
    /// A whole number; tried, never fitted.
    Harmonic,
}

/// What a curve reaches over, and the largest |x| as formulas write it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    /// Lowest and highest x.
    pub range: [f64; 2],
    /// Largest |x|, rounded to three digits.
    pub largest: f64,
}

impl Reach {
    pub fn of(range: [f64; 2]) -> Self {
        let largest = range[0].abs().max(range[1].abs());
        let digit = 10f64.powf(largest.max(f64::MIN_POSITIVE).log10().floor() - 2.0);
        // Divided by a whole power of ten: 0.157 and not 0.15700000000000003.
        let written = match digit < 1.0 {
            true => (largest / digit).round() / (1.0 / digit).round(),
            false => (largest / digit).round() * digit.round(),
        };
        Self {
            range,
            largest: written,
        }
    }

    fn length(&self) -> f64 {
        self.range[1] - self.range[0]
    }
}

impl Kind {
    /// Words for files.
    pub const WORDS: [(&'static str, Kind); 5] = [
        ("exponent", Kind::Exponent),
        ("width", Kind::Width),
        ("place", Kind::Place),
        ("phase", Kind::Phase),
        ("harmonic", Kind::Harmonic),
    ];

    /// Coordinates that are tried.
    pub fn grid(self) -> Vec<f64> {
        let steps = |n: usize| (0..n).map(move |k| k as f64 / n as f64);
        match self {
            Kind::Exponent => EXPONENTS.map(f64::ln).to_vec(),
            Kind::Width => {
                let [low, high] = WIDTH.map(f64::ln);
                steps(WIDTHS)
                    .map(|share| low + share * (high - low))
                    .collect()
            }
            Kind::Place => steps(PLACES).collect(),
            Kind::Phase => steps(PHASES).map(|share| TAU * share).collect(),
            Kind::Harmonic => (1..=HARMONICS).map(|n| n as f64).collect(),
        }
    }

    /// First step from a point of the grid; zero: never moved.
    pub fn step(self) -> f64 {
        match self {
            Kind::Exponent | Kind::Width => 0.15,
            Kind::Place => 0.025,
            Kind::Phase => 0.1,
            Kind::Harmonic => 0.0,
        }
    }

    /// Lowest and highest coordinate.
    pub fn bounds(self) -> [f64; 2] {
        match self {
            Kind::Exponent => [0.1f64.ln(), 12f64.ln()],
            Kind::Width => [0.004f64.ln(), 20f64.ln()],
            Kind::Place => [-0.2, 1.0],
            Kind::Phase => [-TAU, 2.0 * TAU],
            Kind::Harmonic => [1.0, HARMONICS as f64],
        }
    }

    /// Value that a formula has for a coordinate.
    pub fn value(self, coordinate: f64, reach: &Reach) -> f64 {
        match self {
            Kind::Exponent => coordinate.exp(),
            Kind::Width => reach.largest * coordinate.exp(),
            Kind::Place => reach.range[0] + coordinate * reach.length(),
            Kind::Phase | Kind::Harmonic => coordinate,
        }
    }

    /// Change of the value with the coordinate.
    pub fn slope(self, coordinate: f64, reach: &Reach) -> f64 {
        match self {
            Kind::Exponent | Kind::Width => self.value(coordinate, reach),
            Kind::Place => reach.length(),
            Kind::Phase => 1.0,
            Kind::Harmonic => 0.0,
        }
    }

    /// Unit of the value over a coordinate with the unit `x`.
    pub fn unit(self, x: &'static str) -> &'static str {
        match self {
            Kind::Exponent | Kind::Harmonic => "-",
            Kind::Width | Kind::Place => x,
            Kind::Phase => "rad",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_coordinate_is_written_with_three_digits() {
        for (x, written) in [
            (157.08, "157"),
            (0.98765, "0.988"),
            (1234.0, "1230"),
            (3.2e-4, "0.00032"),
        ] {
            assert_eq!(Reach::of([-0.1 * x, x]).largest.to_string(), written);
        }
    }

    #[test]
    fn slopes_are_those_of_the_values_and_grids_lie_inside_their_bounds() {
        let reach = Reach::of([-20.0, 130.0]);
        for (word, kind) in Kind::WORDS {
            let [low, high] = kind.bounds();
            for z in kind.grid() {
                assert!(z >= low && z <= high, "{word} {z}");
                let secant = (kind.value(z + 1e-6, &reach) - kind.value(z - 1e-6, &reach)) / 2e-6;
                let fitted = kind != Kind::Harmonic;
                let error = (kind.slope(z, &reach) - secant).abs();
                assert!(!fitted || error < 1e-5 * secant.abs(), "{word} {z}");
            }
        }
    }
}
