//! The motor model: operating point, effects, residuals.

pub(crate) mod effects;
pub(crate) mod operating_point;
pub(crate) mod residuals;
pub(crate) mod settled;
