//! An hour of emulated time, or as many seconds as ENDURANCE_S says, of what a board lives through: the load doubles, the motor
//! heats, the mains sink; its own supply dips, its constants are replaced over the line, then its program. Nothing is missed,
//! drifts or grows, FAULT is lit while there is a fault and at no other time, and every frame is the host's, bit for bit.

#[path = "../common/mod.rs"]
mod common;
mod line;
mod outside;
mod session;
mod watch;

use common::board as board_of;
use line::{bring_a_program, bring_constants};
use outside::lived_through;
use watch::Watch;

/// Long enough for every ordinary run of the tests; an hour is asked for by ENDURANCE_S=3600.
const DEFAULT_S: u32 = 60;
/// Where a program comes over the line in some five minutes, runs on trial for one, and is judged afterwards.
const LONG_S: u32 = 900;
/// What the supervisor of the board's supply sees while it dips, mV, and for how long, s.
const DIP_MILLIVOLT: u32 = 2_500;
const DIP_S: f64 = 0.4;
/// Until everything that happens now and then has happened on the stack too, s.
const WARM_S: u32 = 5;

#[test]
fn nothing_is_missed_drifts_or_grows() {
    let asked = std::env::var("ENDURANCE_S").ok();
    let seconds: u32 = asked
        .and_then(|text| text.parse().ok())
        .unwrap_or(DEFAULT_S);
    let mut watch = Watch::new(board_of(&lived_through(f64::from(seconds) + 500.0)));
    watch.start();
    pass(&mut watch, seconds / 4);
    bring_constants(&mut watch);
    pass(&mut watch, seconds / 2);
    dip_of_the_boards_supply(&mut watch);
    if seconds >= LONG_S {
        bring_a_program(&mut watch);
    }
    let warm = watch.seconds() as u32 + WARM_S;
    pass(&mut watch, warm);
    let stack = watch.stack();
    pass(&mut watch, seconds.max(warm + WARM_S));
    assert_eq!(watch.stack(), stack, "the stack grows");
    watch.assert_whole();
    println!("{}; {stack} bytes of stack", watch.summary());
}

/// Lets the board judge until so many seconds of emulated time have passed.
fn pass(watch: &mut Watch, until_s: u32) {
    while watch.seconds() < f64::from(until_s) {
        watch.run(1.0);
        watch.look();
        for line in watch.board.log() {
            println!("{:.0} s: {line}", watch.seconds());
        }
        let now = watch.seconds() as u32;
        if now.is_multiple_of(300) {
            println!("{now} s of {until_s} s");
        }
    }
}

/// Nothing can be written to flash meanwhile; the motor is judged all the same.
fn dip_of_the_boards_supply(watch: &mut Watch) {
    watch.board.set_detector_sees(Some(DIP_MILLIVOLT));
    watch.run(DIP_S);
    watch.look();
    watch.board.set_detector_sees(None);
    println!("{:.0} s: the supply dipped", watch.seconds());
}
