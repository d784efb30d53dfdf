//! The board's own defects: each is found in its time, recorded, and opens the relay or blinks SENSOR.

#[path = "../common/mod.rs"]
mod common;
mod rates_and_learning;

use board::modbus::Field;
use board::{Doubt, Doubts, FaultCause};
use common::master::{Master, UNIT};
use common::{LAMP_TEST_S, Sensors, board as board_of, firmware, scenario};
use virtual_board::{Cause, Contact, Pin, SHIPPED_OPTIONS, VirtualBoard};

const RUN: usize = 0;
const SENSOR: usize = 5;
const FAULT: usize = 8;
const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];
const RAM: u32 = 0x2000_0000;
/// Within the chip's addresses, with nothing behind it.
const NOWHERE: u32 = 0x6000_0000;

fn running() -> VirtualBoard {
    let mut board = board_of(&scenario(60.0));
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY, "before the fault");
    assert!(board.relay(), "before the fault");
    board
}

/// What the board doubts, as a master reads it.
fn doubts(board: &mut VirtualBoard) -> Doubts {
    Doubts::from_bits(Master::new(UNIT).long(board, Field::Doubts))
}

fn cause(board: &mut VirtualBoard) -> Option<FaultCause> {
    let number = Master::new(UNIT).word(board, Field::CrashCause);
    FaultCause::by_number(u32::from(number))
}

/// The board starts again within `seconds`, tells why, and monitors as before. The relay opens meanwhile.
fn assert_starts_again(board: &mut VirtualBoard, seconds: f64, expected: FaultCause) {
    board.run(seconds).expect("a run");
    assert_eq!(board.tally().resets, 1, "{expected:?}");
    board.run(0.05).expect("a run");
    assert!(!board.relay(), "{expected:?}: the relay is open");
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_eq!(board.lamps(), HEALTHY, "{expected:?}");
    assert!(board.relay(), "{expected:?}");
    assert_eq!(cause(board), Some(expected));
    assert_eq!(board.tally().resets, 1, "{expected:?}: once");
}

/// Within `seconds` there is this doubt and no other; SENSOR says so, and FAULT where nothing can be judged any more.
fn assert_doubts(board: &mut VirtualBoard, seconds: f64, doubt: Doubt) {
    board.run(seconds).expect("a run");
    let found = doubts(board);
    assert_eq!(found.iter().collect::<Vec<_>>(), [doubt]);
    let stops = doubt.stops_judging();
    let lit = (0..12).map(|_| {
        board.run(0.1).expect("a run");
        board.lamps()
    });
    let lit: Vec<[bool; 9]> = lit.collect();
    let always = |lamp: usize| lit.iter().all(|lamps| lamps[lamp]);
    let ever = |lamp: usize| lit.iter().any(|lamps| lamps[lamp]);
    assert!(ever(SENSOR), "{doubt:?}");
    assert_eq!((always(SENSOR), always(FAULT)), (stops, stops), "{doubt:?}");
    assert_eq!(board.relay(), !stops, "{doubt:?}");
    assert_eq!(board.tally().resets, 0, "{doubt:?}");
}

#[test]
fn a_dead_crystal_does_not_keep_the_board_dark() {
    let mut board = board_of(&scenario(60.0));
    board.set_crystal(false);
    // A tenth of a second is what the crystal may take.
    board.run(0.15 + LAMP_TEST_S + 0.8).expect("a run");
    assert!(board.taken().len() > 5_000, "it samples");
    assert_doubts(&mut board, 0.0, Doubt::Clock);
}

#[test]
fn a_crystal_that_stops_while_running_is_left_and_recorded() {
    let mut board = running();
    board.set_crystal(false);
    board.run(0.001).expect("a run");
    assert_eq!(board.tally().resets, 1, "at once");
    // One that comes back is not trusted before the next start.
    board.set_crystal(true);
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(cause(&mut board), Some(FaultCause::ClockFailure));
    assert!(doubts(&mut board).has(Doubt::Clock));
    assert!(board.lamps()[SENSOR] && board.lamps()[FAULT] && !board.relay());
}

