//! Long recordings: a fit simulates its recording hundreds of times, so that of a long one some stretches are taken.

mod choice;
mod joined;

pub use choice::told;
pub(crate) use choice::{Stretch, stretches};
pub(crate) use joined::joined;

#[cfg(test)]
mod tests;
