//! What a master does to the board meanwhile.

use board::modbus::{Command, Field};
use board::{Configuration, MotorImage};
use update::UpdateState;
use virtual_board::Cause;

use super::common::less_touchy;
use super::common::master::{CONFIRMED, Master, UNIT};
use super::common::packages::{installed, package, send, with_version};
use super::watch::Watch;

/// Seconds in a row without trouble after which a program is confirmed: shortly before, and from before to well behind it.
const TRIAL_S: u32 = 57;
const CONFIRMED_S: f64 = 8.0;
/// From the command until the board starts anew, s.
const LATEST_START_S: f64 = 10.0;

/// Motor constants are staged, committed and confirmed; then the power is switched off and on, as at commissioning.
pub fn bring_constants(watch: &mut Watch) {
    let master = Master::new(UNIT);
    let config = less_touchy();
    let wanted = Configuration::of("the same motor, less touchy", &MotorImage::new(&config));
    master.stage(&mut watch.board, &wanted);
    watch.look();
    // The samples do not tell when exactly the constants change.
    watch.ignore();
    master.command(&mut watch.board, Command::Commit as u16);
    master.command(&mut watch.board, Command::Confirm as u16);
    watch.run(0.2);
    let source = master.word(&mut watch.board, Field::Configuration);
    assert_eq!(source, CONFIRMED);
    watch.end();
    watch.board.reset(Cause::Power).expect("a reset");
    watch.judge_with(config);
    watch.start();
    println!("{:.0} s: new constants", watch.seconds());
}

/// Another version of the program comes over the line while the board judges, is installed, confirms itself, and stays when the
/// power fails.
pub fn bring_a_program(watch: &mut Watch) {
    let new = with_version(installed(&mut watch.board), "0.77.3");
    let busy = send(&mut watch.board, &package(&new));
    watch.look();
    let now = watch.seconds();
    println!(
        "{now:.0} s: {} bytes received, busy {busy} times",
        new.len()
    );
    install(watch);
    for _ in 0..TRIAL_S {
        watch.run(1.0);
        watch.look();
    }
    // Confirming writes to the program's own bank, and the samples do not tell when exactly they pause for it.
    watch.ignore();
    watch.run(CONFIRMED_S);
    let state = Master::new(UNIT).word(&mut watch.board, Field::Update);
    assert_eq!(state, UpdateState::Confirmed as u16);
    watch.end();
    watch.board.reset(Cause::Power).expect("a reset");
    watch.start();
    assert!(installed(&mut watch.board) == new);
    println!("{:.0} s: another version, confirmed", watch.seconds());
}

fn install(watch: &mut Watch) {
    let (resets, asked_s) = (watch.board.tally().resets, watch.seconds());
    Master::new(UNIT).command(&mut watch.board, Command::Install as u16);
    while watch.board.tally().resets == resets {
        watch.run(0.01);
        assert!(watch.seconds() < asked_s + LATEST_START_S, "no start");
    }
    watch.end();
    watch.start();
}
