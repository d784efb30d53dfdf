//! Transfers into a flash that erases in the background, refuses to be programmed twice and can lose its power at any word.

use proptest::prelude::*;

use super::*;
use crate::receiving::bank::{Bank, package};
use crate::receiving::tray::{NotLaid, PIECE_BYTES, Tray};
use crate::seal::{BOARD_TYPE, Version};

/// A board's two ends: the line's, and the task's that owns flash.
struct Ends {
    tray: Tray,
    waiting: Waiting<Bank>,
    failed: Option<Refusal>,
}

impl Ends {
    fn new() -> Self {
        let mut tray = Tray::closed();
        tray.set_open(true);
        Ends {
            tray,
            waiting: Waiting::new(Bank::used()),
            failed: None,
        }
    }

    /// What the firmware does between two blocks of samples. No step may take long.
    fn between_blocks(&mut self) {
        self.waiting.flash.written = 0;
        self.waiting.flash.read = 0;
        match self.tray.portion() {
            None => self.waiting.rest(),
            Some(portion) => match self.waiting.take(&portion) {
                Taken::Done => self.tray.settle(self.waiting.received()),
                Taken::Wait => {}
                Taken::Failed(refusal) => {
                    self.tray.fail();
                    self.failed = Some(refusal);
                }
            },
        }
        assert!(self.waiting.flash.written <= 4 && self.waiting.flash.read <= 32);
    }

    /// A master that repeats what was refused because the board was busy.
    fn send(&mut self, offset: usize, piece: &[u8]) -> Result<(), NotLaid> {
        for _ in 0..100 {
            match self.tray.lay(offset as u32, piece) {
                Err(NotLaid::Busy) => self.between_blocks(),
                other => return other,
            }
        }
        Err(NotLaid::Busy)
    }

    fn send_all(&mut self, package: &[u8], piece_bytes: usize) -> Result<(), NotLaid> {
        for (k, piece) in package.chunks(piece_bytes).enumerate() {
            self.send(k * piece_bytes, piece)?;
        }
        (0..40).for_each(|_| self.between_blocks());
        Ok(())
    }

    fn checked(&mut self, running: Option<Seal>) -> Checked {
        for _ in 0..2_000 {
            self.waiting.flash.read = 0;
            let checked = self.waiting.check(running);
            assert!(self.waiting.flash.read <= CHECKED_BYTES);
            if checked != Checked::NotYet {
                return checked;
            }
        }
        panic!("the check does not end");
    }

    fn holds(&self, package: &[u8]) -> bool {
        self.waiting.flash.bytes[..package.len()] == *package
    }
}

fn version_of(checked: Checked) -> Option<u32> {
    match checked {
        Checked::Whole(seal) => Some(seal.version.0),
        _ => None,
    }
}

#[test]
fn the_longest_program_is_received_and_checked_without_a_long_step() {
    let most = (crate::layout::PROGRAM_PAGES * PAGE_BYTES) as usize;
    let package = package(most, BOARD_TYPE, 5);
    let mut ends = Ends::new();
    assert_eq!(ends.send_all(&package, PIECE_BYTES), Ok(()));
    assert_eq!(ends.waiting.received() as usize, package.len());
    assert!(ends.holds(&package));
    assert_eq!(version_of(ends.checked(None)), Some(5));
    assert_eq!(
        ends.waiting.flash.erasures, WAITING_PAGES as usize,
        "each page once"
    );
}

#[test]
fn pages_are_erased_ahead_so_that_a_slow_line_never_waits() {
    let package = package(9_000, BOARD_TYPE, 1);
    let mut ends = Ends::new();
    for (k, piece) in package.chunks(PIECE_BYTES).enumerate() {
        assert_eq!(
            ends.tray.lay((k * PIECE_BYTES) as u32, piece),
            Ok(()),
            "piece {k}"
        );
        // At 115 200 bit/s a piece and its answer take 46 ms: 14 blocks.
        (0..if k == 0 { 20 } else { 14 }).for_each(|_| ends.between_blocks());
    }
    assert!(ends.holds(&package));
}

#[test]
fn pieces_of_any_length_cross_pages() {
    for piece_bytes in [8, 40, 232, 240] {
        let package = package(5_002, BOARD_TYPE, 1);
        let mut ends = Ends::new();
        assert_eq!(ends.send_all(&package, piece_bytes), Ok(()));
        assert!(ends.holds(&package), "{piece_bytes}");
    }
}

#[test]
fn a_piece_that_comes_again_writes_nothing_and_another_in_its_place_ends_the_transfer() {
    let package = package(3_000, BOARD_TYPE, 1);
    let mut ends = Ends::new();
    ends.send_all(&package[..960], PIECE_BYTES)
        .expect("received");
    let before = ends.waiting.flash.bytes.clone();
    for k in [3, 1, 2] {
        let from = k * PIECE_BYTES;
        ends.send(from, &package[from..from + PIECE_BYTES])
            .expect("again");
        (0..20).for_each(|_| ends.between_blocks());
    }
    assert!(ends.waiting.flash.bytes == before);
    assert_eq!(ends.waiting.received(), 960);
    ends.send(240, &[0; PIECE_BYTES]).expect("a place");
    (0..20).for_each(|_| ends.between_blocks());
    assert_eq!(ends.failed, Some(Refusal::Incomplete));
    assert_eq!(ends.send(960, &package[960..1_200]), Err(NotLaid::Failed));
    assert_eq!(ends.checked(None), Checked::Refused(Refusal::Incomplete));
    assert_eq!(ends.send_all(&package, PIECE_BYTES), Ok(()));
    assert_eq!(version_of(ends.checked(None)), Some(1));
}

