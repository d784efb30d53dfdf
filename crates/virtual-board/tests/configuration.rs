//! A configuration from the line: judged with as on the host, given up after a minute, whole or not there whatever cuts its
//! storing off.

mod common;

use board::modbus::{Command, Field, UNLOCK_KEY};
use board::{Configuration, Frame, Line, LineParity, MotorImage, Refused, STAGED, Shown, TRIAL_S};
use common::master::{CONFIRMED, Master, UNIT};
use common::{INHIBITED, LAMP_TEST_S, board as board_of, board_to_restore, less_touchy, scenario};
use monitor::{Monitor, MonitorConfig, MonitorState};
use motor::MotorFile;
use virtual_board::{Cause, VirtualBoard};

const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
/// Register `Configuration`.
const COMPILED_IN: u16 = 0;
const TRIAL: u16 = 2;

fn running() -> VirtualBoard {
    let mut board = board_of(&scenario(200.0));
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    board
}

fn configuration() -> Configuration {
    Configuration::of(
        "the same motor, less touchy",
        &MotorImage::new(&less_touchy()),
    )
}

fn source(master: &Master, board: &mut VirtualBoard) -> u16 {
    master.word(board, Field::Configuration)
}

#[test]
fn a_configured_board_judges_bit_for_bit_as_the_host_does_with_that_motor() {
    let (mut board, master) = (running(), Master::new(UNIT));
    master.stage(&mut board, &configuration());
    assert_eq!(source(&master, &mut board), COMPILED_IN, "not yet");
    master.command(&mut board, Command::Commit as u16);
    assert_eq!(source(&master, &mut board), TRIAL);
    master.command(&mut board, Command::Confirm as u16);
    board.run(0.2).expect("a run");
    assert_eq!(source(&master, &mut board), CONFIRMED);
    let identification = master.long(&mut board, Field::MotorIdentification);
    assert_eq!(identification, configuration().identification());
    board.reset(Cause::Power).expect("a reset");
    let before = board.taken().len();
    board.run(LAMP_TEST_S).expect("a lamp test");
    board.frames();
    // What a debugger does not read in time is dropped.
    let mut bytes = Vec::new();
    for _ in 0..10 {
        board.run(0.1).expect("a run");
        bytes.extend(board.frames());
    }
    let seen: Vec<Frame> = bytes
        .split_inclusive(|byte| *byte == 0)
        .map(|bytes| Frame::decode(bytes).expect("an undamaged frame"))
        .collect();
    let monitor = Monitor::new(less_touchy()).expect("a valid configuration");
    let mut state = MonitorState::default();
    let taken = board.taken()[before..].iter().skip(INHIBITED);
    let reports = taken.filter_map(|raw| monitor.update_raw(&mut state, raw));
    let expected: Vec<Frame> = reports
        .zip(&seen)
        .map(|(report, frame)| {
            let shown = Shown::only(report.lamps);
            Frame::new(&report, &shown, frame.sequence, frame.vdda_millivolt)
        })
        .collect();
    // 60 a second, but for the blocks that are thrown away at first and the first window.
    assert!(seen.len() > 35, "{}", seen.len());
    assert_eq!(seen, expected);
    assert_eq!(board.lamps(), HEALTHY);
}

#[test]
fn a_refused_configuration_changes_nothing_and_names_what_is_wrong() {
    let (mut board, master) = (running(), Master::new(UNIT));
    let mut damaged = configuration();
    damaged.words_mut()[100] ^= 1 << 9;
    master.stage(&mut board, &damaged);
    master.command(&mut board, Command::Commit as u16);
    let refused = master.word(&mut board, Field::ConfigurationRefused);
    assert_eq!(refused, Refused::Checksum as u16);
    assert_eq!(source(&master, &mut board), COMPILED_IN);
    let before = board.taken().len();
    board.run(0.5).expect("a run");
    assert!(board.taken().len() - before > 4_900, "no sample is lost");
    assert_eq!(board.lamps(), HEALTHY);
    // What is not refused any more is taken.
    master.stage(&mut board, &configuration());
    master.command(&mut board, Command::Commit as u16);
    assert_eq!(source(&master, &mut board), TRIAL);
    assert_eq!(master.word(&mut board, Field::ConfigurationRefused), 0);
}

