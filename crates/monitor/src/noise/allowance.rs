//! What is followed of the noise of cycles, and what it can do to a window.

use crate::isolation::ROWS;
use crate::model::residuals::RESIDUALS;
use crate::noise::scatter::ScatterState;

/// r1..r4, the rows of evidence, the rotor flux, V s, and the speed, rad/s.
pub(crate) const FOLLOWED: usize = RESIDUALS + ROWS + 2;
pub(crate) const FLUX: usize = RESIDUALS + ROWS;
pub(crate) const SPEED: usize = FLUX + 1;

/// What the noise of the cycles is known to be.
pub type CycleScatter = ScatterState<FOLLOWED>;

/// What noise can do to one window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Allowance {
    /// Of r1..r4, shares of their scales.
    pub residuals: [f32; RESIDUALS],
    /// Standard deviations of the rows of evidence.
    pub rows: [f32; ROWS],
}
