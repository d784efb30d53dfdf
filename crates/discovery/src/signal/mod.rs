//! Signals before any model: smoothing, denoising of the supply, noise estimates.

mod noise;
mod polynomial;
mod supply;

pub(crate) use noise::estimated_sigma;
pub(crate) use polynomial::smooth;
pub(crate) use supply::{Supply, denoise};
