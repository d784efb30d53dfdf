//! The published linear motor (33), and the general parity method (5)-(10) for any linear model.

pub mod linear_plant;
mod relation;

pub use relation::{Parity, ParityError, published_w};
