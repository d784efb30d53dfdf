//! The slave against a master from elsewhere (`rmodbus`), and against a million frames of rubbish.

use std::vec::Vec;

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rmodbus::ModbusProto;
use rmodbus::client::ModbusRequest;

use super::super::entry::Field;
use super::super::identity::Object;
use super::super::map::{Image, WORDS, address};
use super::super::memory::{Identity, ReadEvents};
use super::*;
use crate::configuration::{ACTIVE, CONFIGURATION_REGISTERS, Configuration, STAGED};
use crate::events::{EVENT_BYTES, LOG_EVENTS};
use crate::image::{IMAGE_WORDS, MotorImage};
use crate::modbus::{EVENT_FILE, MOST_FILE_WORDS};

const UNIT: u8 = 17;

fn image() -> Image {
    let mut image = Image::default();
    image.set_float(Field::Speed, 1_487.25);
    image.set_word(Field::ConverterSupply, 3_301);
    image
}

fn master() -> ModbusRequest {
    ModbusRequest::new(UNIT, ModbusProto::Rtu)
}

const IDENTITY: Identity = Identity {
    version: "1.2.3",
    revision: "0123456789abcdef0123456789abcdef01234567",
    serial: [0x0012_3456, 0x789A_BCDE, 0xF000_000F],
};

const MOTOR: &str = "a motor with a name of a length that no plate has, but some motor files do";

/// The desk of a board with this motor.
fn desk() -> Desk {
    let constants = MotorImage([0; IMAGE_WORDS]);
    let mut desk = Desk::blank();
    desk.show(&Configuration::of(MOTOR, &constants));
    desk
}

/// A log whose bytes count up.
fn counting(from: usize, bytes: &mut [u8]) -> bool {
    for (k, byte) in bytes.iter_mut().enumerate() {
        *byte = (from + k) as u8;
    }
    true
}

fn ask(slave: &mut Slave, now_ms: u32, request: &[u8]) -> (Vec<u8>, Option<Command>) {
    ask_of(slave, now_ms, request, counting, &mut Desk::blank())
}

fn ask_of(
    slave: &mut Slave,
    now_ms: u32,
    request: &[u8],
    events: ReadEvents,
    desk: &mut Desk,
) -> (Vec<u8>, Option<Command>) {
    let mut response = [0; MAX_RESPONSE_BYTES];
    let mut memory = Memory {
        image: &image(),
        identity: &IDENTITY,
        events,
        desk,
    };
    let (length, command) = slave.respond(now_ms, request, &mut memory, &mut response);
    (response[..length].to_vec(), command)
}

/// CRC-16 of the protocol, bit by bit as the specification draws it.
fn sealed(frame: &[u8]) -> Vec<u8> {
    let mut crc = 0xFFFF_u16;
    for byte in frame {
        crc ^= u16::from(*byte);
        for _ in 0..8 {
            crc = crc >> 1 ^ if crc & 1 == 1 { 0xA001 } else { 0 };
        }
    }
    [frame, &crc.to_le_bytes()].concat()
}

/// A good request is answered as a good master expects.
fn assert_alive(slave: &mut Slave) {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_get_inputs(address(Field::Speed), 2, &mut request)
        .expect("a request");
    let (answer, command) = ask(slave, 0, &request);
    let mut speed: Vec<f32> = Vec::new();
    master.parse_f32_be(&answer, &mut speed).expect("an answer");
    assert_eq!((speed, command), (vec![1_487.25], None));
}

#[test]
fn a_master_reads_the_whole_map_at_once() {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_get_inputs(0, WORDS as u16, &mut request)
        .expect("a request");
    let (answer, _) = ask(&mut Slave::new(UNIT), 0, &request);
    assert_eq!(answer.len(), 5 + 2 * WORDS);
    let mut words: Vec<u16> = Vec::new();
    master.parse_u16(&answer, &mut words).expect("an answer");
    assert_eq!(Some(&words[..]), image().range(0, WORDS as u16));
}

fn write(slave: &mut Slave, now_ms: u32, register: u16, value: u16) -> (bool, Option<Command>) {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_set_holding(register, value, &mut request)
        .expect("a request");
    let (answer, command) = ask(slave, now_ms, &request);
    (master.parse_ok(&answer).is_ok(), command)
}

