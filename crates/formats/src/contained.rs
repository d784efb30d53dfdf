//! A bulkhead around a library that panics on damaged files.
//!
//! The decoder of `parquet` trusts the lengths inside a page and indexes by them; only its authors can mend that. Its
//! panics are caught here and become the error of a damaged file, without a word on the terminal.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// What `work` returns; `None` when it panics. Nothing that it has touched may be used then.
pub(crate) fn contained<T>(work: impl FnOnce() -> T) -> Option<T> {
    static SILENCER: Once = Once::new();
    SILENCER.call_once(|| {
        let others = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !CONTAINED.get() {
                others(info);
            }
        }));
    });
    let before = CONTAINED.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(work));
    CONTAINED.set(before);
    outcome.ok()
}

#[cfg(test)]
mod tests {
    use super::contained;

    #[test]
    fn a_panic_becomes_none_and_the_next_one_too() {
        let at = |k: usize| contained(move || [1, 2, 3][k]);
        assert_eq!((at(3), at(2), at(7)), (None, Some(3), None));
    }
}
