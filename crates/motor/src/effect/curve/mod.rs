//! A law as a curve: where it acts in the equations, over which quantity, and its values at knots.
//!
//! ```toml
//! [[effects]]
//! name = "curve"
//! place = "torque"            # what the curve is added to or multiplied with
//! coordinate = "speed"        # what it depends on
//! knots_rad_s = [0.0, 40.0, 80.0, 120.0, 157.0]
//! values_nm = [0.0, 0.0, 0.2, 1.1, 2.6]
//! ```
//!
//! Between the knots the curve is a cubic spline; beyond the last knot it stays. Over an angle it repeats every
//! turn. [`Place`] and [`Coordinate`] list what there is, with units and keys.

mod action;
mod coordinate;
#[cfg(feature = "file")]
mod entry;
#[cfg(feature = "file")]
mod hooks;
#[cfg(feature = "file")]
mod law;
mod place;
mod steady;
#[cfg(all(test, feature = "file"))]
mod tests;

pub use action::Action;
pub use coordinate::Coordinate;
#[cfg(feature = "file")]
pub(crate) use entry::{from_entry, to_entry};
#[cfg(feature = "file")]
pub use hooks::Law;
#[cfg(feature = "file")]
pub use law::{FEWEST_KNOTS, MOST_KNOTS, MOST_KNOTS_OF_A_TURN, curve, knots_and_values};
pub use place::{Place, Quantity};
#[cfg(feature = "file")]
pub use spline::{TABLE_POINTS, Table, tabulated, traced};
pub use steady::{BOARD_KNOTS, SteadyCurve};

/// Name of the effect in motor files.
pub const NAME: &str = "curve";
