//! The store on a flash whose power can fail at every step, with the torn cell contents that silicon leaves.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use proptest::prelude::*;

use super::super::tests::example;
use super::*;

/// Flash as in the reference manual: erased to ones by page, programmed once per double word.
#[derive(Clone)]
struct Chip {
    bytes: Vec<u8>,
    /// Double words programmed and pages erased before power fails.
    steps_left: u32,
    /// What a torn step leaves: random bits.
    noise: u64,
    erasures: u32,
}

#[derive(Debug)]
struct PowerFailed;

impl NorFlashError for PowerFailed {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Chip {
    fn new() -> Self {
        Chip {
            bytes: vec![0xFF; (PAGES * PAGE_BYTES) as usize],
            steps_left: u32::MAX,
            noise: 1,
            erasures: 0,
        }
    }

    fn random(&mut self) -> u8 {
        // Knuth's 64-bit linear congruential generator.
        self.noise = self
            .noise
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.noise >> 56) as u8
    }

    fn step(&mut self) -> bool {
        let whole = self.steps_left > 0;
        self.steps_left = self.steps_left.saturating_sub(1);
        whole
    }
}

impl ErrorType for Chip {
    type Error = PowerFailed;
}

impl ReadNorFlash for Chip {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerFailed> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Chip {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerFailed> {
        assert_eq!((from % PAGE_BYTES, to - from), (0, PAGE_BYTES));
        self.erasures += 1;
        let whole = self.step();
        for k in from as usize..to as usize {
            self.bytes[k] |= if whole { 0xFF } else { self.random() };
        }
        if whole { Ok(()) } else { Err(PowerFailed) }
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerFailed> {
        assert!(offset.is_multiple_of(8) && bytes.len().is_multiple_of(8));
        let places = (offset as usize..).step_by(8);
        for (at, word) in places.zip(bytes.chunks(8)) {
            let blank = self.bytes[at..at + 8].iter().all(|byte| *byte == 0xFF);
            assert!(blank, "a double word may be programmed once");
            let whole = self.step();
            for (k, byte) in word.iter().enumerate() {
                self.bytes[at + k] &= byte | if whole { 0 } else { self.random() };
            }
            if !whole {
                return Err(PowerFailed);
            }
        }
        Ok(())
    }
}

fn store(chip: Chip) -> Store<Chip> {
    Store::new(chip, 0)
}

#[test]
fn an_erased_flash_holds_nothing_and_nothing_is_lost() {
    let loaded = store(Chip::new()).load().expect("a readable chip");
    assert_eq!((loaded.newest, loaded.lost), (None, false));
}

#[test]
fn the_newest_of_many_holds_and_pages_are_erased_in_turns() {
    let mut store = store(Chip::new());
    for k in 0..100 {
        store.save(&example(k)).expect("a chip with power");
        let loaded = store.load().expect("a readable chip");
        assert_eq!(loaded.newest, Some(example(k)));
    }
    // 12 places a page: 100 records begin pages at 12, 24, ... 96.
    assert_eq!(store.flash.erasures, 8);
}

#[test]
fn a_store_of_rubbish_says_that_something_is_lost_and_can_be_written_again() {
    let mut chip = Chip::new();
    for k in 0..chip.bytes.len() {
        chip.bytes[k] = chip.random();
    }
    let mut store = store(chip);
    assert!(store.load().expect("a readable chip").lost);
    store.save(&example(5)).expect("a chip with power");
    assert_eq!(
        store.load().expect("a readable chip").newest,
        Some(example(5))
    );
}

/// Power fails at step `fails_at` of storing number `count`; then the board starts again.
fn interrupted(count: u32, fails_at: u32, noise: u64) -> Store<Chip> {
    let mut whole = store(Chip::new());
    for k in 0..count {
        whole.save(&example(k)).expect("a chip with power");
    }
    whole.flash.noise = noise;
    whole.flash.steps_left = fails_at;
    let outcome = whole.save(&example(count));
    // 20 double words, and an erasure where a page is full.
    let steps = 20 + u32::from(count.is_multiple_of(PLACES));
    assert_eq!(outcome.is_ok(), fails_at >= steps);
    whole.flash.steps_left = u32::MAX;
    store(whole.flash)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn power_failing_at_any_step_leaves_the_old_or_the_new(
        count in 1..40_u32,
        fails_at in 0..=21_u32,
        noise in any::<u64>(),
    ) {
        let mut store = interrupted(count, fails_at, noise);
        let found = store.load().expect("a readable chip").newest;
        let (old, new) = (Some(example(count - 1)), Some(example(count)));
        prop_assert!(found == old || found == new, "{found:?}");
        store.save(&example(99)).expect("a chip with power");
        prop_assert_eq!(store.load().expect("a readable chip").newest, Some(example(99)));
    }
}
