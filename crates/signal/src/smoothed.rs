//! What a smoothed series tells at each of its samples.

use crate::dot::dot;
use crate::sample::Sample;

/// Weights of a window that give the value and the slope (per point) of a quadratic at one place.
#[derive(Clone, Debug)]
pub struct Weights {
    pub(crate) value: Vec<f64>,
    pub(crate) slope: Vec<f64>,
}

/// What is asked of a smoothed series: its values alone, or its slopes too.
pub trait Smoothed: Copy {
    /// Samples of the series.
    type Of: Sample;

    /// Of a sample that is left as it is.
    fn raw(x: Self::Of) -> Self;

    /// Of the points of a window.
    fn of(weights: &Weights, window: &[Self::Of]) -> Self;

    /// On the way to `other`, at a share of it.
    fn towards(self, other: Self, share: f64) -> Self;

    /// Of a series whose points are means of `length` samples each.
    fn of_means(self, length: f64) -> Self;
}

impl<T: Sample> Smoothed for T {
    type Of = T;

    fn raw(x: T) -> T {
        x
    }

    fn of(weights: &Weights, window: &[T]) -> T {
        dot(&weights.value, window)
    }

    fn towards(self, other: T, share: f64) -> T {
        self + (other - self) * share
    }

    fn of_means(self, _length: f64) -> T {
        self
    }
}

/// Value and slope of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// Smoothed value.
    pub value: f64,
    /// Its slope per sample.
    pub slope: f64,
}

impl Smoothed for Line {
    type Of = f64;

    fn raw(value: f64) -> Line {
        Line { value, slope: 0.0 }
    }

    fn of(weights: &Weights, window: &[f64]) -> Line {
        Line {
            value: dot(&weights.value, window),
            slope: dot(&weights.slope, window),
        }
    }

    fn towards(self, other: Line, share: f64) -> Line {
        Line {
            value: self.value.towards(other.value, share),
            slope: self.slope.towards(other.slope, share),
        }
    }

    fn of_means(self, length: f64) -> Line {
        Line {
            slope: self.slope / length,
            ..self
        }
    }
}
