//! How many numbers a file may hold: what does not fit into memory is refused while it is being read, compressed or not.

use recording::Error;
use std::cell::Cell;

/// Numbers of one file: 1.6 GB in memory. A compression bomb stops here.
const MOST_NUMBERS: u64 = 200_000_000;

thread_local! {
    static MOST: Cell<u64> = const { Cell::new(MOST_NUMBERS) };
}

/// Numbers that a file read on this thread may hold.
pub(super) fn most_numbers() -> u64 {
    MOST.get()
}

/// Runs `work`; files that it reads on this thread may hold at most so many numbers.
///
/// A server reads what strangers send: it gives less than the commands, which read what their user chose.
pub fn with_most_numbers<T>(most: u64, work: impl FnOnce() -> T) -> T {
    /// Puts the bound back even when the work breaks off.
    struct Before(u64);
    impl Drop for Before {
        fn drop(&mut self) {
            MOST.set(self.0);
        }
    }
    let _before = Before(MOST.replace(most.min(MOST_NUMBERS)));
    work()
}

/// The error for a file with more.
pub(super) fn too_large(file: &str) -> Error {
    let message = format!("holds more than {} numbers", most_numbers());
    let remedy = "cut the recording; a few seconds with load steps are enough";
    Error::unsupported(file, message, remedy)
}