/// Samples that a board takes while a master's command is obeyed, and in the second after it; why it was refused.
fn taken_beside(command: Command) -> (usize, u16) {
    let (mut board, master) = (running(), Master::new(UNIT));
    let before = board.taken().len();
    master.command(&mut board, command as u16);
    let refused = master.word(&mut board, Field::ConfigurationRefused);
    board.run(1.0).expect("a run");
    assert_eq!(source(&master, &mut board), COMPILED_IN);
    assert_eq!(board.lamps(), HEALTHY);
    (board.taken().len() - before, refused)
}

#[test]
fn a_confirmation_without_a_trial_is_refused_and_no_sample_is_lost() {
    let (taken, refused) = taken_beside(Command::Confirm);
    assert_eq!(refused, Refused::NoTrial as u16);
    // There is nothing to discard either: a command that changes nothing.
    let (undisturbed, not_refused) = taken_beside(Command::Discard);
    assert_eq!(not_refused, 0);
    assert_eq!(taken, undisturbed);
}

#[test]
fn a_line_that_nobody_can_reach_is_given_up_after_a_minute() {
    let (mut board, master) = (running(), Master::new(UNIT));
    let mut elsewhere = configuration();
    elsewhere.set_line(Line {
        unit: 200,
        baud: 115_200,
        parity: LineParity::None,
    });
    master.stage(&mut board, &elsewhere);
    master.command(&mut board, Command::Commit as u16);
    board.run(0.1).expect("a run");
    assert!(!master.is_answered(&mut board), "at the old address");
    assert!(Master::new(200).is_answered(&mut board), "at the new one");
    board.run(f64::from(TRIAL_S) - 5.0).expect("a run");
    assert!(!master.is_answered(&mut board), "not yet");
    board.run(8.0).expect("a run");
    assert!(master.is_answered(&mut board), "it is back");
    assert_eq!(source(&master, &mut board), COMPILED_IN);
    assert_eq!((board.lamps(), board.tally().resets), (HEALTHY, 0));
}

#[test]
fn a_button_held_while_power_returns_gives_back_the_line_of_a_new_board() {
    let (mut board, master) = (running(), Master::new(UNIT));
    let mut elsewhere = configuration();
    elsewhere.set_line(Line {
        unit: 9,
        ..Line::default()
    });
    master.stage(&mut board, &elsewhere);
    master.command(&mut board, Command::Commit as u16);
    board.run(0.1).expect("a run");
    Master::new(9).command(&mut board, Command::Confirm as u16);
    board.run(0.2).expect("a run");
    for (held, unit) in [(false, 9), (true, UNIT)] {
        board.press(held);
        board.reset(Cause::Power).expect("a reset");
        board.run(LAMP_TEST_S + 0.3).expect("a run");
        board.press(false);
        board.run(0.5).expect("a run");
        assert!(Master::new(unit).is_answered(&mut board), "held: {held}");
        assert_eq!(source(&Master::new(unit), &mut board), CONFIRMED);
    }
}

#[test]
fn each_of_the_247_addresses_can_be_configured_and_no_other_answers_then() {
    let mut board = board_of(&scenario(400.0));
    board.forget_taken();
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    let mut at = UNIT;
    for unit in (1..=247).rev() {
        let master = Master::new(at);
        let mut wanted = configuration();
        wanted.set_line(Line {
            unit,
            ..Line::default()
        });
        let choices: Vec<u16> = wanted.registers().skip(2).take(2).collect();
        assert!(master.write_block(&mut board, STAGED + 2, &choices));
        master.command(&mut board, Command::Commit as u16);
        if at != unit {
            assert!(!master.is_answered(&mut board), "still at {at}");
        }
        assert_eq!(source(&Master::new(unit), &mut board), TRIAL, "at {unit}");
        at = unit;
    }
    Master::new(at).command(&mut board, Command::Confirm as u16);
    board.run(0.2).expect("a run");
    assert_eq!(source(&Master::new(at), &mut board), CONFIRMED);
    assert_eq!((board.lamps(), board.tally().resets), (HEALTHY, 0));
}