#[test]
fn a_gap_is_refused_at_once() {
    let mut ends = Ends::new();
    ends.send_all(&[1; 480], PIECE_BYTES).expect("received");
    assert_eq!(ends.send(720, &[1; 8]), Err(NotLaid::Gap));
    assert_eq!(ends.send(480, &[1; 8]), Ok(()));
}

#[test]
fn a_transfer_begins_anew_at_any_time_with_another_package() {
    let (first, second) = (package(4_000, BOARD_TYPE, 1), package(4_000, BOARD_TYPE, 2));
    for sent in [240, 2_160, 4_064] {
        let mut ends = Ends::new();
        ends.send_all(&first[..sent], PIECE_BYTES)
            .expect("received");
        ends.send_all(&second, PIECE_BYTES).expect("received");
        assert!(ends.holds(&second));
        assert_eq!(version_of(ends.checked(None)), Some(2));
    }
}

#[test]
fn what_lies_there_from_before_the_start_is_never_taken() {
    let package = package(3_000, BOARD_TYPE, 1);
    let mut ends = Ends::new();
    ends.send_all(&package, PIECE_BYTES).expect("received");
    ends.waiting = Waiting::new(ends.waiting.flash);
    assert_eq!(ends.checked(None), Checked::Refused(Refusal::Incomplete));
}

#[test]
fn each_reason_has_its_refusal() {
    let running = |version| Seal {
        length: 1_000,
        checksum: 0,
        version: Version(version),
        board: BOARD_TYPE,
    };
    let good = package(3_000, BOARD_TYPE, 7);
    let changed = |at: usize| {
        let mut package = good.clone();
        package[at] ^= 1;
        package
    };
    for (package, running, expected) in [
        (package(3_000, BOARD_TYPE + 1, 7), None, Refusal::Board),
        (good.clone(), Some(running(8)), Refusal::Older),
        (good[..good.len() - 2].to_vec(), None, Refusal::Incomplete),
        (good[..400].to_vec(), None, Refusal::Incomplete),
        (changed(SEAL_OFFSET), None, Refusal::NoProgram),
        (changed(SEAL_OFFSET + 8), None, Refusal::Checksum),
        (changed(0), None, Refusal::Checksum),
        (changed(2_999), None, Refusal::Checksum),
    ] {
        let mut ends = Ends::new();
        ends.send_all(&package, PIECE_BYTES).expect("received");
        assert_eq!(ends.checked(running), Checked::Refused(expected));
    }
    let mut ends = Ends::new();
    ends.send_all(&good, PIECE_BYTES).expect("received");
    assert_eq!(version_of(ends.checked(Some(running(7)))), Some(7));
}

#[test]
fn more_than_there_is_room_for_is_refused() {
    let room = (WAITING_PAGES * PAGE_BYTES) as usize;
    let mut ends = Ends::new();
    ends.send_all(&vec![1; room - room % PIECE_BYTES], PIECE_BYTES)
        .expect("room");
    let at = room - room % PIECE_BYTES;
    ends.send(at, &[1; PIECE_BYTES]).expect("a place");
    (0..20).for_each(|_| ends.between_blocks());
    assert_eq!(ends.failed, Some(Refusal::NoProgram));
}

#[test]
fn a_low_supply_makes_the_line_wait_and_nothing_is_written() {
    let package = package(1_000, BOARD_TYPE, 1);
    let mut ends = Ends::new();
    ends.waiting.flash.supplied = false;
    ends.send(0, &package[..240]).expect("a place");
    assert_eq!(ends.send(240, &package[240..480]), Err(NotLaid::Busy));
    ends.waiting.flash.supplied = true;
    assert_eq!(ends.send_all(&package, PIECE_BYTES), Ok(()));
    assert!(ends.holds(&package));
}

proptest! {
    /// Whatever a master sends in whatever order: what passes the check is the package, byte for byte.
    #[test]
    fn what_is_checked_is_whole(order in prop::collection::vec(0..14_usize, 0..60), torn in 0..800_usize) {
        let package = package(3_000, BOARD_TYPE, 3);
        let pieces: Vec<&[u8]> = package.chunks(PIECE_BYTES).collect();
        let mut ends = Ends::new();
        ends.waiting.flash.words_left = torn;
        for k in order {
            let k = k.min(pieces.len() - 1);
            let _ = ends.send(k * PIECE_BYTES, pieces[k]);
            (0..16).for_each(|_| ends.between_blocks());
        }
        if let Checked::Whole(_) = ends.checked(None) {
            prop_assert!(ends.holds(&package));
        }
        // Flash that works again takes the next transfer.
        ends.waiting.flash.words_left = usize::MAX;
        prop_assert_eq!(ends.send_all(&package, PIECE_BYTES), Ok(()));
        prop_assert_eq!(version_of(ends.checked(None)), Some(3));
    }
}
