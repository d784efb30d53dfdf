//! Rates that are wrong, a stack that is nearly full, and learning while the board doubts itself.

use super::*;

/// The trigger's last count: 499 at 80 MHz.
const TRIGGER_RELOAD: u32 = 0x4000_082C;
const WATCHDOG_KEY: u32 = 0x4000_3000;
const FEED: u32 = 0xAAAA;

#[test]
fn blocks_that_come_at_a_wrong_rate_are_found() {
    let mut board = running();
    // 5 % too slow: between two looks nothing else is late.
    board.poke(TRIGGER_RELOAD, 524).expect("a register");
    board.run(2.6).expect("a run");
    assert!(doubts(&mut board).has(Doubt::Blocks));
    assert!(board.lamps()[SENSOR] && board.lamps()[FAULT] && !board.relay());
}

#[test]
fn a_stack_that_is_nearly_full_is_told() {
    let mut board = running();
    // 16 of 20 KiB deep: nobody was there yet.
    let paint = board.word(RAM + 0x1000).expect("RAM");
    assert_eq!(paint, 0xCCCC_CCCC);
    board.poke(RAM + 0x1000, 0).expect("RAM");
    // The whole stack is looked through in ten seconds.
    assert_doubts(&mut board, 10.0, Doubt::Stack);
    let deepest = Master::new(UNIT).word(&mut board, Field::Stack);
    assert_eq!(deepest, 20 * 1024 - 0x1000);
}

#[test]
fn a_program_that_feeds_the_watchdog_in_a_tight_loop_is_ended() {
    let mut board = running();
    for _ in 0..2 {
        if board.tally().resets == 0 {
            board.poke(WATCHDOG_KEY, FEED).expect("a register");
            board.run(0.001).expect("a run");
        }
    }
    assert_starts_again(&mut board, 0.001, FaultCause::Watchdog);
}

#[test]
fn a_doubt_that_comes_while_learning_ends_it() {
    let mut board = running();
    let master = &mut Master::new(UNIT);
    master.command(&mut board, 2);
    board.run(0.2).expect("a run");
    assert_eq!(master.word(&mut board, Field::Learning), 1);
    board.short(Pin(1, 15), Some(true));
    board.run(0.2).expect("a run");
    assert_eq!(master.word(&mut board, Field::Learning), 24);
    // It does not go on by itself when the doubt has gone.
    board.short(Pin(1, 15), None);
    board.run(0.3).expect("a run");
    assert!(!doubts(&mut board).is_any());
    assert_eq!(master.word(&mut board, Field::Learning), 24);
}

#[test]
fn a_doubt_that_goes_and_comes_back_is_shown_again() {
    let mut board = running();
    let master = &mut Master::new(UNIT);
    for _ in 0..2 {
        board.short(Pin(1, 12), Some(true));
        assert_doubts(&mut board, 0.2, Doubt::Lamps);
        master.command(&mut board, 1);
        board.run(0.1).expect("a run");
        let blinks = (0..12).any(|_| {
            board.run(0.1).expect("a run");
            board.lamps()[SENSOR]
        });
        assert!(!blinks, "a person has seen it");
        board.short(Pin(1, 12), None);
        board.run(0.2).expect("a run");
        assert!(!doubts(&mut board).is_any());
    }
}