/// Words of a record, and the page that is erased before.
const STEPS: u32 = 8 * (board::CONFIGURATION_WORDS as u32 + 3).div_ceil(8) + 1;

#[test]
fn power_that_fails_at_any_step_of_storing_leaves_the_old_or_the_new() {
    let (mut board, master) = (board_to_restore(&scenario(200.0)), Master::new(UNIT));
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    let mut old = configuration();
    old.set_motor("the old one", &MotorImage::new(&less_touchy()));
    // Nothing else is to be written to flash while the power is cut: events of the same cause wait for a minute.
    for configuration in [&configuration(), &old] {
        master.stage(&mut board, configuration);
        master.command(&mut board, Command::Commit as u16);
        master.command(&mut board, Command::Confirm as u16);
        board.run(0.3).expect("a run");
        assert_eq!(source(&master, &mut board), CONFIRMED);
    }
    let mut new = old.clone();
    new.set_motor("the new one", &MotorImage::new(&less_touchy()));
    master.stage(&mut board, &new);
    master.command(&mut board, Command::Commit as u16);
    let name = |board: &mut VirtualBoard| {
        let words = master.holding(board, board::ACTIVE, 2 * 19);
        let mut read = Configuration::BLANK;
        for (at, word) in (0..).zip(words) {
            read.set_register(at, word);
        }
        read.name().text().expect("text").to_owned()
    };
    let before = board.snapshot().expect("a snapshot");
    let (mut olds, mut news) = (0, 0);
    for step in (0..=STEPS).step_by(16).chain([1, 2, STEPS - 1, STEPS]) {
        board.restore(&before).expect("a snapshot of this board");
        let resets = board.tally().resets;
        let cause = [Cause::Watchdog, Cause::Power][(step / 16) as usize % 2];
        board.reset_within_flash_step(step, cause);
        assert!(master.write(&mut board, 0, UNLOCK_KEY));
        // The power may be cut off before the answer.
        let _ = master.write(&mut board, 1, Command::Confirm as u16);
        board.run(0.2).expect("a run");
        let cut = board.tally().resets - resets;
        assert_eq!(cut, u64::from(step < STEPS), "step {step} of {STEPS}");
        if cut == 0 {
            board.reset(Cause::Power).expect("a reset");
        }
        board.run(LAMP_TEST_S + 0.8).expect("a run");
        assert_eq!(board.lamps(), HEALTHY, "step {step}");
        match name(&mut board).as_str() {
            "the old one" => olds += 1,
            "the new one" => news += 1,
            other => panic!("step {step}: {other}"),
        }
    }
    println!("{olds} times the old configuration, {news} times the new one");
    assert!(news >= 1 && olds >= STEPS / 16, "{olds} {news}");
}

#[test]
fn another_motor_of_the_library_of_files_fits_in() {
    let (mut board, master) = (running(), Master::new(UNIT));
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../motors");
    let files = std::fs::read_dir(folder).expect("the shipped motors");
    let mut taken = 0;
    for file in files {
        let path = file.expect("a file").path();
        let Ok(file) = MotorFile::read(&path) else {
            continue;
        };
        let Ok(config) = MonitorConfig::of_board(&file) else {
            continue;
        };
        let wanted = Configuration::of(&file.name, &MotorImage::new(&config));
        master.stage(&mut board, &wanted);
        master.command(&mut board, Command::Commit as u16);
        let refused = master.word(&mut board, Field::ConfigurationRefused);
        assert_eq!(refused, 0, "{}", path.display());
        let identification = master.long(&mut board, Field::MotorIdentification);
        assert_eq!(
            identification,
            wanted.identification(),
            "{}",
            path.display()
        );
        taken += 1;
    }
    assert!(taken >= 5, "{taken} motors");
    assert_eq!(board.tally().resets, 0);
    master.command(&mut board, Command::Confirm as u16);
    board.run(0.3).expect("a run");
    let stack = board.stack_used().expect("a stack");
    println!("{stack} bytes of stack");
    // Beyond three quarters of its room the board doubts itself.
    assert!(stack < 15 * 1_024, "{stack}");
}
