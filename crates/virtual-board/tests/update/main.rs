//! The loader on the board: a new program that waits, its trial, the way back, and power that fails anywhere between.

#[path = "../common/mod.rs"]
mod common;
mod line;
mod programs;

use board::modbus::Field;
use common::master::{Master, UNIT};
use common::packages::{area, installed, package, signed, with_version};
use common::{LAMP_TEST_S, board as board_of, firmware, scenario};
use programs::{Still, install, marking, request, state, with_board, write_journal};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use update::{Refusal, Seal, State};
use virtual_board::{Cause, TICK_HZ, VirtualBoard};

const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
/// SENSOR and FAULT alone.
const NO_PROGRAM: [bool; 9] = [false, false, false, false, false, true, false, false, true];
/// Where a program of `marking` leaves its mark.
const MARK_AT: u32 = 0x2000_0000;
const OLD_MARK: u32 = 0x01D0;
const NEW_MARK: u32 = 0x0EF7;
/// Longer than any exchange takes.
const LONGEST_S: f64 = 60.0;
/// Steps of flash that copying a page takes: an erasure, 512 words, and two of the journal.
const COPY_STEPS: u32 = 515;

/// A board with a program in the place of the firmware.
fn board_with(program: &[u8]) -> VirtualBoard {
    let mut board = VirtualBoard::new(&firmware(), Box::new(Still)).expect("a firmware");
    install(&mut board, program);
    board
}

/// Runs until the loader has nothing more to do.
fn settle(board: &mut VirtualBoard) -> State {
    for _ in 0..(LONGEST_S / 0.02) as u32 {
        board.run(0.02).expect("a run");
        match state(board) {
            State::Requested
            | State::Exchanging { .. }
            | State::Installed { .. }
            | State::Reverting { .. } => {}
            settled => {
                board.run(0.05).expect("a run");
                return settled;
            }
        }
    }
    panic!("stuck: {:?}", state(board));
}

/// These bytes and no others are the program's.
fn assert_installed(board: &mut VirtualBoard, program: &[u8], what: &str) {
    let area = area(board);
    let differs = area.iter().zip(program).position(|(is, was)| is != was);
    assert_eq!(differs, None, "{what}: the first byte that differs");
}

/// What the journal says, which program lies in its place and which one runs fit each other.
fn assert_one_of(board: &mut VirtualBoard, [old, new]: [&[u8]; 2], what: &str) -> State {
    let state = settle(board);
    let mark = board.word(MARK_AT).expect("RAM");
    match state {
        State::OnTrial { .. } | State::Confirmed => {
            assert_installed(board, new, what);
            assert_eq!(mark, NEW_MARK, "{what}: the new one runs");
        }
        _ => {
            assert_installed(board, old, what);
            assert_eq!(mark, OLD_MARK, "{what}: the old one runs");
        }
    }
    state
}

/// The new program does, before it confirms itself.
fn is_on_trial(state: State) -> bool {
    matches!(state, State::OnTrial { .. })
}

#[test]
fn without_a_request_the_firmware_starts_and_nothing_in_flash_changes() {
    let mut board = board_of(&scenario(10.0));
    let before = board.read_flash(0x0800_0000, 0x4_0000).expect("flash");
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    let after = board.read_flash(0x0800_0000, 0x4_0000).expect("flash");
    assert!(before == after && board.tally().resets == 0);
}

#[test]
fn a_new_firmware_runs_and_without_a_confirmation_the_old_one_comes_back() {
    let mut board = board_of(&scenario(60.0));
    let old = installed(&mut board);
    let new = with_version(old.clone(), "0.77.0");
    request(&mut board, &package(&new));
    assert!(is_on_trial(settle(&mut board)));
    assert_installed(&mut board, &new, "after the exchange");
    assert_firmware_runs(&mut board, &new);
    board.reset(Cause::Watchdog).expect("a reset");
    assert_eq!(settle(&mut board), State::Reverted);
    assert_installed(&mut board, &old, "after the way back");
    assert_firmware_runs(&mut board, &old);
    assert_eq!(board.tally().resets, 1, "it waits for nobody");
}

/// Healthy lamps, and the checksum that a master reads is this program's.
fn assert_firmware_runs(board: &mut VirtualBoard, program: &[u8]) {
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    let seal = Seal::read(program).expect("a sealed program");
    let told = Master::new(UNIT).long(board, Field::ProgramChecksum);
    assert_eq!(told, seal.checksum);
}

