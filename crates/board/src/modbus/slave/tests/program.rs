//! Pieces of a program: function 21.

use super::*;
use crate::modbus::{MOST_PROGRAM_WORDS, PROGRAM_FILE, PROGRAM_REST_FILE};

/// A request to write a piece, as the protocol draws it.
fn piece_request(file: u16, first: u16, piece: &[u8]) -> Vec<u8> {
    let mut request = vec![UNIT, 21, 7 + piece.len() as u8, 6];
    for word in [file, first, piece.len() as u16 / 2] {
        request.extend(word.to_be_bytes());
    }
    [&request, piece].concat()
}

/// A slave and a desk whose tray is open.
struct Line {
    slave: Slave,
    desk: Desk,
    now_ms: u32,
}

impl Line {
    fn open() -> Self {
        let mut desk = desk();
        desk.tray().set_open(true);
        Line {
            slave: Slave::new(UNIT),
            desk,
            now_ms: 0,
        }
    }

    /// The code of an exception; 0 where the request came back as the protocol demands.
    fn ask(&mut self, request: &[u8]) -> u8 {
        let sent = sealed(request);
        let (answer, command) = ask_of(
            &mut self.slave,
            self.now_ms,
            &sent,
            &counting,
            &mut self.desk,
        );
        assert_eq!(command, None);
        match answer[1] {
            0x95 => {
                assert_eq!(answer, sealed(&[UNIT, 0x95, answer[2]]));
                answer[2]
            }
            _ => {
                assert_eq!(answer, sent);
                0
            }
        }
    }

    fn unlock(&mut self) {
        assert_eq!(self.ask(&[UNIT, 6, 0, 0, 0x4D, 0x4D]), 0);
    }

    fn is_unlocked(&mut self) -> bool {
        let (answer, _) = ask_of(
            &mut self.slave,
            self.now_ms,
            &sealed(&[UNIT, 3, 0, 0, 0, 1]),
            &counting,
            &mut self.desk,
        );
        answer[4] == 1
    }

    /// What lies in the tray goes to flash.
    fn settle(&mut self) -> (u32, Vec<u8>) {
        let tray = self.desk.tray();
        let (first, mut bytes) = (tray.portion().expect("a piece").offset, Vec::new());
        while let Some(portion) = tray.portion() {
            bytes.extend_from_slice(portion.padded());
            tray.settle(portion.end());
        }
        (first, bytes)
    }
}

/// What of a program begins at byte `from`.
fn program(from: usize, length: usize) -> Vec<u8> {
    (from..from + length)
        .map(|k| (k * 31 % 251) as u8)
        .collect()
}

#[test]
fn a_program_comes_in_pieces_that_are_echoed_and_lie_in_the_tray_as_they_came() {
    let mut line = Line::open();
    line.unlock();
    for (k, first) in (0..5).map(|k| (k, 120 * k)) {
        let piece = program(240 * k, 240);
        assert_eq!(
            line.ask(&piece_request(PROGRAM_FILE, first as u16, &piece)),
            0
        );
        assert_eq!(line.settle(), (240 * k as u32, piece));
        line.now_ms += 9_000;
    }
    assert_eq!(usize::from(MOST_PROGRAM_WORDS), 120);
}

#[test]
fn the_second_file_goes_on_where_the_first_one_ends() {
    let mut line = Line::open();
    line.unlock();
    let mut sent = 0;
    while sent < 140_000 {
        let length = 240.min(131_072 - sent % 131_072);
        let (file, first) = (
            PROGRAM_FILE + (sent >> 17) as u16,
            (sent % 131_072 / 2) as u16,
        );
        let piece = program(sent, length);
        assert_eq!(line.ask(&piece_request(file, first, &piece)), 0, "{sent}");
        assert_eq!(line.settle(), (sent as u32, piece));
        sent += length;
    }
    assert!(line.desk.tray().lay(sent as u32, &[0; 8]).is_ok());
}

