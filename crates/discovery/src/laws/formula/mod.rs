//! Formulas beside the curve of a law.
//!
//! A dictionary of shapes ([`dictionary`]) is fitted on the information of the refitted curve ([`quadratic`], [`propose`]);
//! the likeliest are refitted in the simulator with everything else free, and those that lose next to nothing against
//! the curve are shown, the one with the fewest numbers first ([`prove`]).

pub(crate) mod dictionary;
mod effect;
mod kind;
mod propose;
pub(crate) mod prove;
mod quadratic;
pub(crate) mod report;
mod shape;
pub(crate) mod write;

#[cfg(test)]
mod tests;
