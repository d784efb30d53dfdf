//! Signals before any model: smoothing, denoising of the supply, noise estimates.

mod adaptive;
mod noise;
mod polynomial;
mod supply;

pub(crate) use adaptive::{Windows, longest_real};
pub(crate) use noise::{estimated_sigma, sigma};
pub(crate) use supply::{Supply, denoise, refined};