#[test]
fn a_command_needs_the_key_first_and_locks_again() {
    let mut slave = Slave::new(UNIT);
    assert_eq!(write(&mut slave, 0, 1, 2), (false, None));
    assert_eq!(write(&mut slave, 0, 0, UNLOCK_KEY), (true, None));
    assert_eq!(write(&mut slave, 5_000, 1, 2), (true, Some(Command::Learn)));
    assert_eq!(write(&mut slave, 5_001, 1, 2), (false, None));
    assert_eq!(write(&mut slave, 5_002, 0, UNLOCK_KEY), (true, None));
    assert_eq!(
        write(&mut slave, 5_003, 1, 1),
        (true, Some(Command::Acknowledge))
    );
}

#[test]
fn the_key_holds_ten_seconds_across_the_clocks_end() {
    let mut slave = Slave::new(UNIT);
    write(&mut slave, u32::MAX - 5_000, 0, UNLOCK_KEY);
    assert_eq!(
        write(&mut slave, 4_000, 1, 1),
        (true, Some(Command::Acknowledge))
    );
    write(&mut slave, u32::MAX - 5_000, 0, UNLOCK_KEY);
    assert_eq!(write(&mut slave, 6_000, 1, 1), (false, None));
}

#[test]
fn a_wrong_key_locks() {
    let mut slave = Slave::new(UNIT);
    write(&mut slave, 0, 0, UNLOCK_KEY);
    assert_eq!(write(&mut slave, 1, 0, UNLOCK_KEY + 1), (false, None));
    assert_eq!(write(&mut slave, 2, 1, 1), (false, None));
}

#[test]
fn key_and_command_may_come_in_one_request() {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_set_holdings_bulk(0, &[UNLOCK_KEY, 2], &mut request)
        .expect("a request");
    let (answer, command) = ask(&mut Slave::new(UNIT), 0, &request);
    assert!(master.parse_ok(&answer).is_ok());
    assert_eq!(command, Some(Command::Learn));
}

#[test]
fn what_is_wrong_is_refused_as_the_protocol_numbers_it() {
    let refused = |frame: &[u8]| {
        let (answer, command) = ask(&mut Slave::new(UNIT), 0, &sealed(frame));
        assert_eq!(command, None);
        assert_eq!(
            answer,
            sealed(&[UNIT, frame[1] | 0x80, answer[2]]),
            "{frame:?}"
        );
        answer[2]
    };
    assert_eq!(refused(&[UNIT, 1, 0, 0, 0, 1]), 1, "coils");
    assert_eq!(refused(&[UNIT, 0x2B]), 1, "an unknown function");
    assert_eq!(
        refused(&[UNIT, 4, 0, WORDS as u8, 0, 1]),
        2,
        "beyond the map"
    );
    assert_eq!(
        refused(&[UNIT, 4, 0xFF, 0xFF, 0, 2]),
        2,
        "beyond all addresses"
    );
    assert_eq!(refused(&[UNIT, 4, 0, 0, 0, 0]), 3, "nothing");
    assert_eq!(
        refused(&[UNIT, 4, 0, 0, 0, 126]),
        3,
        "more than an answer holds"
    );
    assert_eq!(refused(&[UNIT, 4, 0, 0, 0]), 3, "too short");
    assert_eq!(
        refused(&[UNIT, 6, 0, 2, 0, 0]),
        2,
        "beyond the holding registers"
    );
    assert_eq!(
        refused(&[UNIT, 16, 0, 0, 0, 2, 4, 1, 2]),
        3,
        "fewer values than counted"
    );
    assert_eq!(
        refused(&[UNIT, 16, 0, 1, 0, 2, 4, 1, 2, 3, 4]),
        2,
        "beyond the end"
    );
}

#[test]
fn others_broadcasts_and_damage_are_met_with_silence() {
    let good = sealed(&[UNIT, 4, 0, 0, 0, 1]);
    let mut slave = Slave::new(UNIT);
    assert!(!ask(&mut slave, 0, &good).0.is_empty());
    for other in [
        sealed(&[UNIT + 1, 4, 0, 0, 0, 1]),
        sealed(&[0, 6, 0, 0, 0x4D, 0x4D]),
    ] {
        assert_eq!(ask(&mut slave, 0, &other), (vec![], None));
    }
    for bit in 0..8 * good.len() {
        let mut damaged = good.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(ask(&mut slave, 0, &damaged), (vec![], None), "bit {bit}");
    }
    assert_eq!(ask(&mut slave, 0, &[]), (vec![], None));
}