#[test]
fn without_the_clock_security_system_a_dead_crystal_would_stop_everything() {
    let mut board = running();
    // RCC_CR as it is, without CSSON: the model has to show what the handling is for.
    let control = 0x4002_1000;
    board
        .poke(control, 1 << 8 | 1 << 16 | 1 << 24)
        .expect("RCC");
    let before = board.tally().instructions;
    board.set_crystal(false);
    board.run(0.1).expect("a run");
    assert!(
        board.tally().instructions < before + 1_000,
        "the core stands"
    );
    board.run(0.3).expect("a run");
    assert_eq!(
        board.tally().resets,
        1,
        "the watchdog has a clock of its own"
    );
}

#[test]
fn a_clock_that_is_far_off_is_found_and_a_cold_or_hot_oscillator_is_not() {
    for (hz, off) in [
        (29_500, false),
        (34_000, false),
        (96_000, true),
        (24_000, true),
    ] {
        let mut board = running();
        board.set_low_speed_oscillator(hz);
        // The watchdog's own time shrinks with its oscillator; a look takes a second, and the change falls within one.
        board.run(3.2).expect("a run");
        assert_eq!(doubts(&mut board).has(Doubt::ClockRatio), off, "{hz} Hz");
    }
}

#[test]
fn code_that_runs_astray_is_recorded_with_its_place() {
    // A read of nothing: `ldr r5, [r4]` of the test of the RAM, with r4 beyond all memory.
    let mut board = running();
    let init = board.symbol("__pre_init").expect("a function") & !1;
    let load = (init..init + 0x80)
        .step_by(2)
        .find(|at| {
            board
                .word(*at & !3)
                .is_ok_and(|word| (word >> (8 * (at & 2))) as u16 == 0x6825)
        })
        .expect("ldr r5, [r4]");
    let registers = [0, 0, 0, 0, NOWHERE];
    board.go_astray(load, &registers).expect("a processor");
    assert_starts_again(&mut board, 0.01, FaultCause::HardFault);
    let master = &mut Master::new(UNIT);
    assert_eq!(master.long(&mut board, Field::CrashProgramCounter), load);
    assert_eq!(master.long(&mut board, Field::CrashAddress), NOWHERE);
    assert_eq!(
        master.long(&mut board, Field::CrashFaults),
        1 << 9 | 1 << 15
    );
    let uptime = master.long(&mut board, Field::CrashUptime);
    assert!((2_000..2_400).contains(&uptime), "{uptime} ms");
}

#[test]
fn nothing_is_executed_from_the_ram() {
    let mut board = running();
    board.go_astray(RAM + 0x1_0000, &[]).expect("a processor");
    assert_starts_again(&mut board, 0.01, FaultCause::HardFault);
    let faults = Master::new(UNIT).long(&mut board, Field::CrashFaults);
    assert_eq!(faults, 1, "forbidden by memory protection");
}

#[test]
fn a_stack_that_overflows_leaves_the_ram_and_is_recorded() {
    let mut board = running();
    board.move_stack(RAM + 8).expect("a processor");
    assert_starts_again(&mut board, 0.02, FaultCause::HardFault);
    let sp = Master::new(UNIT).long(&mut board, Field::CrashStack);
    assert!(sp < RAM + 8, "{sp:#x}");
}

#[test]
fn a_panic_is_recorded_with_its_line() {
    let mut board = running();
    let panic = board.symbol("panic_bounds_check").expect("a function");
    // A place as the compiler writes it: name and its length, line, column. The name is any text of the program.
    let (place, name) = (RAM + 0x1_6000, 0x0800_1234);
    for (k, word) in [name, 15, 77, 1].into_iter().enumerate() {
        board.poke(place + 4 * k as u32, word).expect("RAM");
    }
    board.go_astray(panic, &[9, 4, place]).expect("a processor");
    assert_starts_again(&mut board, 0.01, FaultCause::Panic);
    let master = &mut Master::new(UNIT);
    assert_eq!(master.long(&mut board, Field::CrashAddress), name);
    assert_eq!(master.word(&mut board, Field::CrashLength), 15);
    assert_eq!(master.word(&mut board, Field::CrashLine), 77);
}

#[test]
fn a_parity_error_of_the_ram_is_recorded() {
    let mut board = running();
    board.fail_parity();
    assert_starts_again(&mut board, 0.01, FaultCause::RamParity);
}

