//! Values over time that do not grow without end.

use std::ops::Deref;

/// Values that are kept at most. Of 50 s at 100 Hz every window is kept.
pub const MOST: usize = 5_120;

/// Every value up to [`MOST`], then every second, fourth and so on.
#[derive(Clone, Debug, PartialEq)]
pub struct Thinned<T> {
    values: Vec<T>,
    every: u64,
    seen: u64,
}

impl<T> Default for Thinned<T> {
    fn default() -> Self {
        Thinned {
            values: Vec::new(),
            every: 1,
            seen: 0,
        }
    }
}

impl<T> Thinned<T> {
    /// Takes the next value.
    pub fn push(&mut self, value: T) {
        if self.values.len() == MOST {
            let mut keep = false;
            self.values.retain(|_| {
                keep = !keep;
                keep
            });
            self.every *= 2;
        }
        if self.seen.is_multiple_of(self.every) {
            self.values.push(value);
        }
        self.seen += 1;
    }

    /// One of how many values is kept.
    pub fn every(&self) -> u64 {
        self.every
    }
}

impl<T> Deref for Thinned<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_evenly_spread_and_bounded() {
        let mut kept = Thinned::default();
        (0..MOST).for_each(|k| kept.push(k));
        assert_eq!((kept.every(), kept.len()), (1, MOST));
        (MOST..5 * MOST).for_each(|k| kept.push(k));
        assert_eq!(kept.every(), 8);
        let expected: Vec<usize> = (0..5 * MOST).step_by(8).collect();
        assert_eq!(kept[..], expected);
    }
}
