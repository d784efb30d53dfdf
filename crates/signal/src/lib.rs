//! Measured signals before any model: smoothing as far as the noise allows, denoising of the supply, the noise itself.
//!
//! ```
//! // White noise of one unit on a constant: a window over all of it, a small part of the noise is left.
//! let noise: Vec<f64> = (0..4000u32).map(|k| f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 18918.6 - 1.732).collect();
//! let windows = signal::longest_real(&noise, 1.0, 25, false);
//! let left: Vec<f64> = windows.smooth(&noise);
//! assert!(left[2000].abs() < 0.2);
//! ```

mod adaptive;
mod dot;
mod noise;
mod polynomial;
mod sample;
mod smoothed;
mod supply;

pub use adaptive::{Noisy, Windows, longest_real};
pub use dot::dot;
pub use noise::{are_counts, estimated_sigma, sigma};
pub use sample::{Sample, append};
pub use smoothed::{Line, Smoothed};
pub use supply::{Supply, denoise, refined};
