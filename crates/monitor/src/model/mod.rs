//! The motor model: operating point, effects, residuals, and how they are judged.

pub(crate) mod doubt;
mod doubted;
pub(crate) mod effects;
mod judgement;
mod measured;
pub(crate) mod movement;
pub(crate) mod operating_point;
pub(crate) mod residuals;
pub(crate) mod settled;
