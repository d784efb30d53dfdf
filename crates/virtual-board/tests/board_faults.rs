//! Faults of the board itself: each is handled, and each test fails when the handling is removed.

mod common;

use board::modbus::Field;
use common::master::{Master, UNIT};
use common::{LAMP_TEST_S, Sensors, board, firmware, host_lamps, scenario, watch};
use monitor::RawSample;
use motor::motor_file::Frame as MotorFrame;
use scenario::Load;
use scenario::{Fault, Start};
use virtual_board::{Cause, Inputs, VirtualBoard};

const RUN: usize = 0;
const SENSOR: usize = 5;
const FAULT: usize = 8;
const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];

/// A board that has judged a healthy motor for a while.
fn running() -> VirtualBoard {
    let mut board = board(&scenario(60.0));
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY, "before the fault");
    board
}

/// Sensors of which one signal is falsified.
struct Falsified<F>(Sensors, F);

impl<F: FnMut(u64, &mut RawSample)> Inputs for Falsified<F> {
    fn at(&mut self, index: u64) -> RawSample {
        let mut raw = self.0.at(index);
        (self.1)(index, &mut raw);
        raw
    }
}

fn falsified(change: impl FnMut(u64, &mut RawSample) + 'static) -> VirtualBoard {
    let inputs = Falsified(Sensors::new(&scenario(60.0)), change);
    VirtualBoard::new(&firmware(), Box::new(inputs)).expect("a firmware that loads")
}

#[test]
fn an_overrun_of_the_converter_is_recovered_from_without_a_reset() {
    let mut board = running();
    board.block_dma(true);
    board.run(0.001).expect("a run");
    board.block_dma(false);
    let before = board.taken().len();
    board.run(0.5).expect("a run");
    let tally = board.tally();
    assert_eq!(tally.resets, 0, "{tally:?}");
    // A stall is noticed after 9.6 ms; nothing more may be lost than that, the block, and the restart.
    assert!(
        board.taken().len() - before > 4_700,
        "{}",
        board.taken().len() - before
    );
    assert_eq!(board.lamps(), HEALTHY);
}

/// Whether the firmware logged that samples are missing, and why.
fn has_noticed(board: &mut VirtualBoard, gap: &str) -> bool {
    let told = format!("samples are missing: {gap}");
    board.log().iter().any(|line| line.contains(&told))
}

#[test]
fn samples_overwritten_while_the_processor_was_held_up_are_not_computed_with() {
    // Of half a ring, 3.2 ms: nearly a whole ring, a whole one, and one and a half.
    for held_up_s in [0.0055, 0.0068, 0.0101] {
        let mut board = running();
        board.log();
        board.hold_up(held_up_s).expect("a run");
        board.run(0.3).expect("a run");
        assert!(has_noticed(&mut board, "Overrun"), "{held_up_s} s");
        board.run(0.2).expect("a run");
        assert_eq!(board.lamps(), HEALTHY, "{held_up_s} s");
        assert_eq!(board.tally().resets, 0, "{held_up_s} s");
    }
}

#[test]
fn encoder_counts_that_belong_to_other_instants_are_not_computed_with() {
    let mut board = running();
    board.log();
    board.lose_encoder_counts(5);
    board.run(0.3).expect("a run");
    assert!(has_noticed(&mut board, "Misaligned"));
    board.run(0.2).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    assert_eq!(board.tally().resets, 0);
}

#[test]
fn a_stopped_converter_clock_resets_the_board_and_its_return_brings_it_back() {
    let mut board = running();
    board.stop_converter_clock(true);
    board.run(1.0).expect("a run");
    assert!(board.tally().resets >= 1, "{:?}", board.tally());
    board.stop_converter_clock(false);
    board.run(LAMP_TEST_S + 1.5).expect("a run");
    assert_eq!(board.lamps(), HEALTHY);
    // Calibrating the converter anew never ends: no good block, whatever else was missing when it began.
    let missing = Master::new(UNIT).long(&mut board, Field::CrashAddress);
    assert_eq!(missing & 1, 1, "{missing}");
}