/// What may change anything, decided without the code under test: a sealed write of the key, then of a command.
#[derive(Default)]
struct Law {
    unlocked: bool,
}

impl Law {
    fn allows(&mut self, frame: &[u8]) -> Option<Command> {
        let body = frame.get(..frame.len().checked_sub(2)?)?;
        if sealed(body) != frame || body.first() != Some(&UNIT) {
            return None;
        }
        let writes: Vec<(u8, [u8; 2])> = match body[1..] {
            [6, 0, register, a, b] => vec![(register, [a, b])],
            [16, 0, register @ (0 | 1), 0, 1, 2, a, b] => vec![(register, [a, b])],
            [16, 0, 0, 0, 2, 4, a, b, c, d] => vec![(0, [a, b]), (1, [c, d])],
            _ => vec![],
        };
        let mut command = None;
        for (register, value) in writes {
            match (register, value) {
                (0, [0x4D, 0x4D]) => self.unlocked = true,
                (0, _) => {
                    self.unlocked = false;
                    return None;
                }
                (1, [0, code @ (1..=7)]) if self.unlocked => {
                    self.unlocked = false;
                    command = Some(Command::ALL[usize::from(code) - 1]);
                }
                _ => return None,
            }
        }
        command
    }
}

fn random_frame(random: &mut Pcg64Mcg) -> Vec<u8> {
    let length = random.random_range(0..=MAX_REQUEST_BYTES + 8);
    let mut bytes: Vec<u8> = (0..length).map(|_| random.random()).collect();
    let values = [0, 1, 2, 3, 0x4D, 0x4D, random.random()];
    let mut pick = || values[random.random_range(0..values.len())];
    match pick() % 4 {
        0 => bytes,
        1 => {
            // Sealed, for this slave, any function.
            bytes.truncate(40);
            sealed(&[&[UNIT], &bytes[..]].concat())
        }
        _ => sealed(&near_request(pick)),
    }
}

/// Of the right shape or nearly so.
fn near_request(mut pick: impl FnMut() -> u8) -> Vec<u8> {
    match pick() % 3 {
        0 => vec![UNIT, 3 + pick() % 2, 0, pick(), 0, pick()],
        1 => vec![UNIT, 6, 0, pick() % 2, pick(), pick()],
        _ => {
            let count = 1 + pick() % 2;
            let mut frame = vec![UNIT, 16, 0, pick() % 2, 0, count, 2 * count];
            frame.extend((0..2 * count + pick() % 2).map(|_| pick()));
            frame
        }
    }
}

#[test]
fn a_million_random_frames_change_nothing_that_they_may_not_and_a_good_one_is_answered() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut slave = Slave::new(UNIT);
    let (mut law, mut desk) = (Law::default(), desk());
    let active = desk.active().clone();
    let mut commands = 0;
    for round in 0..1_000_000 {
        let frame = random_frame(&mut random);
        let mut collector = Collector::default();
        frame.chunks(7).for_each(|bytes| collector.push(bytes));
        let (_, command) = ask_of(&mut slave, 0, collector.frame(), counting, &mut desk);
        let received = if frame.len() > MAX_REQUEST_BYTES {
            &[]
        } else {
            &frame[..]
        };
        assert_eq!(command, law.allows(received), "frame {round}: {frame:02x?}");
        commands += u32::from(command.is_some());
    }
    assert!(
        commands > 100,
        "only {commands} commands: the frames are too far from real ones"
    );
    assert_eq!(desk.active(), &active);
    assert_alive(&mut slave);
}

#[test]
fn noise_longer_than_any_frame_is_no_frame_and_the_next_is_one() {
    let mut collector = Collector::default();
    // In pieces, as they come from the wire: those before the one too many would make a frame.
    let noise = [0x55; MAX_REQUEST_BYTES + 1];
    noise.chunks(32).for_each(|piece| collector.push(piece));
    assert!(collector.frame().is_empty());
    collector.clear();
    collector.push(&[1, 2]);
    assert_eq!(collector.frame(), [1, 2]);
}

/// Function and data of an answer whose checksum holds.
fn answered(request: &[u8]) -> (u8, Vec<u8>) {
    answered_at(request, &mut desk())
}

