//! The journal alone: full pages, torn words, words that were begun and read blank.

use embedded_storage::nor_flash::NorFlash;
use update::layout::{JOURNAL, JOURNAL_PAGES, PAGE_BYTES};
use update::{Journal, State};

use crate::flash::Flash;
use crate::{note, state};

fn numbered(k: u32) -> State {
    State::Exchanging {
        pages: 100,
        step: (k % 200) as u8,
    }
}

#[test]
fn the_newest_state_is_found_however_often_pages_are_full() {
    let mut flash = Flash::blank();
    // Numbers of twelve bits come round twice.
    for k in 0..10_000 {
        note(&mut flash, numbered(k));
        assert_eq!(state(&mut flash), numbered(k));
    }
}

#[test]
fn power_may_fail_within_every_write() {
    let mut flash = Flash::blank();
    note(&mut flash, numbered(0));
    for k in 1..3_000 {
        flash.seed(u64::from(k));
        // An erasure and a word at most: 0 fails within the first of them, 1 within the second.
        flash.steps_left = Some(k % 2);
        let mut journal = Journal::open(&mut flash, JOURNAL).unwrap();
        let written = journal.write(&mut flash, numbered(k));
        flash.power_on();
        let found = state(&mut flash);
        let before = numbered(k - 1);
        assert!(
            found == numbered(k) || written.is_err() && found == before,
            "{k}: {found:?}"
        );
        if found == before {
            note(&mut flash, numbered(k));
        }
    }
}

#[test]
fn pages_full_of_rubbish_are_no_state_and_do_not_block_it() {
    let mut flash = Flash::blank();
    let bytes = JOURNAL_PAGES * PAGE_BYTES;
    let rubbish: Vec<u8> = (0..bytes).map(|k| (k * k % 251) as u8).collect();
    flash.write(JOURNAL, &rubbish).unwrap();
    assert_eq!(state(&mut flash), State::Idle);
    note(&mut flash, State::Requested);
    assert_eq!(state(&mut flash), State::Requested);
}

#[test]
fn a_place_that_was_begun_and_reads_blank_is_passed_over() {
    let mut flash = Flash::blank();
    note(&mut flash, State::Requested);
    flash.write(JOURNAL + 8, &[0xFF; 8]).unwrap();
    note(&mut flash, State::Confirmed);
    assert_eq!(state(&mut flash), State::Confirmed);
}