#[test]
fn a_converter_supply_5_percent_off_lights_sensor_and_clears_again() {
    for millivolt in [3_465, 3_135] {
        let mut board = running();
        board.set_vdda(millivolt);
        board.run(1.1).expect("a run");
        let lamps = board.lamps();
        assert!(lamps[SENSOR] && lamps[FAULT], "{millivolt} mV: {lamps:?}");
        board.set_vdda(3_300);
        board.run(1.1).expect("a run");
        assert_eq!(board.lamps(), HEALTHY, "{millivolt} mV and back");
    }
}

#[test]
fn a_converter_supply_5_percent_off_lights_sensor_from_power_up_on() {
    for millivolt in [3_465, 3_135] {
        let mut board = board(&scenario(2.0));
        board.set_vdda(millivolt);
        // Two blocks behind the lamp test: long before the first look of once a second.
        board.run(LAMP_TEST_S + 0.03).expect("a run");
        let lamps = board.lamps();
        assert!(lamps[SENSOR] && lamps[FAULT], "{millivolt} mV: {lamps:?}");
    }
}

#[test]
fn corrupted_motor_constants_are_never_computed_with() {
    let mut board = running();
    let image = board
        .symbol("firmware5IMAGE")
        .expect("a symbol for the constants");
    board
        .corrupt_flash(image + 40, 1 << 9)
        .expect("an address in flash");
    board.reset(Cause::Power).expect("a reset");
    let taken = board.taken().len();
    board.run(LAMP_TEST_S + 2.0).expect("a run");
    let lamps = board.lamps();
    assert!(lamps[SENSOR] && lamps[FAULT] && !lamps[RUN], "{lamps:?}");
    assert_eq!(board.taken().len(), taken, "nothing may be sampled");
    assert_eq!(
        board.tally().resets,
        1,
        "it waits instead of resetting for ever"
    );
}

/// Why the firmware says that it was started.
fn told_cause(board: &mut VirtualBoard) -> String {
    let start = board.log().into_iter().find(|line| line.contains("reset:"));
    let start = start.expect("a line about the start");
    start.rsplit(' ').next().unwrap_or_default().to_owned()
}

#[test]
fn a_brown_out_starts_the_board_again_and_each_start_tells_its_own_cause() {
    let mut board = running();
    assert_eq!(told_cause(&mut board), "PowerOrBrownOut");
    for (cause, told) in [
        (Cause::Watchdog, "Watchdog"),
        (Cause::Power, "PowerOrBrownOut"),
        (Cause::Software, "Software"),
    ] {
        board.reset(cause).expect("a reset");
        board.run(LAMP_TEST_S + 0.8).expect("a run");
        assert_eq!(board.lamps(), HEALTHY, "after {cause:?}");
        assert_eq!(told_cause(&mut board), told);
    }
    assert_eq!(board.tally().resets, 3);
}

/// The channels in the order of the converter's sequence.
fn channel(raw: &mut RawSample, place: usize) -> &mut u16 {
    let codes = if place.is_multiple_of(2) {
        &mut raw.voltage_codes
    } else {
        &mut raw.current_codes
    };
    &mut codes[place / 2]
}

#[test]
fn each_stuck_channel_lights_sensor_wherever_it_stands() {
    for place in 0..6 {
        for code in [700, 1_800, 2_048, 3_000] {
            let mut board = falsified(move |index, raw| {
                if index > 8_000 {
                    *channel(raw, place) = code;
                }
            });
            board.run(LAMP_TEST_S + 1.5).expect("a run");
            let lamps = board.lamps();
            assert!(
                lamps[SENSOR] && lamps[FAULT],
                "channel {place} at {code}: {lamps:?}"
            );
        }
    }
}

