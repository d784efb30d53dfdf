//! Fits of a hypothesis, and how far its parameters may be off.

pub mod normal_equations;
pub mod nuisance;
pub mod output_error;
pub mod polish;
pub mod readings;
pub mod smoother;
pub mod uncertainty;
