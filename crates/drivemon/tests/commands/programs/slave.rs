//! `drivemon board update` with the board's own slave on the other end of a pseudo-terminal. What becomes of a program on a board is
//! tested in `crates/program` with the board's receiver and loader, and on the virtual board.

use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use board::Desk;
use board::modbus::{
    Command, Field, Files, Identity, Image, MAP_VERSION, MAX_RESPONSE_BYTES, Memory, Slave,
};
use program::{Package, Seal, Version};
use serialport::{SerialPort, TTYPort};
use update::{Settled, UpdateState};

use super::*;

/// What a board tells of itself, and what it received.
struct Board {
    slave: Slave,
    desk: Desk,
    image: Image,
    received: Vec<u8>,
    ends_as: UpdateState,
}

impl Board {
    fn new(version: &str, ends_as: UpdateState) -> Self {
        let mut desk = Desk::blank();
        desk.tray().set_open(true);
        let mut image = Image::default();
        image.set_word(Field::MapVersion, MAP_VERSION);
        image.set_long(Field::ProgramVersion, Version::parse(version).0);
        Board {
            slave: Slave::new(1),
            desk,
            image,
            received: Vec::new(),
            ends_as,
        }
    }

    fn answer(&mut self, request: &[u8]) -> Vec<u8> {
        let nothing = |_: usize, _: &mut [u8]| false;
        let identity = Identity {
            version: "",
            revision: "",
            serial: [0; 3],
        };
        let mut memory = Memory {
            image: &self.image,
            identity: &identity,
            files: Files {
                events: &nothing,
                seconds: &nothing,
                capture: &nothing,
            },
            desk: &mut self.desk,
        };
        let mut response = [0; MAX_RESPONSE_BYTES];
        let (length, command) = self.slave.respond(0, request, &mut memory, &mut response);
        self.take_piece();
        if command == Some(Command::Install) {
            let seal = Seal::read(&self.received).expect("a program");
            self.image.set_word(Field::Update, self.ends_as as u16);
            self.image.set_word(Field::UpdateRefused, 5);
            self.image.set_long(Field::ProgramChecksum, seal.checksum);
        }
        response[..length].to_vec()
    }

    fn take_piece(&mut self) {
        let tray = self.desk.tray();
        while let Some(portion) = tray.portion() {
            self.received.truncate(portion.offset as usize);
            self.received.extend(portion.padded());
            tray.follow(Settled::Written(portion.end()));
        }
    }
}

/// Serves a board until it is told to end.
fn serve(mut board: Board, mut port: TTYPort, ended: Arc<AtomicBool>) -> JoinHandle<Board> {
    port.set_timeout(Duration::from_millis(10))
        .expect("a timeout");
    std::thread::spawn(move || {
        let (mut request, mut piece) = (Vec::new(), [0; 300]);
        while !ended.load(Ordering::Relaxed) {
            match port.read(&mut piece) {
                Ok(length) => request.extend(&piece[..length]),
                // Silence ends a request.
                Err(_) if request.is_empty() => {}
                Err(_) => {
                    let answer = board.answer(&std::mem::take(&mut request));
                    port.write_all(&answer).expect("an open terminal");
                }
            }
        }
        board
    })
}

/// Runs the command; the exit code, what was said, and what the board received.
fn update(board: Board, place: &Place, more: &[&str]) -> (Option<i32>, String, Vec<u8>) {
    let (master, host) = TTYPort::pair().expect("a pseudo-terminal");
    let port = host.name().expect("a name");
    let ended = Arc::new(AtomicBool::new(false));
    let served = serve(board, master, Arc::clone(&ended));
    let package = place.at("new.dmu");
    // A pseudo-terminal has no parity.
    let fixed = [
        "board",
        "update",
        text(&package),
        "--serial",
        &port,
        "--parity",
        "none",
    ];
    let done = drivemon(&[&fixed, more].concat());
    ended.store(true, Ordering::Relaxed);
    let board = served.join().expect("a board");
    drop(host);
    (
        done.status.code(),
        stdout(&done) + &stderr(&done),
        board.received,
    )
}

fn packaged(name: &str) -> Place {
    let place = Place::new(name);
    let (code, said) = place.package(&["--key", text(&place.at("own.key"))]);
    assert_eq!(code, Some(0), "{said}");
    place
}

#[test]
fn a_program_comes_over_as_it_was_packaged_and_is_waited_for() {
    let place = packaged("sent");
    let own = place.at("own.pub");
    let board = Board::new("1.2.0", UpdateState::Confirmed);
    let (code, said, received) = update(board, &place, &["--public-key", text(&own)]);
    assert_eq!(code, Some(0), "{said}");
    let package = Package::read(&place.at("new.dmu")).expect("a package");
    assert_eq!(received[..package.bytes().len()], *package.bytes());
    for words in [
        "board runs   version 1.2.0",
        "package      version 1.3.0",
        "version 1.3.0 runs and has confirmed itself",
    ] {
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn a_program_reads_what_became_of_it() {
    let place = packaged("json");
    let board = Board::new("1.2.0", UpdateState::Confirmed);
    let (code, said, _) = update(board, &place, &["--json", "-"]);
    assert_eq!(code, Some(0), "{said}");
    let told: serde_json::Value = serde_json::from_str(&said).expect("JSON and nothing else");
    for (key, value) in [
        ("format", "board-update/1"),
        ("board_version", "1.2.0"),
        ("package_version", "1.3.0"),
    ] {
        assert_eq!(told[key], value, "{said}");
    }
    assert_eq!(told["demo_key"], false, "{said}");
    for key in ["sent", "confirmed"] {
        assert_eq!(told[key], true, "{key}: {said}");
    }
}

#[test]
fn a_refusal_ends_with_2_and_what_to_do() {
    let place = packaged("refused");
    let board = Board::new("1.2.0", UpdateState::Refused);
    let (code, said, _) = update(board, &place, &[]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("not signed with this board's key; sign it with"),
        "{said}"
    );
    let board = Board::new("1.2.0", UpdateState::BroughtBack);
    let (code, said, _) = update(board, &place, &[]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("brought its program before back"), "{said}");
}

#[test]
fn a_person_who_does_not_wait_is_told_where_to_look() {
    let place = packaged("no-wait");
    let board = Board::new("1.2.0", UpdateState::Refused);
    let (code, said, received) = update(board, &place, &["--no-wait"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("`drivemon board read` shows Update"),
        "{said}"
    );
    assert!(!received.is_empty());
}

#[test]
fn nothing_is_sent_to_a_board_that_runs_a_newer_program() {
    let place = packaged("older");
    let board = Board::new("1.3.1", UpdateState::Confirmed);
    let (code, said, received) = update(board, &place, &[]);
    assert_eq!(code, Some(2), "{said}");
    assert!(
        said.contains("holds version 1.3.0, the board runs 1.3.1"),
        "{said}"
    );
    assert!(received.is_empty());
}