#[test]
fn a_program_that_confirmed_itself_stays() {
    let [old, new] = [
        marking(5_000, "1.0.0", OLD_MARK),
        marking(7_300, "1.0.0", NEW_MARK),
    ];
    let mut board = board_with(&old);
    request(&mut board, &package(&new));
    assert!(is_on_trial(assert_one_of(
        &mut board,
        [&old, &new],
        "trial"
    )));
    write_journal(&mut board, State::Confirmed);
    for cause in [Cause::Power, Cause::Watchdog, Cause::Software] {
        board.reset(cause).expect("a reset");
        let state = assert_one_of(&mut board, [&old, &new], "confirmed");
        assert_eq!(state, State::Confirmed);
    }
}

#[test]
fn what_may_not_run_is_refused_with_its_reason_and_the_old_program_runs() {
    let old = marking(5_000, "1.1.0", OLD_MARK);
    let new = marking(7_300, "1.1.0", NEW_MARK);
    let whole = package(&new);
    let older = package(&with_version(new.clone(), "1.0.9"));
    let other_board = package(&with_board(new.clone(), 0x444D_0002));
    let damaged = [&whole[..6_000], &[whole[6_000] ^ 8], &whole[6_001..]].concat();
    let cases = [
        (signed(&new, [3; 32]), Refusal::Signature),
        (older, Refusal::Older),
        (other_board, Refusal::Board),
        (damaged, Refusal::Checksum),
        (whole[..5_000].to_vec(), Refusal::Checksum),
        (new.clone(), Refusal::Signature),
        (whole[1..].to_vec(), Refusal::NoProgram),
        (Vec::new(), Refusal::NoProgram),
    ];
    for (package, refusal) in cases {
        let mut board = board_with(&old);
        request(&mut board, &package);
        let state = assert_one_of(&mut board, [&old, &new], refusal.label());
        assert_eq!(state, State::Refused(refusal));
        assert_eq!(board.tally().resets, 0, "{refusal}");
    }
}

#[test]
fn a_board_without_a_program_lights_sensor_and_fault_and_waits() {
    let mut board = board_with(&[]);
    board.run(3.0).expect("a run");
    assert_eq!(board.lamps(), NO_PROGRAM);
    assert_eq!(board.tally().resets, 0, "the watchdog is fed");
}

#[test]
fn nothing_is_erased_while_the_supply_is_low_and_the_exchange_goes_on_afterwards() {
    let [old, new] = [
        marking(5_000, "1.0.0", OLD_MARK),
        marking(7_300, "1.0.0", NEW_MARK),
    ];
    let mut board = board_with(&old);
    request(&mut board, &package(&new));
    board.set_detector_sees(Some(2_500));
    board.run(2.0).expect("a run");
    assert_installed(&mut board, &old, "while the supply is low");
    assert_eq!(state(&mut board), State::Requested);
    board.set_detector_sees(None);
    board.reset(Cause::Power).expect("a reset");
    while !matches!(state(&mut board), State::Exchanging { step: 3, .. }) {
        board.run(0.001).expect("a run");
    }
    board.set_detector_sees(Some(2_500));
    board.run(1.0).expect("a run");
    let halfway = area(&mut board);
    board.run(1.0).expect("a run");
    assert!(area(&mut board) == halfway, "nothing is written");
    board.set_detector_sees(None);
    assert!(is_on_trial(assert_one_of(
        &mut board,
        [&old, &new],
        "after"
    )));
}

/// Where power fails: anywhere, and at each word of the journal of some copies.
fn cuts(steps: u32, anywhere: usize, seed: u64) -> Vec<u32> {
    let mut random = Pcg32::seed_from_u64(seed);
    let within = (0..anywhere).map(|_| random.random_range(0..steps));
    let journal = (0..steps / COPY_STEPS).step_by(3);
    let journal = journal.flat_map(|copy| (0..4).map(move |k| copy * COPY_STEPS + k));
    within.chain(journal).chain(steps - 4..steps).collect()
}

/// Steps of flash of an exchange of so many pages: the first state, the copies, the last two states.
fn steps_of(pages: u32) -> u32 {
    2 + 2 * pages * COPY_STEPS + 4
}

const CAUSES: [Cause; 2] = [Cause::Power, Cause::Watchdog];

#[test]
fn power_that_fails_within_the_exchange_leaves_the_old_or_the_new_program() {
    let [old, new] = [
        marking(7_300, "1.0.0", OLD_MARK),
        marking(5_000, "1.0.0", NEW_MARK),
    ];
    let package = package(&new);
    for (k, step) in cuts(steps_of(4), 24, 1).into_iter().enumerate() {
        let mut board = board_with(&old);
        request(&mut board, &package);
        board.reset_within_flash_step(step, CAUSES[k % 2]);
        let what = format!("cut at step {step}");
        assert_one_of(&mut board, [&old, &new], &what);
        assert_eq!(board.tally().resets, 1, "{what}");
        board.reset(Cause::Software).expect("a reset");
        let state = assert_one_of(&mut board, [&old, &new], &what);
        assert_eq!(state, State::Reverted, "{what}: after the trial");
    }
}

