//! The slave against a master from elsewhere (`rmodbus`), and against a million frames of rubbish.

use std::vec::Vec;

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rmodbus::ModbusProto;
use rmodbus::client::ModbusRequest;

use super::super::entry::Field;
use super::super::map::{Image, WORDS, address};
use super::super::memory::{File, Files, Identity};
use super::*;
use crate::configuration::Configuration;
use crate::image::{IMAGE_WORDS, MotorImage};

mod configuration;
mod objects;
mod program;

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

/// A ring in which every byte is its own place's complement.
fn seconds(from: usize, bytes: &mut [u8]) -> bool {
    counting(from, bytes);
    bytes.iter_mut().for_each(|byte| *byte = !*byte);
    true
}

fn ask(slave: &mut Slave, now_ms: u32, request: &[u8]) -> (Vec<u8>, Option<Command>) {
    ask_of(slave, now_ms, request, &counting, &mut Desk::blank())
}

fn ask_of(
    slave: &mut Slave,
    now_ms: u32,
    request: &[u8],
    events: &dyn File,
    desk: &mut Desk,
) -> (Vec<u8>, Option<Command>) {
    let mut response = [0; MAX_RESPONSE_BYTES];
    let mut memory = Memory {
        image: &image(),
        identity: &IDENTITY,
        files: Files {
            events,
            seconds: &seconds,
            capture: &counting,
        },
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
    /// The first piece of a program came under the key.
    receives: bool,
    /// Where a piece lies that nobody has taken yet, and where the next one begins.
    lies: Option<(u32, Vec<u8>)>,
    next: u32,
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
                (1, [0, code @ (1..=9)]) if self.unlocked => {
                    self.unlocked = false;
                    command = Some(Command::ALL[usize::from(code) - 1]);
                }
                _ => return None,
            }
        }
        command
    }

    /// A piece that may be laid down now: of a sealed frame that says what it is.
    fn lays(&mut self, frame: &[u8]) -> Option<(u32, Vec<u8>)> {
        let body = frame.get(..frame.len().checked_sub(2)?)?;
        if sealed(body) != frame {
            return None;
        }
        let [
            UNIT,
            21,
            bytes,
            6,
            0,
            file @ (4 | 5),
            a,
            b,
            0,
            words @ 1..=120,
            piece @ ..,
        ] = body
        else {
            return None;
        };
        let offset = (u32::from(*file) - 4) * 131_072 + 2 * u32::from(u16::from_be_bytes([*a, *b]));
        let shape =
            piece.len() == 2 * usize::from(*words) && usize::from(*bytes) == 7 + piece.len();
        let may = self.receives || offset == 0 && self.unlocked;
        let place = self.lies.is_none() && offset <= self.next && offset % 8 == 0;
        if !shape || !may || !place {
            return None;
        }
        self.unlocked &= self.receives;
        self.receives = true;
        Some((offset, piece.to_vec()))
    }
}

fn random_frame(random: &mut Pcg64Mcg) -> Vec<u8> {
    let length = random.random_range(0..=MAX_REQUEST_BYTES + 8);
    let mut bytes: Vec<u8> = (0..length).map(|_| random.random()).collect();
    let values = [0, 1, 2, 3, 9, 0x4D, 0x4D, random.random()];
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

/// A piece of at most one portion that lies in the tray.
fn lying(tray: &update::Tray) -> Option<(u32, Vec<u8>)> {
    let portion = tray.portion()?;
    let length = (portion.end() - portion.offset) as usize;
    Some((portion.offset, portion.padded()[..length].to_vec()))
}

/// Of the right shape or nearly so.
fn near_request(mut pick: impl FnMut() -> u8) -> Vec<u8> {
    match pick() % 4 {
        0 => vec![UNIT, 3 + pick() % 2, 0, pick(), 0, pick()],
        1 => vec![UNIT, 6, 0, pick() % 2, pick(), pick()],
        2 => {
            let count = 1 + pick() % 2;
            let mut frame = vec![UNIT, 16, 0, pick() % 2, 0, count, 2 * count];
            frame.extend((0..2 * count + pick() % 2).map(|_| pick()));
            frame
        }
        _ => {
            let words = pick() % 4;
            let mut frame = vec![
                UNIT,
                21,
                7 + 2 * words,
                6,
                0,
                4 + pick() % 2,
                0,
                4 * (pick() % 3),
                0,
                words,
            ];
            frame.extend((0..2 * words + pick() % 2).map(|_| pick()));
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
    let (mut commands, mut pieces) = (0, 0);
    desk.tray().set_open(true);
    for round in 0..1_000_000 {
        let frame = random_frame(&mut random);
        let mut collector = Collector::default();
        frame.chunks(7).for_each(|bytes| collector.push(bytes));
        let (_, command) = ask_of(&mut slave, 0, collector.frame(), &counting, &mut desk);
        let received = if frame.len() > MAX_REQUEST_BYTES {
            &[]
        } else {
            &frame[..]
        };
        assert_eq!(command, law.allows(received), "frame {round}: {frame:02x?}");
        commands += u32::from(command.is_some());
        if let Some((offset, piece)) = law.lays(received) {
            law.lies = Some((offset, piece));
            pieces += 1;
        }
        assert_eq!(lying(desk.tray()), law.lies, "frame {round}: {frame:02x?}");
        if round % 3 == 0
            && let Some((offset, piece)) = law.lies.take()
        {
            law.next = offset + piece.len() as u32;
            desk.tray().settle(law.next);
        }
    }
    assert!(
        commands > 100,
        "only {commands} commands: the frames are too far from real ones"
    );
    assert!(pieces > 100, "only {pieces} pieces of a program");
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
    let (answer, _) = ask_of(&mut slave, 0, &sealed(request), &counting, desk);
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
