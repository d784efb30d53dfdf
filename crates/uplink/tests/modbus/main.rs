//! The Modbus server: its map against the documentation, frames in any pieces, and masters that do what they should not.

mod document;
mod strangers;

use fleet::{Link, MotorId, MotorInfo, MotorState, Second};
use proptest::prelude::*;
use uplink::modbus::{
    BLOCK, Field, Frame, IN_A_UNIT, LARGEST_FRAME, Layout, Plant, Request, WORDS, address, answer,
    split,
};

fn state(name: &str, number: u32) -> MotorState {
    let id: MotorId = name.parse().expect("a name");
    MotorState {
        info: MotorInfo::new(id),
        last: Some(Second {
            start: 0x0102_0304,
            number,
            time_ms: 1_790_000_000_000,
            lamps: 0x0001_0001,
            speed_rpm: Some(1_455.5),
            ..Second::default()
        }),
        last_event: 70_000,
        link: Some(Link {
            up: true,
            time_ms: 0,
            why: String::new(),
        }),
        open_alarms: 2,
        unacknowledged: 1,
        worst: None,
    }
}

fn ask(plant: &Plant, unit: u8, data: &[u8]) -> Vec<u8> {
    let request = Request {
        transaction: 0xABCD,
        unit,
        data,
    };
    answer(&request, plant, 1_790_000_012_345).0
}

fn read(plant: &Plant, unit: u8, first: u16, count: u16) -> Vec<u8> {
    let [[a1, a0], [c1, c0]] = [first.to_be_bytes(), count.to_be_bytes()];
    ask(plant, unit, &[4, a1, a0, c1, c0])
}

/// Bytes of an answer as the standard draws them (MODBUS Messaging on TCP/IP V1.0b, 3.1.3).
#[test]
fn an_answer_is_what_the_standard_draws() {
    let plant = Plant::new(&[state("pump-7", 9)], Layout::Own);
    let number = read(&plant, 1, address(Field::Number), 2);
    assert_eq!(number, [0xAB, 0xCD, 0, 0, 0, 7, 1, 4, 4, 0, 0, 0, 9]);
    let age = read(&plant, 1, address(Field::Age), 2);
    assert_eq!(age[9..], [0, 0, 0, 12]);
    let speed = read(&plant, 1, address(Field::Speed), 2);
    assert_eq!(speed[9..], 1_455.5f32.to_be_bytes());
    let current = read(&plant, 1, address(Field::Current), 2);
    assert!(f32::from_be_bytes([current[9], current[10], current[11], current[12]]).is_nan());
    let name = read(&plant, 1, address(Field::Name), 4);
    assert_eq!(&name[9..], b"pump-7\0\0");
}

#[test]
fn what_does_not_exist_is_an_exception() {
    let plant = Plant::new(&[state("pump-7", 9)], Layout::Own);
    let code = |answer: Vec<u8>| (answer[7], answer[8]);
    assert_eq!(code(read(&plant, 1, WORDS, 1)), (0x84, 2));
    assert_eq!(code(read(&plant, 1, u16::MAX, 2)), (0x84, 2));
    assert_eq!(code(read(&plant, 1, 0, 0)), (0x84, 3));
    assert_eq!(code(read(&plant, 1, 0, 126)), (0x84, 3));
    assert_eq!(code(read(&plant, 2, 0, 1)), (0x84, 10));
    assert_eq!(code(read(&plant, 0, 0, 1)), (0x84, 10));
    assert_eq!(code(read(&plant, 249, 0, 1)), (0x84, 10));
    // Nothing can be written.
    for function in [5, 6, 15, 16, 22, 23] {
        assert_eq!(
            code(ask(&plant, 1, &[function, 0, 0, 0, 1])),
            (function | 0x80, 1)
        );
    }
}

/// The 601st motor is the first of unit 2 where units are shared, and unit 601 does not exist where they are not.
#[test]
fn every_motor_has_its_registers() {
    let motors: Vec<_> = (0..=IN_A_UNIT as u32)
        .map(|k| state(&format!("m{k}"), k + 1))
        .collect();
    let (own, shared) = (
        Plant::new(&motors, Layout::Own),
        Plant::new(&motors, Layout::Shared),
    );
    let at = address(Field::Number);
    for k in [0u16, 1, 246, 599] {
        let number = read(&shared, 1, k * BLOCK + at, 2);
        assert_eq!(number[9..], (u32::from(k) + 1).to_be_bytes());
    }
    assert_eq!(read(&shared, 2, at, 2)[9..], 601u32.to_be_bytes());
    assert_eq!(read(&shared, 2, BLOCK, 1)[7], 0x84);
    assert_eq!(read(&shared, 2, WORDS, 1)[7], 0x84);
    assert_eq!(read(&shared, 1, 599 * BLOCK + WORDS, 1)[7], 0x84);
    let between = vec![0; usize::from(2 * (BLOCK - WORDS))];
    assert_eq!(read(&shared, 1, WORDS, BLOCK - WORDS)[9..], between);
    assert_eq!(read(&own, 247, at, 2)[9..], 247u32.to_be_bytes());
    assert_eq!(read(&own, 248, at, 2)[8], 10);
    assert_eq!(read(&own, 1, BLOCK + at, 2)[8], 2);
}

proptest! {
    /// A stream of requests comes out as it went in, wherever it was cut.
    #[test]
    fn requests_come_out_whole(
        requests in prop::collection::vec((any::<u16>(), any::<u8>(), prop::collection::vec(any::<u8>(), 1..253)), 1..8),
        piece in 1..300usize,
    ) {
        let mut stream = Vec::new();
        for (transaction, unit, data) in &requests {
            stream.extend(transaction.to_be_bytes());
            stream.extend([0, 0]);
            stream.extend((data.len() as u16 + 1).to_be_bytes());
            stream.push(*unit);
            stream.extend(data);
        }
        let (mut buffer, mut found) = (Vec::new(), Vec::new());
        for bytes in stream.chunks(piece) {
            buffer.extend_from_slice(bytes);
            while let Frame::Whole(request, length) = split(&buffer) {
                found.push((request.transaction, request.unit, request.data.to_vec()));
                buffer.drain(..length);
            }
        }
        prop_assert_eq!(found, requests);
        prop_assert!(buffer.is_empty());
    }

    /// Whatever is asked: an answer with the request's numbers, of the length that it says, and no longer than allowed.
    #[test]
    fn every_request_has_a_sound_answer(shared in any::<bool>(), unit in any::<u8>(), data in prop::collection::vec(any::<u8>(), 0..253)) {
        let plant = Plant::new(&[state("a", 1), state("b", 2)], if shared { Layout::Shared } else { Layout::Own });
        let answer = ask(&plant, unit, &data);
        prop_assert!(answer.len() <= LARGEST_FRAME);
        prop_assert_eq!(&answer[..4], &[0xAB, 0xCD, 0, 0]);
        prop_assert_eq!(usize::from(u16::from_be_bytes([answer[4], answer[5]])), answer.len() - 6);
        prop_assert_eq!(answer[6], unit);
    }
}
