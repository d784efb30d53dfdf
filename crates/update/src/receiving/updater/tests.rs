//! From the first piece to the trial's end, with the journal that the loader finds.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

use super::*;
use crate::layout::{FLASH_BASE, JOURNAL_PAGES, PAGE_BYTES, WAITING};
use crate::receiving::bank::{Bank, Failed, package};
use crate::receiving::tray::{PIECE_BYTES, Tray};
use crate::seal::BOARD_TYPE;

/// The whole chip: bank 1 with journal and program, bank 2.
#[derive(Clone)]
struct Chip(Rc<RefCell<(Vec<u8>, Bank)>>);

impl Chip {
    fn new(running: &[u8]) -> Self {
        let mut first = vec![0xFF; WAITING as usize];
        first[PROGRAM as usize..][..running.len()].copy_from_slice(running);
        Chip(Rc::new(RefCell::new((first, Bank::used()))))
    }

    /// The journal says this.
    fn with(state: State) -> Self {
        let mut chip = Chip::new(&package(3_000, BOARD_TYPE, 4));
        let mut journal = Journal::open(&mut chip, JOURNAL).expect("a journal");
        journal.write(&mut chip, state).expect("written");
        chip
    }

    fn journal(&self) -> State {
        let journal = Journal::open(&mut self.clone(), JOURNAL);
        journal.expect("a journal").state()
    }

    fn open(&self) -> Updater<Chip> {
        Updater::open(self.clone(), self.clone())
    }
}

impl ErrorType for Chip {
    type Error = Failed;
}

impl ReadNorFlash for Chip {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failed> {
        let (first, second) = &mut *self.0.borrow_mut();
        if offset >= WAITING {
            return second.read(offset, bytes);
        }
        bytes.copy_from_slice(&first[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        (0x0808_0000 - FLASH_BASE) as usize
    }
}

impl NorFlash for Chip {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failed> {
        assert!((JOURNAL..JOURNAL + JOURNAL_PAGES * PAGE_BYTES).contains(&from));
        self.0.borrow_mut().0[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failed> {
        let (first, second) = &mut *self.0.borrow_mut();
        if offset >= WAITING {
            return second.write(offset, bytes);
        }
        if !second.supplied {
            return Err(Failed);
        }
        first[offset as usize..][..bytes.len()].copy_from_slice(bytes);
        Ok(())
    }
}

impl BackgroundFlash for Chip {
    fn is_ready(&mut self) -> bool {
        self.0.borrow_mut().1.is_ready()
    }

    fn begin_erase(&mut self, offset: u32) {
        self.0.borrow_mut().1.begin_erase(offset);
    }
}

/// Line and task.
struct Board {
    tray: Tray,
    updater: Updater<Chip>,
}

impl Board {
    fn of(chip: &Chip) -> Self {
        let mut board = Board {
            tray: Tray::closed(),
            updater: chip.open(),
        };
        board.between_blocks();
        board
    }

    fn between_blocks(&mut self) {
        self.tray.set_open(self.updater.is_open());
        let portion = self.tray.portion();
        self.tray.follow(self.updater.step(portion.as_ref()));
    }

    /// All but what is still on its way.
    fn send(&mut self, package: &[u8]) {
        for (k, piece) in package.chunks(PIECE_BYTES).enumerate() {
            let offset = (k * PIECE_BYTES) as u32;
            let laid = (0..100).any(|_| {
                let laid = self.tray.lay(offset, piece).is_ok();
                if !laid {
                    self.between_blocks();
                }
                laid
            });
            assert!(laid, "{offset}");
        }
    }

    fn settle(&mut self) {
        (0..1_000).for_each(|_| self.between_blocks());
    }

