//! One fit of plate, prior and test points.

mod descent;
mod point_rows;
mod prior;

pub(super) use descent::{Posterior, inverse};
pub(super) use point_rows::PointRows;
pub(super) use prior::Prior;

use super::plate_term::PlateTerm;
use super::point::Point;
use super::unknowns::Unknowns;
use crate::plate::Completed;

/// Everything that is known: the posterior follows.
pub(super) struct Problem<'p> {
    pub completed: &'p Completed,
    pub term: &'p PlateTerm,
    pub prior: &'p Prior,
    pub points: &'p [Point],
    /// Factor on the variance of each point, and of each value of the plate: 1 where nothing contradicts it.
    pub doubts: &'p Doubts,
    pub bounds: &'p [Unknowns; 2],
}

/// Factors on variances.
#[derive(Clone, Debug)]
pub(super) struct Doubts {
    pub points: Vec<f64>,
    pub values: [f64; crate::plate::VALUES],
}