#[test]
fn an_unplugged_encoder_lights_sensor() {
    let mut board = falsified(|index, raw| {
        if index > 8_000 {
            raw.encoder_count = 1_234;
        }
    });
    board.run(LAMP_TEST_S + 1.5).expect("a run");
    assert!(board.lamps()[SENSOR], "{:?}", board.lamps());
}

#[test]
fn a_locked_shaft_is_no_sensor_fault() {
    let mut scenario = scenario(2.0);
    scenario.start = Start::Standstill;
    let torque = 50.0;
    scenario.load.other = Load::Constant {
        torque,
        active: false,
    };
    let seen = watch(&scenario);
    seen.assert_as_on_the_host("shaft locked");
    assert!(!seen.lit().contains(&"sensor"), "{:?}", seen.lit());
}

#[test]
fn a_storm_of_encoder_edges_costs_neither_samples_nor_time() {
    let quiet = running().tally();
    let mut counter = 0_u16;
    let mut board = falsified(move |index, raw| {
        // Some 60 million edges a second, up and down.
        counter = counter.wrapping_add((index.wrapping_mul(2_654_435_761) >> 7) as u16 & 0x3FFF);
        raw.encoder_count = counter;
    });
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    let tally = board.tally();
    assert_eq!((tally.resets, tally.missed_triggers), (0, 0));
    assert_eq!(tally.conversions, quiet.conversions);
    // The alarm's samples are handed over, which takes a frame more in each of 48 windows and three interrupts a frame;
    // a single interrupt for each edge would be 48 million.
    assert!(
        tally.exceptions <= quiet.exceptions + 150,
        "{tally:?} against {quiet:?}"
    );
}

/// Whether lamps differ from the host's within five seconds of interruptions at every place of the arithmetic, or none are judged.
fn is_disturbed_by_interrupts(stacks_floats: bool) -> bool {
    let mut board = board(&scenario(10.0));
    if !stacks_floats {
        board.forget_float_stacking();
    }
    // A prime, so that the interruptions wander through the program; 24 a block.
    board.interrupt_for_nothing(10_657);
    board.run(LAMP_TEST_S).expect("a lamp test");
    (0..50).any(|_| {
        board.run(0.1).expect("a run");
        let levels = board.lamps();
        let host = host_lamps(board.taken());
        // The board shows a window some milliseconds after its last sample: lamps that have just changed tell nothing.
        let Some((last, before)) = host.split_last() else {
            // The arithmetic of the start was destroyed: the board refuses to judge and takes no sample.
            return true;
        };
        let settled =
            host.len() > 5_000 && before.iter().rev().take(300).all(|lamps| lamps == last);
        settled && !common::shows(levels, last)
    })
}

#[test]
fn interrupts_within_the_arithmetic_change_nothing_and_the_model_of_exceptions_can_fail() {
    assert!(!is_disturbed_by_interrupts(true));
    // Without stacking of the floating-point registers an interrupt in the middle of the arithmetic destroys it.
    assert!(
        is_disturbed_by_interrupts(false),
        "lost floating-point registers went unnoticed"
    );
}

#[test]
fn latched_lamps_stay_until_the_button_is_pressed() {
    let mut scenario = scenario(60.0);
    let fault = Fault::percent("Rs", 50.0, MotorFrame::RotorFlux).expect("a known fault");
    let (from_s, to_s) = (3.5, 4.5);
    scenario.faults = vec![Fault {
        from_s,
        to_s,
        ..fault
    }];
    let mut board = board(&scenario);
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    board.press(true);
    board.run(2.1).expect("a run");
    board.press(false);
    board.run(2.6).expect("a run");
    let latched = board.lamps();
    assert!(
        latched[RUN] && latched[FAULT],
        "a second after the fault: {latched:?}"
    );
    board.press(true);
    board.run(0.1).expect("a run");
    board.press(false);
    board.run(0.1).expect("a run");
    assert_eq!(board.lamps(), HEALTHY, "after the button");
}
