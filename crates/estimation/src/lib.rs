//! A motor model held against recordings: inputs made smooth, noise floor, priors, fits with intervals, and what the data
//! that were not fitted say of them.
//!
//! A [`Question`](data::question::Question) becomes a [`Study`](data::study::Study): one recording that is fitted, others
//! that prove, and what is believed of the motor. A [`Hypothesis`](model::prior::Hypothesis) names effects and parameters;
//! fitted, it is a [`Trial`](data::study::Trial), and two trials are compared by [`proof`].

pub mod data;
pub mod fit;
pub mod model;
pub mod proof;
#[cfg(any(test, feature = "specimen"))]
pub mod specimen;
#[cfg(test)]
mod tests;
