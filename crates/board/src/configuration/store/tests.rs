//! The store on a flash whose power can fail at every step.

use proptest::prelude::*;

use super::super::tests::example;
use super::*;
use crate::chip::Chip;

fn numbered(number: u32) -> Configuration {
    let mut configuration = example();
    configuration.words_mut()[CONFIGURATION_WORDS - 1] = number;
    configuration
}

/// The newest one and the constants that it belongs to.
fn load(store: &mut ConfigurationStore<Chip>) -> Option<(u32, Configuration)> {
    let mut found = Configuration::BLANK;
    let confirmed = store.load(&mut found).expect("a readable chip");
    confirmed.compiled.map(|compiled| (compiled, found))
}

fn store(chip: Chip) -> ConfigurationStore<Chip> {
    ConfigurationStore::new(chip, 0)
}

#[test]
fn the_newest_of_many_holds() {
    let mut store = store(Chip::new(PAGES));
    assert_eq!(load(&mut store), None);
    for number in 0..10 {
        let saved = store.save(number, &numbered(number));
        saved.expect("a chip with power");
        assert_eq!(load(&mut store), Some((number, numbered(number))));
    }
    assert_eq!(store.flash.erasures, 10);
}

/// A page erased and the double words of a record.
const STEPS: u32 = 1 + RECORD_WORDS as u32 / 2;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn power_failing_at_any_step_leaves_the_old_or_the_new(
        count in 1..10_u32,
        fails_at in 0..=STEPS,
        noise in any::<u64>(),
    ) {
        let mut whole = store(Chip::new(PAGES));
        for number in 0..count {
            whole.save(number, &numbered(number)).expect("a chip with power");
        }
        whole.flash.noise = noise;
        whole.flash.steps_left = fails_at;
        let outcome = whole.save(count, &numbered(count));
        prop_assert_eq!(outcome.is_ok(), fails_at >= STEPS);
        whole.flash.steps_left = u32::MAX;
        let mut again = store(whole.flash);
        let found = load(&mut again);
        let [old, new] = [count - 1, count].map(|number| Some((number, numbered(number))));
        prop_assert!(found == old || found == new, "neither");
        again.save(99, &numbered(99)).expect("a chip with power");
        prop_assert_eq!(load(&mut again), Some((99, numbered(99))));
    }
}
