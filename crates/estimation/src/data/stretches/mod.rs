//! Long recordings: a fit simulates its recording hundreds of times, so that of a long one some stretches are taken.

mod choice;
mod cut;

pub use choice::told;
pub use choice::{Stretch, stretches};
pub use cut::cut;

#[cfg(test)]
mod tests;
