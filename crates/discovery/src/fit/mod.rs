//! Fits of a hypothesis, and how far its parameters may be off.

pub(crate) mod normal_equations;
pub(crate) mod output_error;
pub(crate) mod polish;
pub(crate) mod readings;
pub(crate) mod uncertainty;