    fn stands(&mut self) -> (UpdateState, Option<Refusal>, Option<News>) {
        let updater = &mut self.updater;
        (updater.state(), updater.refused(), updater.take_news())
    }
}

#[test]
fn a_program_is_received_checked_and_asked_for() {
    let chip = Chip::new(&package(3_000, BOARD_TYPE, 4));
    let mut board = Board::of(&chip);
    assert_eq!(board.stands(), (UpdateState::None, None, None));
    let package = package(9_000, BOARD_TYPE, 5);
    board.send(&package);
    assert_eq!(board.updater.state(), UpdateState::Receiving);
    // The last piece is not in flash yet.
    board.updater.install(None);
    assert_eq!(board.updater.state(), UpdateState::Checking);
    board.between_blocks();
    assert!(
        board.tray.lay(0, &[0; 8]).is_err(),
        "closed while it is checked"
    );
    board.settle();
    assert_eq!(board.updater.received() as usize, package.len());
    assert_eq!(board.stands(), (UpdateState::Asked, None, None));
    assert_eq!(chip.journal(), State::Idle);
    assert!(board.updater.ask(None));
    assert_eq!(chip.journal(), State::Requested);
    assert!(chip.0.borrow().1.bytes.starts_with(&package));
}

#[test]
fn what_is_not_whole_is_refused_and_may_be_completed() {
    let chip = Chip::new(&package(3_000, BOARD_TYPE, 4));
    let mut board = Board::of(&chip);
    let whole = package(3_000, BOARD_TYPE, 4);
    board.updater.install(None);
    board.settle();
    let refused = |refusal| {
        (
            UpdateState::Refused,
            Some(refusal),
            Some(News::Refused(refusal)),
        )
    };
    assert_eq!(board.stands(), refused(Refusal::Incomplete));
    board.send(&whole[..2_880]);
    board.updater.install(None);
    board.settle();
    assert_eq!(board.stands(), refused(Refusal::Incomplete));
    assert_eq!(board.tray.lay(2_880, &whole[2_880..]), Ok(()));
    board.updater.install(None);
    board.settle();
    assert_eq!(board.stands(), (UpdateState::Asked, None, None));
    let mut board = Board::of(&chip);
    board.send(&package(3_000, BOARD_TYPE, 3));
    board.updater.install(None);
    board.settle();
    assert_eq!(board.stands(), refused(Refusal::Older));
}

#[test]
fn what_is_in_the_way_refuses_before_the_check_and_behind_it() {
    let chip = Chip::new(&package(3_000, BOARD_TYPE, 4));
    let mut board = Board::of(&chip);
    board.send(&package(3_000, BOARD_TYPE, 5));
    board.updater.install(Some(Refusal::Learning));
    board.settle();
    assert_eq!(board.updater.refused(), Some(Refusal::Learning));
    board.updater.install(None);
    board.settle();
    assert_eq!(board.updater.state(), UpdateState::Asked);
    assert!(!board.updater.ask(Some(Refusal::Supply)));
    assert_eq!(board.stands().1, Some(Refusal::Supply));
    assert_eq!(chip.journal(), State::Idle);
}

#[test]
fn a_trial_that_the_loader_could_not_note_takes_no_pieces_either() {
    let chip = Chip::with(State::Installed { pages: 2 });
    let mut board = Board::of(&chip);
    assert_eq!(board.stands().0, UpdateState::OnTrial);
    assert!(board.tray.lay(0, &[0; 8]).is_err());
    board.updater.confirm();
    assert_eq!(chip.journal(), State::Confirmed);
}

#[test]
fn a_trial_takes_no_pieces_and_confirms_itself_after_a_quiet_minute() {
    let chip = Chip::with(State::OnTrial { pages: 2 });
    let before = chip.0.borrow().1.bytes.clone();
    let mut board = Board::of(&chip);
    assert_eq!(
        board.stands(),
        (UpdateState::OnTrial, None, Some(News::Installed))
    );
    assert!(
        board.tray.lay(0, &[0; 8]).is_err(),
        "the old program lies there"
    );
    board.updater.install(None);
    assert_eq!(
        board.stands(),
        (
            UpdateState::OnTrial,
            Some(Refusal::Trial),
            Some(News::Refused(Refusal::Trial))
        )
    );
    for _ in 0..59 {
        assert_eq!(board.updater.second(false), None);
    }
    assert_eq!(board.updater.second(true), None, "trouble");
    board.updater.disturb();
    assert_eq!(board.updater.seconds_left(), Some(60));
    for left in (1..60).rev() {
        assert_eq!(board.updater.second(false), None);
        assert_eq!(board.updater.seconds_left(), Some(left));
    }
    assert_eq!(board.updater.second(false), Some(Due::Confirm));
    assert_eq!(chip.journal(), State::OnTrial { pages: 2 });
    board.updater.confirm();
    assert_eq!(chip.journal(), State::Confirmed);
    assert_eq!(board.stands().2, Some(News::Confirmed));
    assert_eq!(board.updater.second(false), None);
    assert!(chip.0.borrow().1.bytes == before);
    board.between_blocks();
    assert_eq!(board.tray.lay(0, &[0; 8]), Ok(()));
}

#[test]
fn a_trial_full_of_trouble_is_given_up() {
    let mut board = Board::of(&Chip::with(State::OnTrial { pages: 2 }));
    for _ in 0..599 {
        assert_eq!(board.updater.second(true), None);
    }
    assert_eq!(board.updater.second(true), Some(Due::GiveUp));
}

#[test]
fn a_confirmation_that_flash_refuses_is_tried_again() {
    let chip = Chip::with(State::OnTrial { pages: 2 });
    let mut board = Board::of(&chip);
    chip.0.borrow_mut().1.supplied = false;
    board.updater.confirm();
    assert_eq!(chip.journal(), State::OnTrial { pages: 2 });
    assert_eq!(board.updater.seconds_left(), Some(60));
    chip.0.borrow_mut().1.supplied = true;
    board.updater.confirm();
    assert_eq!(chip.journal(), State::Confirmed);
}

#[test]
fn how_the_last_update_ended_is_told_once() {
    let told = |state| {
        let chip = Chip::with(state);
        let first = Board::of(&chip).stands();
        (first, Board::of(&chip).stands())
    };
    let nothing = (UpdateState::None, None, None);
    let brought_back = (UpdateState::BroughtBack, None, Some(News::BroughtBack));
    assert_eq!(told(State::Reverted), (brought_back, nothing));
    let news = Some(News::Refused(Refusal::Signature));
    let refused = (UpdateState::Refused, Some(Refusal::Signature), news);
    assert_eq!(told(State::Refused(Refusal::Signature)), (refused, nothing));
    let confirmed = (UpdateState::Confirmed, None, None);
    assert_eq!(told(State::Confirmed), (confirmed, confirmed));
}