#[test]
fn wrong_bits_in_the_program_end_it_and_wrong_bits_in_stored_data_do_not() {
    let mut board = running();
    board.detect_flash_error(0x0807_F010);
    board.run(1.2).expect("a run");
    assert_eq!(board.tally().resets, 0);
    assert_eq!(
        Master::new(UNIT).word(&mut board, Field::StoredDataErrors),
        1
    );
    board.detect_flash_error(0x0800_4568);
    assert_starts_again(&mut board, 0.01, FaultCause::FlashError);
    let address = Master::new(UNIT).long(&mut board, Field::CrashAddress);
    assert_eq!(address, 0x0800_4568);
}

#[test]
fn a_task_that_is_never_woken_starves_the_watchdog_which_names_it() {
    for (function, mark) in [("8SelfTest4step", 4), ("serve_modbus", 2)] {
        let mut board = running();
        let found = board.symbols(function);
        let found = found.iter().find(|(name, _)| {
            name.contains("SelfTest") || (name.contains("TaskStorage") && name.contains("poll"))
        });
        let (_, at) = found.unwrap_or_else(|| panic!("no function {function}"));
        board.leave_out(*at).expect("a processor");
        let before = board.tally().ticks;
        let mut noted = 0;
        while board.tally().resets == 0 {
            noted = board.backup_words()[17];
            board.run(0.01).expect("a run");
            assert!(
                board.tally().ticks < before + virtual_board::TICK_HZ,
                "{function}"
            );
        }
        let seconds = (board.tally().ticks - before) as f64 / virtual_board::TICK_HZ as f64;
        // The last feeding was up to 0.06 s before; the oscillator is exact here.
        assert!((0.19..0.37).contains(&seconds), "{function}: {seconds} s");
        assert_eq!(noted, mark, "{function}: marks that were missing");
    }
}

#[test]
fn three_crashes_in_a_row_end_in_a_safe_state_until_somebody_acknowledges() {
    let mut board = running();
    for crash in 1..=3 {
        board.fail_parity();
        board.run(LAMP_TEST_S + 0.8).expect("a run");
        assert_eq!(board.tally().resets, crash);
    }
    let taken = board.taken().len();
    board.run(2.0).expect("a run");
    let lamps = board.lamps();
    assert!(lamps[SENSOR] && lamps[FAULT] && !lamps[RUN], "{lamps:?}");
    assert!(!board.relay());
    assert_eq!(board.taken().len(), taken, "nothing is sampled");
    assert_eq!(board.tally().resets, 3, "it waits");
    let master = &mut Master::new(UNIT);
    assert_eq!(master.word(&mut board, Field::Crashes), 3);
    assert!(doubts(&mut board).has(Doubt::Restarts));
    master.command(&mut board, 1);
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(board.tally().resets, 4);
    assert_eq!(board.lamps(), HEALTHY);
    assert_eq!(master.word(&mut board, Field::Crashes), 0);
}

#[test]
fn a_cell_of_the_ram_that_sticks_is_found_at_the_start() {
    for address in [RAM, RAM + 0x5_678, RAM + 0x1_7FFC] {
        let mut board = board_of(&scenario(10.0));
        board.stick_ram_bit(address, 9, true).expect("RAM");
        board.run(0.2).expect("a run");
        let lamps = board.lamps();
        assert!(
            lamps[SENSOR] && lamps[FAULT] && !lamps[RUN],
            "{address:#x}: {lamps:?}"
        );
        let words = board.backup_words();
        assert_eq!(words[20..22], [0x444D_5241, address], "{address:#x}");
        board.run(1.0).expect("a run");
        assert!(board.tally().resets > 0, "the watchdog tries again");
        assert!(board.taken().is_empty() && !board.relay());
    }
}

#[test]
fn a_cell_of_the_ram_that_sticks_is_found_while_running() {
    let mut board = running();
    // In front of the slice that is tested in the third second; the stack has never been there.
    board.stick_ram_bit(RAM + 4 * 64 - 8, 3, true).expect("RAM");
    assert_doubts(&mut board, 4.0, Doubt::Ram);
}

#[test]
fn a_register_that_loses_a_bit_is_found_at_the_start_and_while_running() {
    let mut board = running();
    let loaded = board.symbol("test_registers_loaded").expect("a label");
    board.flip_register(loaded, 4, 1 << 7).expect("a processor");
    board.run(1.1).expect("a run");
    assert_eq!(board.tally().resets, 1, "within a second");
    let taken = board.taken().len();
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert!(doubts(&mut board).has(Doubt::Processor), "and at the start");
    assert_eq!(board.taken().len(), taken, "nothing is computed then");
}

