//! Standard tests on one motor: DC resistance, no-load, locked rotor, load, coast-down, in the steps of IEEE 112 and IEC 60034-28.
//!
//! Every step is optional. What a plate and the prior believe ([`crate::Estimate`]) is where the tests begin: each reading is one more
//! row of the same fit, with its instrument's uncertainty, and every step's intervals follow from all rows up to it. Source of the
//! test circuits: IEEE Std 112-2017, clause 5.9 and form F.

mod advice;
mod begin;
mod doubt;
mod fit;
mod instruments;
mod parameters;
mod plate_term;
mod point;
mod steps;
pub mod table;
mod tolerances;
mod unknowns;

pub use advice::Help;
pub use doubt::{Culprit, Doubt, What};
pub use instruments::Instruments;
pub use parameters::{ALL, Form, NAMES};
pub use steps::{Step, Tested};
