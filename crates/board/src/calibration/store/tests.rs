//! The store on a flash whose power can fail at every step, with the torn cell contents that silicon leaves.

use proptest::prelude::*;

use super::super::tests::example;
use super::*;
use crate::chip::Chip;

fn store(chip: Chip) -> Store<Chip> {
    Store::new(chip, 0)
}

#[test]
fn an_erased_flash_holds_nothing_and_nothing_is_lost() {
    let loaded = store(Chip::new(PAGES)).load().expect("a readable chip");
    assert_eq!((loaded.newest, loaded.lost), (None, false));
}

#[test]
fn the_newest_of_many_holds_and_pages_are_erased_in_turns() {
    let mut store = store(Chip::new(PAGES));
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
    let mut chip = Chip::new(PAGES);
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
    let mut whole = store(Chip::new(PAGES));
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