#[test]
fn power_that_fails_on_the_way_back_leaves_the_old_program() {
    let [old, new] = [
        marking(5_000, "1.0.0", OLD_MARK),
        marking(7_300, "1.0.0", NEW_MARK),
    ];
    let mut board = board_with(&old);
    request(&mut board, &package(&new));
    assert!(is_on_trial(settle(&mut board)));
    let trial = board.snapshot().expect("a snapshot");
    for (k, step) in cuts(steps_of(4) - 2, 24, 2).into_iter().enumerate() {
        board.restore(&trial).expect("a snapshot");
        board.reset(CAUSES[k % 2]).expect("a reset");
        board.reset_within_flash_step(step, CAUSES[k / 2 % 2]);
        let what = format!("cut at step {step}");
        let state = assert_one_of(&mut board, [&old, &new], &what);
        assert_eq!(state, State::Reverted, "{what}");
        assert_eq!(board.tally().resets, 2, "{what}");
    }
}

#[test]
fn power_that_fails_again_and_again_leaves_the_old_or_the_new_program() {
    let [old, new] = [
        marking(5_000, "1.0.0", OLD_MARK),
        marking(7_300, "1.0.0", NEW_MARK),
    ];
    let package = package(&new);
    for seed in 0..4 {
        let mut random = Pcg32::seed_from_u64(seed);
        let mut board = board_with(&old);
        request(&mut board, &package);
        for cut in 0..12 {
            board.reset_within_flash_step(random.random_range(0..900), CAUSES[cut % 2]);
            let before = board.tally().resets;
            for _ in 0..100 {
                board.run(0.02).expect("a run");
                if board.tally().resets > before {
                    break;
                }
            }
        }
        assert_one_of(&mut board, [&old, &new], &format!("seed {seed}"));
    }
}

/// The firmware for a program of the whole place, and power that fails somewhere on both ways.
#[test]
fn programs_of_full_length_change_places_whatever_happens() {
    let mut board = board_of(&scenario(10.0));
    let firmware = installed(&mut board);
    let full = marking(108 * 2_048, "99.0.0", NEW_MARK);
    let mut random = Pcg32::seed_from_u64(5);
    for _ in 0..3 {
        let [forth, back] = [(); 2].map(|()| random.random_range(0..steps_of(108) - 4));
        let mut board = board_with(&firmware);
        request(&mut board, &package(&full));
        board.reset_within_flash_step(forth, Cause::Power);
        assert!(is_on_trial(settle(&mut board)), "cut at step {forth}");
        assert_installed(&mut board, &full, "the new one");
        board.reset(Cause::Software).expect("a reset");
        board.reset_within_flash_step(back, Cause::Power);
        assert_eq!(settle(&mut board), State::Reverted, "cut at step {back}");
        assert_installed(&mut board, &firmware, "the old one");
    }
}

/// Instructions and seconds until the journal says so.
fn cost(board: &mut VirtualBoard, is_over: impl Fn(State) -> bool) -> (u64, f64) {
    let before = board.tally();
    for _ in 0..(LONGEST_S / 0.005) as u32 {
        if is_over(state(board)) {
            break;
        }
        board.run(0.005).expect("a run");
    }
    assert!(is_over(state(board)), "stuck: {:?}", state(board));
    let after = board.tally();
    let seconds = (after.ticks - before.ticks) as f64 / TICK_HZ as f64;
    (after.instructions - before.instructions, seconds)
}

#[test]
fn checking_and_exchanging_take_this_long() {
    let mut board = board_of(&scenario(10.0));
    let firmware = installed(&mut board);
    let full = marking(108 * 2_048, "99.0.0", NEW_MARK);
    for (name, program) in [("the firmware", firmware.clone()), ("108 pages", full)] {
        let mut damaged = package(&program);
        damaged[0x300] ^= 1;
        let mut board = board_with(&firmware);
        request(&mut board, &damaged);
        let (checksum, _) = cost(&mut board, |state| state != State::Requested);
        let mut board = board_with(&firmware);
        request(&mut board, &package(&program));
        let (all, seconds) = cost(&mut board, |state| state != State::Requested);
        let (_, exchange) = cost(&mut board, is_on_trial);
        let million = |instructions: u64| instructions as f64 / 1e6;
        println!(
            "{name}, {} bytes: checksum and start {:.2} million instructions, signature {:.2} million, both {seconds:.2} s; \
             exchange {exchange:.1} s",
            program.len(),
            million(checksum),
            million(all - checksum),
        );
        assert!(seconds < 10.0 && exchange < 15.0, "{name}");
    }
}
