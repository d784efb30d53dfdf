//! What comes over wires: frames of the board, requests to it.

use board::modbus::{
    BoardStatus, Collector, Files, Identity, Image, MAX_RESPONSE_BYTES, Memory, Slave, Status,
    UNLOCK_KEY,
};
use board::{
    CAPTURE_BYTES, Desk, EVENT_BYTES, LOG_EVENTS, MAX_FRAME_BYTES, Message, SECOND_BYTES, SECONDS,
    Shown, crc32,
};
use live::Decoder;
use monitor::Report;

/// The first byte says how the rest arrives: in pieces of that many bytes, or from 128 on as contents that are framed
/// and checksummed here, so that what is behind the checksum is reached.
pub(crate) fn telemetry(bytes: &[u8]) {
    let Some((way, rest)) = bytes.split_first() else {
        return;
    };
    let mut decoder = Decoder::default();
    let messages: Vec<Message> = if *way < 128 {
        let pieces = rest.chunks(usize::from(*way) + 1);
        pieces.flat_map(|piece| decoder.take(piece)).collect()
    } else {
        let pieces = rest.chunks(usize::from(*way) - 100);
        pieces
            .flat_map(|piece| decoder.take(&framed(piece)))
            .collect()
    };
    for message in messages {
        if let Message::Window(frame) = message {
            let _lamps: Vec<_> = (0..8).map(|lamp| frame.lamp(lamp)).collect();
            let again = frame.encode(&mut [0; MAX_FRAME_BYTES]).to_vec();
            assert!(Message::decode(&again).is_ok(), "{frame:?}");
        }
    }
}

/// COBS by its definition (Cheshire and Baker 1999): each code byte counts to the next zero.
fn framed(content: &[u8]) -> Vec<u8> {
    let plain = [content, &crc32(content).to_le_bytes()].concat();
    let mut frame = Vec::new();
    for part in plain.split(|byte| *byte == 0) {
        frame.push(part.len() as u8 + 1);
        frame.extend_from_slice(part);
    }
    frame.push(0);
    frame
}

/// Requests of a length byte and a body each; the checksum is put behind unless the length's top bit says otherwise.
pub(crate) fn modbus(bytes: &[u8]) {
    let image = Status::default().take(
        &Report::default(),
        &Shown::default(),
        &BoardStatus::default(),
    );
    let (mut slave, mut desk) = (Slave::new(1), Desk::blank());
    let active = desk.active().clone();
    let (mut rest, mut now_ms, mut key_seen) = (bytes, 0u32, false);
    while let Some((length, tail)) = rest.split_first() {
        let body = &tail[..tail.len().min(usize::from(*length & 0x7F))];
        rest = &tail[body.len()..];
        let request = if *length < 128 {
            sealed(body)
        } else {
            body.to_vec()
        };
        key_seen |= request
            .windows(2)
            .any(|word| word == UNLOCK_KEY.to_be_bytes());
        let command = ask(&mut slave, now_ms, &request, &image, &mut desk);
        assert!(
            !command || key_seen,
            "a command without the key: {request:x?}"
        );
        now_ms = now_ms.wrapping_add(u32::from(*length) * 97);
    }
    assert_eq!(desk.active(), &active, "what holds was changed by writing");
}

const LOG_BYTES: usize = LOG_EVENTS as usize * EVENT_BYTES;
const SECONDS_BYTES: usize = SECONDS as usize * SECOND_BYTES;
const IDENTITY: Identity = Identity {
    version: "0.1.0",
    revision: "",
    serial: [1, 2, 3],
};

/// A file of this many bytes.
fn within<const BYTES: usize>(at: usize, bytes: &mut [u8]) -> bool {
    assert!(at + bytes.len() <= BYTES, "beyond the file: {at}");
    true
}

/// Whether a request became a command; the answer must be sound.
fn ask(slave: &mut Slave, now_ms: u32, request: &[u8], image: &Image, desk: &mut Desk) -> bool {
    let mut collector = Collector::default();
    collector.push(request);
    let mut response = [0; MAX_RESPONSE_BYTES];
    let mut memory = Memory {
        image,
        identity: &IDENTITY,
        files: Files {
            events: &within::<LOG_BYTES>,
            seconds: &within::<SECONDS_BYTES>,
            capture: &within::<CAPTURE_BYTES>,
        },
        desk: &mut *desk,
    };
    let (length, command) = slave.respond(now_ms, collector.frame(), &mut memory, &mut response);
    let answer = &response[..length];
    if let Some((body, checksum)) = answer.split_last_chunk::<2>() {
        assert_eq!(checksum, &crc(body).to_le_bytes(), "{answer:x?}");
        assert_eq!(body[0], 1);
    }
    command.is_some()
}

fn sealed(body: &[u8]) -> Vec<u8> {
    [body, &crc(body).to_le_bytes()].concat()
}

/// The checksum bit by bit, after the protocol's own description (Modbus over serial line V1.02, 6.2.2).
fn crc(body: &[u8]) -> u16 {
    body.iter().fold(0xFFFF_u16, |crc, byte| {
        (0..8).fold(crc ^ u16::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xA001 } else { 0 }
        })
    })
}
