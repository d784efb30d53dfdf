//! Recordings that are gone through several times.

use recording::Recording;

use super::Refusal;

/// A recording of any length, piece by piece and as often as asked.
pub trait Pieces {
    /// Its name.
    fn name(&self) -> &str;

    /// Gives every piece in the order of time, the same ones each time.
    ///
    /// # Errors
    /// What `take` refuses, and a file that can be read no more.
    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal>;
}

impl Pieces for Recording {
    fn name(&self) -> &str {
        Recording::name(self)
    }

    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal> {
        take(self)
    }
}
