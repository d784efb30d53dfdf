//! What is told of all motors at once: metrics, the models in force, a month.

pub(super) mod metrics;
pub(super) mod models;
pub mod month;
#[cfg(test)]
mod tests;
