//! Long recordings: a fit simulates its recording hundreds of times, so that of a long one some stretches are taken.

mod cells;
mod choice;
mod chosen;
mod cut;
mod excerpt;
mod look;

pub use choice::told;
pub use choice::{LONGEST_WHOLE, Stretch, stretches};
pub use chosen::{Budget, Role, StretchReport};
pub use cut::cut;
pub use excerpt::{Choice, Excerpt, Gathering};
pub use look::{FirstLook, Seen};

#[cfg(test)]
mod tests;
