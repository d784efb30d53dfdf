//! The serial lines of the firmware: a Modbus master from elsewhere, noise, and frames on the virtual COM port.

mod common;

use board::modbus::{Field, UNLOCK_KEY, address};
use board::{Frame, LAMP_NAMES};
use common::master::{CHARACTER_S, Master, UNIT, ask, bytes};
use common::{LAMP_TEST_S, board as board_of, scenario};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rmodbus::client::ModbusRequest;
use virtual_board::{Port, Quality, TICK_HZ, VirtualBoard};

fn running() -> VirtualBoard {
    let mut board = board_of(&scenario(60.0));
    board.run(LAMP_TEST_S + 0.8).expect("a run");
    board
}

fn master() -> ModbusRequest {
    Master::new(UNIT).request()
}

fn registers(board: &mut VirtualBoard) -> Vec<u16> {
    Master::new(UNIT).registers(board)
}

fn float(words: &[u16], field: Field) -> f64 {
    let at = usize::from(address(field));
    f64::from(f32::from_bits(
        u32::from(words[at]) << 16 | u32::from(words[at + 1]),
    ))
}

fn word(words: &[u16], field: Field) -> u16 {
    words[usize::from(address(field))]
}

fn write(board: &mut VirtualBoard, register: u16, value: u16) -> bool {
    Master::new(UNIT).write(board, register, value)
}

#[test]
fn a_master_reads_what_the_motor_does() {
    let mut board = running();
    board.set_temperature(55.0);
    board.run(1.1).expect("a run");
    let words = registers(&mut board);
    for (field, expected, tolerance) in [
        // Nameplate; the supply is ideal and the converter's step is 0.2 V.
        (Field::SupplyFrequency, 60.0, 0.01),
        (Field::Voltage, 220.0 / 3_f64.sqrt(), 0.2),
        // Half a code of the sensor is 0.15 K.
        (Field::Temperature, 55.0, 0.3),
        // Between rated and synchronous speed: 118 W of 300 W.
        (Field::Speed, 1_750.0, 50.0),
    ] {
        let found = float(&words, field);
        assert!((found - expected).abs() < tolerance, "{field:?}: {found}");
    }
    assert!(float(&words, Field::Residual1).abs() < 0.006);
    assert_eq!(word(&words, Field::Verdict), 1);
    assert_eq!(word(&words, Field::ResetCause), 1);
    // A code of the reference is 2 mV.
    assert!(word(&words, Field::ConverterSupply).abs_diff(3_300) <= 2);
    let image = board.symbol("firmware5IMAGE").expect("the constants");
    let constants = board
        .read_flash(image, 4 * board::IMAGE_WORDS)
        .expect("flash");
    let [.., a, b, c, d] = constants[..] else {
        panic!("too short")
    };
    let at = usize::from(address(Field::MotorIdentification));
    let identification = u32::from(words[at]) << 16 | u32::from(words[at + 1]);
    assert_eq!(identification, u32::from_le_bytes([a, b, c, d]));
}

#[test]
fn the_driver_is_enabled_and_the_answer_comes_soon_but_not_too_soon() {
    let mut board = running();
    let mut request = Vec::new();
    master()
        .generate_get_inputs(0, 1, &mut request)
        .expect("a request");
    let before = board.tally().ticks;
    let answer = ask(&mut board, &request);
    assert_eq!(answer.len(), 7);
    assert!(answer.iter().all(|sent| sent.driven));
    let seconds = (answer[0].at - before) as f64 / TICK_HZ as f64;
    let silence = seconds - CHARACTER_S * (request.len() + 1) as f64;
    // 3.5 characters are demanded; a block of samples may come between.
    assert!((3.5 * CHARACTER_S..0.01).contains(&silence), "{silence}");
}

#[test]
fn learning_is_asked_for_behind_the_key_only() {
    let mut board = running();
    assert!(!write(&mut board, 1, 2), "locked");
    assert_eq!(word(&registers(&mut board), Field::Learning), 0);
    assert!(write(&mut board, 0, UNLOCK_KEY));
    assert!(write(&mut board, 1, 2));
    let words = registers(&mut board);
    assert_eq!(word(&words, Field::Learning), 1);
    assert!(word(&words, Field::LearnedWindows) > 0);
    board.run(10.5).expect("a run");
    let words = registers(&mut board);
    assert_eq!(
        (
            word(&words, Field::Learning),
            word(&words, Field::Calibration)
        ),
        (2, 1)
    );
}

#[test]
fn noise_and_rubbish_change_nothing_and_a_good_request_is_answered_afterwards() {
    let mut board = running();
    let mut random = Pcg64Mcg::seed_from_u64(9);
    for _ in 0..1_000 {
        let length = random.random_range(1..40);
        let rubbish: Vec<(u8, Quality)> = (0..length)
            .map(|_| {
                let quality = if random.random_ratio(1, 4) {
                    Quality::Bad
                } else {
                    Quality::Good
                };
                (random.random(), quality)
            })
            .collect();
        board.deliver(Port::Modbus, &rubbish);
        let pause = if random.random_bool(0.5) { 0.004 } else { 0.0 };
        board
            .run(CHARACTER_S * f64::from(length) + pause)
            .expect("a run");
    }
    board.run(0.02).expect("a run");
    let tally = board.tally();
    assert_eq!((tally.resets, tally.missed_triggers), (0, 0), "{tally:?}");
    let words = registers(&mut board);
    assert_eq!(word(&words, Field::Verdict), 1);
    assert_eq!(word(&words, Field::Learning), 0);
    let run = LAMP_NAMES
        .iter()
        .position(|name| *name == "run")
        .expect("a lamp");
    assert!(board.lamps()[run]);
}

#[test]
fn the_virtual_com_port_carries_the_debuggers_frames() {
    let mut board = board_of(&scenario(3.0));
    board.run(LAMP_TEST_S).expect("a lamp test");
    let mut debugger = Vec::new();
    for _ in 0..20 {
        board.run(0.1).expect("a run");
        debugger.extend(board.frames());
    }
    // What is on the wire still.
    board.run(0.015).expect("a run");
    let line = bytes(&board.take_sent(Port::Frames));
    assert!(
        line.starts_with(&debugger),
        "{} of {} bytes",
        line.len(),
        debugger.len()
    );
    let frames = line.split_inclusive(|byte| *byte == 0);
    let whole = frames.filter(|bytes| Frame::decode(bytes).is_ok()).count();
    // 2 s of 60 Hz less 0.1 s of inhibition and the search for the supply.
    assert!((105..=120).contains(&whole), "{whole} frames");
}