#[test]
fn a_transfer_needs_the_key_once_and_goes_on_while_pieces_come() {
    let mut line = Line::open();
    let first = piece_request(PROGRAM_FILE, 0, &program(0, 240));
    let second = piece_request(PROGRAM_FILE, 120, &program(240, 240));
    assert_eq!(line.ask(&first), 1, "locked");
    line.unlock();
    assert_eq!(line.ask(&second), 1, "the key is for a first piece");
    assert_eq!(line.ask(&first), 0);
    assert!(!line.is_unlocked(), "the key is used up");
    line.settle();
    line.now_ms += 10_001;
    assert_eq!(line.ask(&second), 1, "too late");
    assert_eq!(line.ask(&first), 1, "too late");
    line.unlock();
    assert_eq!(line.ask(&first), 0);
    line.now_ms += 10_000;
    assert_eq!(line.ask(&second), 6, "the first one still lies there");
    line.now_ms += 10_000;
    line.settle();
    assert_eq!(line.ask(&second), 0);
    line.settle();
    assert_eq!(line.ask(&first), 0, "anew within a transfer");
}

#[test]
fn the_key_outlasts_a_first_piece_for_which_the_board_is_busy() {
    let mut line = Line::open();
    line.desk.tray().set_open(false);
    line.unlock();
    let first = piece_request(PROGRAM_FILE, 0, &program(0, 16));
    assert_eq!(line.ask(&first), 6);
    assert!(line.is_unlocked());
    line.desk.tray().set_open(true);
    assert_eq!(line.ask(&first), 0);
}

#[test]
fn what_is_no_next_piece_gets_an_exception_and_is_not_laid_down() {
    let mut line = Line::open();
    line.unlock();
    assert_eq!(
        line.ask(&piece_request(PROGRAM_FILE, 0, &program(0, 240))),
        0
    );
    line.settle();
    let good = piece_request(PROGRAM_FILE, 120, &program(240, 16));
    let with = |at: usize, byte: u8| {
        let mut request = good.clone();
        request[at] = byte;
        request
    };
    for (request, code, what) in [
        (piece_request(PROGRAM_FILE, 124, &[1; 8]), 2, "a gap"),
        (
            piece_request(PROGRAM_FILE - 1, 120, &[1; 8]),
            2,
            "a file to be read",
        ),
        (
            piece_request(PROGRAM_REST_FILE + 1, 0, &[1; 8]),
            2,
            "no such file",
        ),
        (
            piece_request(PROGRAM_FILE, 65_532, &[1; 10]),
            2,
            "beyond the file",
        ),
        (
            piece_request(PROGRAM_FILE, 118, &[1; 8]),
            3,
            "between two double words",
        ),
        (piece_request(PROGRAM_FILE, 120, &[]), 3, "nothing"),
        (piece_request(PROGRAM_FILE, 120, &[1; 242]), 3, "too long"),
        (with(2, 7), 3, "fewer bytes than there are"),
        (with(3, 5), 2, "another type of reference"),
        (with(9, 9), 3, "more words than there are"),
        (good[..good.len() - 1].to_vec(), 3, "cut off"),
        ([&good[..], &good[3..]].concat(), 3, "two pieces at once"),
        (good[..9].to_vec(), 3, "no piece"),
        (good[..2].to_vec(), 3, "nothing at all"),
    ] {
        assert_eq!(line.ask(&request), code, "{what}");
        assert_eq!(line.desk.tray().portion(), None, "{what}");
    }
    assert_eq!(line.ask(&good), 0);
}

#[test]
fn a_transfer_that_failed_is_told_as_a_failure() {
    let mut line = Line::open();
    line.unlock();
    assert_eq!(
        line.ask(&piece_request(PROGRAM_FILE, 0, &program(0, 240))),
        0
    );
    line.desk.tray().fail();
    assert_eq!(
        line.ask(&piece_request(PROGRAM_FILE, 120, &program(240, 240))),
        4
    );
    assert_eq!(
        line.ask(&piece_request(PROGRAM_FILE, 0, &program(0, 240))),
        0
    );
}