#[test]
fn a_program_with_a_flipped_bit_is_found_at_the_start_and_while_running() {
    let mut board = board_of(&scenario(40.0));
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    // Nothing is executed there on a healthy board.
    let refuse = board.symbol("6refuse").expect("a function");
    let at = (refuse + 0x40) & !3;
    board.corrupt_flash(at, 1 << 21).expect("flash");
    // The whole program is gone through in 15 s; the first time was past this word already.
    assert_doubts(&mut board, 34.0, Doubt::Program);
    board.reset(Cause::Power).expect("a reset");
    board.run(LAMP_TEST_S + 0.5).expect("a run");
    assert!(doubts(&mut board).has(Doubt::Program));
}

#[test]
fn settings_that_change_by_themselves_are_found() {
    // Sampling times of the converter, output mode of a lamp, prescaler of the trigger.
    for (register, value) in [(0x5000_0014, 0), (0x4000_0828, 1)] {
        let mut board = running();
        board.poke(register, value).expect("a register");
        board.run(1.2).expect("a run");
        assert!(doubts(&mut board).has(Doubt::Settings), "{register:#x}");
        assert!(board.lamps()[SENSOR] && board.lamps()[FAULT]);
    }
}

#[test]
fn a_lamp_whose_wire_is_shorted_blinks_sensor() {
    let mut board = running();
    board.short(Pin(1, 12), Some(true));
    assert_doubts(&mut board, 0.1, Doubt::Lamps);
}

#[test]
fn the_relay_opens_with_its_pin_stuck_and_a_contact_that_does_not_follow_is_told() {
    for level in [false, true] {
        let mut board = running();
        board.short(Pin(0, 8), Some(level));
        board.run(0.1).expect("a run");
        assert!(!board.relay(), "pin stuck at {level}");
        assert!(
            doubts(&mut board).has(Doubt::Relay),
            "its contact has opened"
        );
    }
    let mut board = running();
    board.set_contact(Contact::Absent);
    assert_doubts(&mut board, 0.3, Doubt::Relay);
}

#[test]
fn option_bytes_as_shipped_blink_sensor_until_they_are_written() {
    let mut board = board_of(&scenario(60.0));
    board.set_options(SHIPPED_OPTIONS).expect("options");
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    let resets = board.tally().resets;
    assert_eq!(
        doubts(&mut board).iter().collect::<Vec<_>>(),
        [Doubt::OptionBytes]
    );
    assert!(board.relay(), "they stop nothing");
    let master = &mut Master::new(UNIT);
    // Nothing is learnt meanwhile.
    master.command(&mut board, 2);
    board.run(0.1).expect("a run");
    assert_eq!(master.word(&mut board, Field::Learning), 24);
    master.command(&mut board, 3);
    board.run(LAMP_TEST_S + 1.0).expect("a run");
    assert_eq!(board.tally().resets, resets + 1);
    assert_eq!(board.options(), virtual_board::PREPARED_OPTIONS);
    assert_eq!(board.lamps(), HEALTHY);
    assert!(!doubts(&mut board).is_any());
}

#[test]
fn a_program_that_was_never_sealed_says_so() {
    let mut elf = firmware();
    let seal = elf
        .windows(4)
        .position(|bytes| bytes == b"SEAL")
        .expect("a seal");
    elf[seal + 4..seal + 12].fill(0xFF);
    let inputs = Box::new(Sensors::new(&scenario(10.0)));
    let mut board = VirtualBoard::new(&elf, inputs).expect("a firmware");
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    assert_doubts(&mut board, 0.0, Doubt::Unsealed);
}

#[test]
fn a_low_supply_keeps_flash_from_being_written() {
    let mut board = running();
    let master = &mut Master::new(UNIT);
    master.command(&mut board, 2);
    board.run(5.0).expect("a run");
    // Of the digital supply alone; the reference's look comes once a second and would end learning.
    board.set_detector_sees(Some(2_850));
    board.run(6.5).expect("a run");
    assert_eq!(master.word(&mut board, Field::Learning), 23, "not stored");
    assert!(
        board
            .read_flash(0x0807_F000, 4096)
            .expect("flash")
            .iter()
            .all(|byte| *byte == 0xFF)
    );
}
