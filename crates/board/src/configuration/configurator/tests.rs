//! What holds when: trial, confirmation, other programs.

use super::super::store::PAGES;
use super::super::tests::{LINE, T_SAMPLE, example, image};
use super::*;
use crate::chip::Chip;

fn compiled(name: &'static str) -> Compiled {
    Compiled {
        name,
        image: Box::leak(Box::new(image(name))),
        t_sample: T_SAMPLE,
    }
}

fn at_start(chip: Chip) -> Configurator<Chip> {
    let store = ConfigurationStore::new(chip, 0);
    Configurator::new(compiled("assumed-300w"), Some(store), false)
}

/// The flash that a configurator has left.
fn flash_of(configurator: Configurator<Chip>) -> Chip {
    configurator.store.expect("a store").into_flash()
}

fn standing(board: &mut Configurator<Chip>) -> Configuration {
    let mut holds = Configuration::BLANK;
    board.standing(&mut holds);
    holds
}

fn name(configuration: &Configuration) -> String {
    configuration.name().text().expect("text").to_owned()
}

/// A board on which the example was confirmed.
fn with_example() -> Configurator<Chip> {
    let mut board = at_start(Chip::new(PAGES));
    assert!(board.commit(&example(), 0));
    assert!(board.confirm(&example()));
    board
}

#[test]
fn a_new_board_has_what_was_compiled_in() {
    let mut board = at_start(Chip::new(PAGES));
    let standing = standing(&mut board);
    assert_eq!(standing.line(), Ok(Line::default()));
    assert_eq!(name(&standing), "assumed-300w");
    assert_eq!(board.source(), ConfigurationSource::CompiledIn);
    assert_eq!(standing.check(T_SAMPLE), Ok(()));
}

#[test]
fn what_is_confirmed_holds_after_a_start_and_what_is_not_does_not() {
    for confirms in [false, true] {
        let mut board = at_start(Chip::new(PAGES));
        assert!(board.commit(&example(), 100));
        assert_eq!(board.source(), ConfigurationSource::Trial);
        if confirms {
            assert!(board.confirm(&example()));
        }
        let mut again = at_start(flash_of(board));
        assert_eq!(standing(&mut again) == example(), confirms);
    }
}

#[test]
fn a_trial_ends_after_a_minute_across_the_clocks_end() {
    let mut board = at_start(Chip::new(PAGES));
    let begun = u32::MAX - 20;
    let mut holds = example();
    assert!(board.commit(&holds, begun));
    for after in 0..TRIAL_S {
        let now = begun.wrapping_add(after);
        assert!(!board.look(now, &mut holds), "{after} s");
        assert_eq!(board.seconds_left(now), Some(TRIAL_S - after));
    }
    assert_eq!(holds, example());
    assert!(board.look(begun.wrapping_add(TRIAL_S), &mut holds));
    assert_eq!(name(&holds), "assumed-300w");
    assert_eq!(board.source(), ConfigurationSource::CompiledIn);
    assert!(
        !board.look(begun.wrapping_add(TRIAL_S + 1), &mut holds),
        "once"
    );
    assert!(!board.confirm(&example()), "too late");
    assert_eq!(board.refused(), Some(Refused::NoTrial));
}

#[test]
fn a_discarded_trial_leaves_what_was_confirmed_before() {
    let mut board = with_example();
    let mut other = example();
    other.set_line(Line { unit: 7, ..LINE });
    assert!(board.commit(&other, 10));
    assert!(board.discard(&mut other));
    assert_eq!(other, example());
    assert_eq!(board.source(), ConfigurationSource::Confirmed);
    assert!(!board.discard(&mut other));
}

#[test]
fn what_is_refused_begins_no_trial() {
    let mut board = at_start(Chip::new(PAGES));
    let mut damaged = example();
    damaged.words_mut()[50] ^= 4;
    assert!(!board.commit(&damaged, 0));
    assert_eq!(board.refused(), Some(Refused::Checksum));
    assert_eq!(board.seconds_left(0), None);
    assert_eq!(board.source(), ConfigurationSource::CompiledIn);
}

/// Somebody flashes another motor: what was configured for the program before does not take its place.
#[test]
fn a_program_with_other_constants_keeps_the_line_and_has_its_own_motor() {
    let store = ConfigurationStore::new(flash_of(with_example()), 0);
    let mut flashed = Configurator::new(compiled("chalmers-4kw"), Some(store), false);
    let standing = standing(&mut flashed);
    assert_eq!(
        (standing.line(), name(&standing)),
        (Ok(LINE), "chalmers-4kw".into())
    );
    assert_eq!(flashed.source(), ConfigurationSource::OtherProgram);
}

#[test]
fn a_button_held_at_power_up_gives_the_line_of_a_new_board_until_somebody_configures() {
    let store = ConfigurationStore::new(flash_of(with_example()), 0);
    let mut held = Configurator::new(compiled("assumed-300w"), Some(store), true);
    let mut other = standing(&mut held);
    assert_eq!(other.line(), Ok(Line::default()));
    assert_eq!(other.constants(), example().constants());
    other.set_line(Line { unit: 9, ..LINE });
    assert!(held.commit(&other, 0) && held.confirm(&other));
    assert_eq!(standing(&mut held), other);
}

#[test]
fn rubbish_in_flash_is_told_and_compiled_constants_hold() {
    let mut chip = Chip::new(PAGES);
    for k in 0..chip.bytes.len() {
        chip.bytes[k] = chip.random();
    }
    let mut board = at_start(chip);
    assert_eq!(name(&standing(&mut board)), "assumed-300w");
    assert_eq!(board.source(), ConfigurationSource::Lost);
}

#[test]
fn what_was_compiled_in_can_be_tried_again_with_the_line_as_it_is() {
    let mut board = with_example();
    let mut holds = example();
    board.commit_compiled(&mut holds, 5);
    assert_eq!(
        (name(&holds), holds.line()),
        ("assumed-300w".into(), Ok(LINE))
    );
    assert_eq!(board.source(), ConfigurationSource::Trial);
    assert!(board.confirm(&holds));
    assert_eq!(standing(&mut board), holds);
}
