//! The ring on a flash whose power can fail at every step, and whose pages are erased while the program goes on.

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use proptest::prelude::*;

use super::super::event::tests::example;
use super::*;
use crate::chip::{Chip, PowerFailed};

/// Looks at a page that is being erased before it is done: some 22 ms in blocks of 3.2 ms.
const ERASING_LOOKS: u32 = 7;

/// A chip, the page it is erasing, and how often it will still say so.
#[derive(Clone)]
struct Background {
    chip: Chip,
    erasing: Option<(u32, u32)>,
    defective: bool,
}

impl ErrorType for Background {
    type Error = PowerFailed;
}

impl ReadNorFlash for Background {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerFailed> {
        assert_eq!(self.erasing, None, "the program would stall");
        self.chip.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.chip.capacity()
    }
}

impl NorFlash for Background {
    const WRITE_SIZE: usize = Chip::WRITE_SIZE;
    const ERASE_SIZE: usize = Chip::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerFailed> {
        self.chip.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerFailed> {
        assert_eq!(self.erasing, None, "the program would stall");
        self.chip.write(offset, bytes)
    }
}

impl BackgroundFlash for Background {
    fn is_ready(&mut self) -> bool {
        match &mut self.erasing {
            None => true,
            Some((offset, 0)) => {
                let offset = *offset;
                self.erasing = None;
                if !self.defective {
                    let _ = self.chip.erase(offset, offset + PAGE_BYTES);
                }
                true
            }
            Some((_, looks)) => {
                *looks -= 1;
                false
            }
        }
    }

    fn begin_erase(&mut self, offset: u32) {
        self.erasing = Some((offset, ERASING_LOOKS));
    }
}

fn log(chip: Chip) -> EventLog<Background> {
    let flash = Background {
        chip,
        erasing: None,
        defective: false,
    };
    EventLog::open(flash, 0)
}

/// Tries as often as the firmware would, until the event is written or lost.
fn put(log: &mut EventLog<Background>, event: &Event) -> (Appended, u32) {
    let mut waits = 0;
    loop {
        match log.append(event) {
            Appended::Wait => waits += 1,
            outcome => return (outcome, waits),
        }
        assert!(waits < 100, "it waits for ever");
    }
}

fn at(log: &mut EventLog<Background>, number: u32) -> Option<Event> {
    let bytes = log.read(place_of(number)).expect("a readable chip");
    Event::from_bytes(&bytes).filter(|event| event.number == number)
}

#[test]
fn events_are_numbered_from_one_and_found_again() {
    let mut first = log(Chip::new(LOG_PAGES));
    assert_eq!(first.newest(), 0);
    for number in 1..=5 {
        assert_eq!(put(&mut first, &example(0)), (Appended::Written, 0));
        assert_eq!(first.newest(), number);
    }
    let mut again = log(first.flash.chip);
    assert_eq!(again.newest(), 5);
    assert_eq!(at(&mut again, 3), Some(example(3)));
    assert_eq!(at(&mut again, 6), None);
}

#[test]
fn the_ring_forgets_a_page_at_a_time_and_waits_while_it_is_erased() {
    let mut log = log(Chip::new(LOG_PAGES));
    let mut waited = 0;
    for _ in 0..3 * LOG_EVENTS {
        let (outcome, waits) = put(&mut log, &example(0));
        assert_eq!(outcome, Appended::Written);
        waited += u32::from(waits > 0);
    }
    // The first round meets blank pages.
    assert_eq!(log.flash.chip.erasures, 2 * LOG_PAGES);
    assert_eq!(waited, 2 * LOG_PAGES);
    let newest = log.newest();
    assert_eq!(newest, 3 * LOG_EVENTS);
    let kept = (1..=newest).filter(|number| at(&mut log, *number).is_some());
    assert_eq!(kept.count() as u32, LOG_EVENTS);
}

#[test]
fn a_flash_of_rubbish_is_erased_page_by_page() {
    let mut chip = Chip::new(LOG_PAGES);
    for k in 0..chip.bytes.len() {
        chip.bytes[k] = chip.random();
    }
    let mut log = log(chip);
    assert_eq!(log.newest(), 0);
    for number in 1..=100 {
        assert_eq!(put(&mut log, &example(0)).0, Appended::Written);
        assert_eq!(at(&mut log, number), Some(example(number)));
    }
}

#[test]
fn a_page_that_does_not_erase_is_not_worn_down() {
    let mut chip = Chip::new(LOG_PAGES);
    chip.bytes.fill(0);
    let mut log = log(chip);
    log.flash.defective = true;
    for _ in 0..20 {
        assert_eq!(put(&mut log, &example(0)).0, Appended::Lost);
    }
    assert_eq!(log.failures, MOST_FAILURES);
}

/// An event in another place than its number's does not belong to this ring.
#[test]
fn an_event_in_a_strange_place_is_not_taken_for_the_newest() {
    let mut chip = Chip::new(LOG_PAGES);
    chip.bytes[..EVENT_BYTES].copy_from_slice(&example(70).to_bytes());
    assert_eq!(log(chip).newest(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn power_failing_at_any_step_loses_no_earlier_event_and_no_later_one(
        count in prop_oneof![0..200_u32, LOG_EVENTS - 10..LOG_EVENTS + 80],
        fails_at in 0..6_u32,
        noise in any::<u64>(),
    ) {
        let mut whole = log(Chip::new(LOG_PAGES));
        for _ in 0..count {
            put(&mut whole, &example(0));
        }
        whole.flash.chip.noise = noise;
        whole.flash.chip.steps_left = fails_at;
        put(&mut whole, &example(0));
        whole.flash.chip.steps_left = u32::MAX;
        whole.flash.erasing = None;
        let mut again = log(whole.flash.chip);
        let found = again.newest();
        prop_assert!(found == count || found == count + 1, "{}", found);
        prop_assert_eq!(put(&mut again, &example(0)).0, Appended::Written);
        let (newest, kept) = (again.newest(), LOG_EVENTS - 2 * PER_PAGE);
        prop_assert!(newest > count);
        prop_assert_eq!(at(&mut again, newest), Some(example(newest)));
        for number in (1..=count).rev().take(kept as usize) {
            prop_assert_eq!(at(&mut again, number), Some(example(number)));
        }
    }
}