fn answered_at(request: &[u8], desk: &mut Desk) -> (u8, Vec<u8>) {
    let mut slave = Slave::new(UNIT);
    let (answer, _) = ask_of(&mut slave, 0, &sealed(request), counting, desk);
    assert!(answer.len() <= 256, "{} bytes", answer.len());
    let (body, _) = answer.split_last_chunk::<2>().expect("a checksum");
    assert_eq!(sealed(body), answer);
    assert_eq!(body[0], UNIT);
    (body[1], body[2..].to_vec())
}

fn refused(request: &[u8]) -> u8 {
    let (function, data) = answered(request);
    assert_eq!(function, request[1] | 0x80);
    assert_eq!(data.len(), 1);
    data[0]
}

/// All objects from `first` on, as a client of the specification collects them, and how many answers that took.
fn identified(kind: u8, mut first: u8) -> (Vec<(u8, std::string::String)>, u32) {
    let (mut objects, mut answers) = (Vec::new(), 0);
    loop {
        let (function, data) = answered(&[UNIT, 43, 14, kind, first]);
        assert_eq!((function, &data[..3]), (43, &[14, kind, 0x83][..]));
        let [follows, next, count] = data[3..6] else {
            panic!("too short")
        };
        let mut rest = &data[6..];
        for _ in 0..count {
            let (value, tail) = rest[2..].split_at(usize::from(rest[1]));
            let text = core::str::from_utf8(value).expect("text").into();
            objects.push((rest[0], text));
            rest = tail;
        }
        assert!(rest.is_empty());
        answers += 1;
        match follows {
            0 => return (objects, answers),
            _ => first = next,
        }
    }
}

#[test]
fn the_board_says_who_it_is_in_as_many_answers_as_that_takes() {
    let (all, answers) = identified(3, 0);
    assert_eq!(answers, 2);
    let numbers: Vec<u8> = all.iter().map(|(number, _)| *number).collect();
    assert_eq!(numbers, Object::ALL.map(|object| object as u8));
    let of = |object: Object| {
        let found = all.iter().find(|(number, _)| *number == object as u8);
        found.map(|(_, text)| text.as_str()).expect("an object")
    };
    assert_eq!(of(Object::Version), "1.2.3");
    assert_eq!(of(Object::Serial), "00123456789abcdef000000f");
    assert_eq!(of(Object::MapVersion), "2");
    assert_eq!(of(Object::Motor), &MOTOR[..64]);
    assert_eq!(identified(1, 0).0, all[..3]);
    assert_eq!(identified(2, 0).0, all[..6]);
    assert_eq!(identified(3, 0x82).0, all[8..]);
    // No such object: from the beginning.
    assert_eq!(identified(1, 0x50).0, all[..3]);
    for (k, object) in Object::ALL.into_iter().enumerate() {
        assert_eq!(identified(4, object as u8).0, all[k..=k]);
    }
}

#[test]
fn what_no_identification_is_gets_an_exception() {
    assert_eq!(refused(&[UNIT, 43, 14, 4, 0x50]), 2, "no such object");
    assert_eq!(refused(&[UNIT, 43, 14, 0, 0]), 3, "no such group");
    assert_eq!(refused(&[UNIT, 43, 14, 1]), 3, "too short");
    assert_eq!(refused(&[UNIT, 43, 13, 1, 0]), 1, "another interface");
    assert_eq!(refused(&[UNIT, 43]), 1, "nothing");
}

/// A request for parts of files: file, first word, words.
fn file_request(parts: &[(u16, u16, u16)]) -> Vec<u8> {
    let mut request = vec![UNIT, 20, 7 * parts.len() as u8];
    for (file, first, words) in parts {
        request.push(6);
        for word in [file, first, words] {
            request.extend(word.to_be_bytes());
        }
    }
    request
}

#[test]
fn events_are_read_as_a_file_in_the_order_of_their_bytes() {
    let (_, data) = answered(&file_request(&[(EVENT_FILE, 16, MOST_FILE_WORDS)]));
    let bytes = 2 * usize::from(MOST_FILE_WORDS);
    assert_eq!(data.len(), 3 + bytes);
    assert_eq!(data[..3], [2 + bytes as u8, 1 + bytes as u8, 6]);
    let expected: Vec<u8> = (EVENT_BYTES..EVENT_BYTES + bytes)
        .map(|at| at as u8)
        .collect();
    assert_eq!(data[3..], expected);
    let (_, two) = answered(&file_request(&[(EVENT_FILE, 0, 1), (EVENT_FILE, 8, 2)]));
    assert_eq!(two, [10, 3, 6, 0, 1, 5, 6, 16, 17, 18, 19]);
}

