//! From the plate of a squirrel-cage induction motor to its equivalent circuit, every parameter with an interval.
//!
//! A plate prints six to ten numbers, a circuit has twelve unknowns: what the numbers leave open, a prior over real motors
//! settles, and the intervals say how well.

pub mod catalogue;
pub mod circuit;
pub mod contradiction;
mod estimate;
pub mod fit;
mod interval;
mod motor_text;
pub mod physical;
pub mod plate;
pub mod prior;

pub use estimate::{COLUMN_KEYS, COLUMNS, Estimate};
pub use interval::Interval;
pub use motor_text::motor_text;
pub use plate::Plate;
