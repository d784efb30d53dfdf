//! A program that comes over the board's line while it samples.

use board::modbus::{Command, Field, UNLOCK_KEY};
use board::{Event, EventCause};
use update::layout::{FLASH_BASE, WAITING};
use update::{Refusal, UpdateState, Version};

use super::common::master::{Master, UNIT, quicken};
use super::common::packages::{installed, offer, package, send, signed, with_version};
use super::common::{LAMP_TEST_S, board as board_of, logged, scenario};
use super::programs::{marking, state};
use super::{HEALTHY, MARK_AT, NEW_MARK, assert_installed, is_on_trial, settle};
use update::State;
use virtual_board::{Cause, VirtualBoard};

const MASTER: fn() -> Master = || Master::new(UNIT);

/// A board that judges its motor.
fn judging(seconds: f64) -> VirtualBoard {
    let mut board = board_of(&scenario(seconds));
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    board
}

fn told(board: &mut VirtualBoard) -> (u16, u16) {
    let registers = MASTER().registers(board);
    let word = |field| registers[usize::from(board::modbus::address(field))];
    (word(Field::Update), word(Field::UpdateRefused))
}

fn events(board: &mut VirtualBoard, cause: EventCause) -> Vec<Event> {
    let all = logged(board).into_iter();
    all.filter(|event| event.cause == cause).collect()
}

/// Seconds that the board has judged every window of.
struct Judged {
    windows: u32,
    instants: usize,
}

impl Judged {
    fn so_far(board: &mut VirtualBoard) -> Self {
        Judged {
            windows: MASTER().long(board, Field::WindowsJudged),
            instants: board.taken().len(),
        }
    }

    /// A window is a cycle of the supply of 60 Hz; a gap would cost several.
    fn assert_no_sample_lost(&self, board: &mut VirtualBoard) {
        let now = Judged::so_far(board);
        let (windows, instants) = (now.windows - self.windows, now.instants - self.instants);
        let expected = instants as f64 * 60.0 / 10_000.0;
        // What was published lies up to two windows behind.
        assert!(
            (f64::from(windows) - expected).abs() < 3.0,
            "{windows} of {expected}"
        );
        assert_eq!(events(board, EventCause::SamplesMissing), []);
        assert_eq!(board.lamps(), HEALTHY);
    }
}

/// Command 9, then what the board and its loader make of it.
fn install(board: &mut VirtualBoard) -> State {
    let resets = board.tally().resets;
    MASTER().command(board, Command::Install as u16);
    for _ in 0..400 {
        board.run(0.02).expect("a run");
        if board.tally().resets > resets {
            return settle(board);
        }
    }
    panic!("no start: {:?}", told(board));
}

#[test]
fn a_program_comes_over_the_line_without_a_lost_sample_and_runs() {
    let mut board = judging(60.0);
    let old = installed(&mut board);
    let new = marking(7_300, "99.0.0", NEW_MARK);
    let package = package(&new);
    assert_eq!(offer(&mut board, 0, &package[..240]), 1, "locked");
    let judged = Judged::so_far(&mut board);
    send(&mut board, &package);
    judged.assert_no_sample_lost(&mut board);
    assert_eq!(told(&mut board), (UpdateState::Receiving as u16, 0));
    let received = MASTER().long(&mut board, Field::UpdateBytes) as usize;
    assert_eq!(received, package.len());
    let waits = board
        .read_flash(FLASH_BASE + WAITING, package.len())
        .expect("flash");
    assert!(waits == package);
    assert!(is_on_trial(install(&mut board)));
    assert_installed(&mut board, &new, "after the exchange");
    assert_eq!(board.word(MARK_AT).expect("RAM"), NEW_MARK);
    // It knows nothing of trials, so the next start brings the old one back, which says so once.
    board.reset(Cause::Power).expect("a reset");
    assert_eq!(settle(&mut board), State::Reverted);
    assert_installed(&mut board, &old, "after the trial");
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(told(&mut board).0, UpdateState::BroughtBack as u16);
    assert_eq!(events(&mut board, EventCause::UpdateReverted).len(), 1);
    board.reset(Cause::Power).expect("a reset");
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(told(&mut board).0, UpdateState::None as u16);
    assert_eq!(events(&mut board, EventCause::UpdateReverted).len(), 1);
}

#[test]
fn the_firmware_receives_another_version_of_itself_which_confirms_itself() {
    let mut board = judging(240.0);
    quicken(&mut board);
    let new = with_version(installed(&mut board), "0.77.3");
    let judged = Judged::so_far(&mut board);
    let busy = send(&mut board, &package(&new));
    judged.assert_no_sample_lost(&mut board);
    println!("{} bytes, busy {busy} times", new.len());
    assert!(is_on_trial(install(&mut board)));
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(told(&mut board), (UpdateState::OnTrial as u16, 0));
    assert_eq!(events(&mut board, EventCause::UpdateInstalled).len(), 1);
    // Where the old program waits nothing is written.
    assert!(MASTER().write(&mut board, 0, UNLOCK_KEY));
    assert_eq!(offer(&mut board, 0, &[0; 240]), 6);
    MASTER().command(&mut board, Command::Install as u16);
    board.run(0.1).expect("a run");
    let refused = Refusal::Trial as u16;
    assert_eq!(told(&mut board), (UpdateState::OnTrial as u16, refused));
    board.run(62.0).expect("a run");
    assert_eq!(told(&mut board).0, UpdateState::Confirmed as u16);
    assert_eq!(state(&mut board), State::Confirmed);
    assert_eq!(events(&mut board, EventCause::UpdateConfirmed).len(), 1);
    assert_eq!(events(&mut board, EventCause::SamplesMissing), []);
    board.reset(Cause::Power).expect("a reset");
    assert_eq!(settle(&mut board), State::Confirmed);
    assert_installed(&mut board, &new, "after the trial");
}

#[test]
fn what_is_not_taken_is_told_with_its_reason() {
    let mut board = judging(120.0);
    let refused = |refusal: Refusal| (UpdateState::Refused as u16, refusal as u16);
    MASTER().command(&mut board, Command::Install as u16);
    board.run(0.2).expect("a run");
    assert_eq!(
        told(&mut board),
        refused(Refusal::Incomplete),
        "nothing was sent"
    );
    let old = package(&marking(1_200, "0.0.9", NEW_MARK));
    send(&mut board, &old);
    MASTER().command(&mut board, Command::Install as u16);
    board.run(0.5).expect("a run");
    assert_eq!(told(&mut board), refused(Refusal::Older));
    assert_eq!(board.tally().resets, 0);
    let foreign = signed(&marking(1_200, "99.0.0", NEW_MARK), [7; 32]);
    send(&mut board, &foreign);
    assert_eq!(told(&mut board), (UpdateState::Receiving as u16, 0));
    MASTER().command(&mut board, Command::Learn as u16);
    board.run(0.2).expect("a run");
    MASTER().command(&mut board, Command::Install as u16);
    board.run(0.2).expect("a run");
    assert_eq!(told(&mut board), refused(Refusal::Learning));
    // Learning ends with the power.
    board.reset(Cause::Power).expect("a reset");
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    send(&mut board, &foreign);
    assert_eq!(install(&mut board), State::Refused(Refusal::Signature));
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(told(&mut board), refused(Refusal::Signature));
    let causes = events(&mut board, EventCause::UpdateRefused);
    let last = causes.last().expect("an event");
    assert_eq!(last.values, [Refusal::Signature as u32, 0]);
    let version = MASTER().long(&mut board, Field::ProgramVersion);
    assert_eq!(version, Version::parse(env!("CARGO_PKG_VERSION")).0);
}