#[test]
fn parts_of_files_that_do_not_exist_get_an_exception() {
    let end = (LOG_EVENTS * EVENT_BYTES as u32 / 2) as u16;
    assert_eq!(refused(&file_request(&[(2, 0, 1)])), 2, "no such file");
    assert_eq!(refused(&file_request(&[(EVENT_FILE, end, 1)])), 2);
    assert_eq!(refused(&file_request(&[(EVENT_FILE, end - 1, 2)])), 2);
    assert_eq!(refused(&file_request(&[(EVENT_FILE, 0, 0)])), 3);
    assert_eq!(
        refused(&file_request(&[(EVENT_FILE, 0, 125)])),
        3,
        "too long"
    );
    let twice = [(EVENT_FILE, 0, MOST_FILE_WORDS); 2];
    assert_eq!(refused(&file_request(&twice)), 3, "too long together");
    assert_eq!(refused(&[UNIT, 20, 7, 6, 0, 1, 0, 0]), 3, "too short");
    assert_eq!(refused(&[UNIT, 20, 0]), 3, "nothing asked");
}

#[test]
fn a_log_that_is_being_erased_is_busy() {
    let busy: ReadEvents = |_, _| false;
    let request = sealed(&file_request(&[(EVENT_FILE, 0, 16)]));
    let (answer, _) = ask_of(&mut Slave::new(UNIT), 0, &request, busy, &mut desk());
    assert_eq!(answer[..3], [UNIT, 20 | 0x80, 6]);
}

/// A master from elsewhere writes a block of registers.
fn write_block(desk: &mut Desk, first: u16, values: &[u16]) -> bool {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_set_holdings_bulk(first, values, &mut request)
        .expect("a request");
    let mut slave = Slave::new(UNIT);
    let (answer, command) = ask_of(&mut slave, 0, &request, counting, desk);
    assert_eq!(command, None);
    master.parse_ok(&answer).is_ok()
}

fn read_block(desk: &mut Desk, first: u16, count: u16) -> Vec<u16> {
    let mut master = master();
    let mut request = Vec::new();
    master
        .generate_get_holdings(first, count, &mut request)
        .expect("a request");
    let (answer, _) = ask_of(&mut Slave::new(UNIT), 0, &request, counting, desk);
    let mut words: Vec<u16> = Vec::new();
    master.parse_u16(&answer, &mut words).expect("an answer");
    words
}

#[test]
fn a_configuration_is_written_and_read_in_blocks_without_touching_what_holds() {
    let mut desk = desk();
    let active = desk.active().clone();
    let values: Vec<u16> = (0..CONFIGURATION_REGISTERS).map(|at| at ^ 0x1234).collect();
    for (k, part) in values.chunks(123).enumerate() {
        assert!(write_block(&mut desk, STAGED + 123 * k as u16, part));
    }
    let read: Vec<u16> = (0..CONFIGURATION_REGISTERS)
        .step_by(125)
        .flat_map(|at| {
            let count = 125.min(CONFIGURATION_REGISTERS - at);
            read_block(&mut desk, STAGED + at, count)
        })
        .collect();
    assert_eq!(read, values);
    assert_eq!(desk.active(), &active);
    let held = read_block(&mut desk, ACTIVE, 2);
    assert_eq!(
        held,
        [(active.words()[0] >> 16) as u16, active.words()[0] as u16]
    );
}

#[test]
fn blocks_beyond_the_staged_configuration_are_refused_whole() {
    let mut desk = desk();
    let before = desk.staged().clone();
    let end = STAGED + CONFIGURATION_REGISTERS;
    for first in [STAGED - 1, end - 1, ACTIVE, 2] {
        assert!(!write_block(&mut desk, first, &[1, 2]), "{first}");
    }
    assert_eq!(desk.staged(), &before);
    let [high, low] = (end - 1).to_be_bytes();
    let (function, data) = answered_at(&[UNIT, 3, high, low, 0, 2], &mut desk);
    assert_eq!((function, &data[..]), (0x83, &[2][..]));
}
