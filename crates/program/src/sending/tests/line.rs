//! A board on a line: the slave, the receiving side and the loader are those of the board; time, flash and what the line
//! loses are simulated.

use std::io::{self, Read, Write};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use board::modbus::{
    Collector, Command, Field, Files, Identity, Image, MAP_VERSION, MAX_RESPONSE_BYTES, Memory,
    Slave,
};
use board::{Desk, Line};
use live::{ModbusLine, Wire};
use update::layout::{PAGE_BYTES, PROGRAM, PROGRAM_PAGES};
use update::{Due, Next, PublicKey, Seal, UpdateState, Updater};

use super::super::Pace;
use super::flash::Chip;

const UNIT: u8 = 1;
/// A block of samples.
const BLOCK: Duration = Duration::from_micros(3_200);
/// 11 bits at 19 200 bit/s.
const BYTE: Duration = Duration::from_micros(573);
/// How long a start takes, and an exchange by the loader.
const START: Duration = Duration::from_secs(2);
const EXCHANGE: Duration = Duration::from_secs(30);
const IDENTITY: Identity = Identity {
    version: "1.2.3",
    revision: "",
    serial: [1, 2, 3],
};

/// What goes wrong, by the number of the request.
#[derive(Clone, Copy, Debug, Default)]
pub struct Faults {
    /// Every so many-th request is lost; 0: none.
    pub lost_requests: usize,
    /// Every so many-th answer is lost.
    pub lost_answers: usize,
    /// Every so many-th answer is damaged.
    pub damaged_answers: usize,
    /// Before this request the board starts again.
    pub restart_at: usize,
    /// Answers to these requests, the first and the last, are lost.
    pub dark: (usize, usize),
    /// From this request on the line is dead.
    pub dead_from: usize,
    /// Somebody wants to stop from this request on.
    pub stop_at: usize,
    /// The new program doubts itself all the time.
    pub doubts: bool,
    /// The program knows nothing of updates: it has fewer registers.
    pub unable: bool,
}

/// The board.
pub struct Board {
    pub chip: Chip,
    pub faults: Faults,
    pub requests: usize,
    pub starts: usize,
    key: PublicKey,
    slave: Slave,
    desk: Desk,
    updater: Updater<Chip>,
    now: Duration,
    /// Of the next block, the next second, and the loader's end.
    block: Duration,
    second: Duration,
    dark_until: Duration,
    request: Vec<u8>,
    answer: Vec<u8>,
}

impl Board {
    fn new(running: &[u8], key: PublicKey, faults: Faults) -> Self {
        let chip = Chip::new();
        chip.whole(|flash| {
            flash.bytes[PROGRAM as usize..][..running.len()].copy_from_slice(running)
        });
        Board {
            updater: Updater::open(chip.clone(), chip.clone()),
            chip,
            faults,
            requests: 0,
            starts: 0,
            key,
            slave: Slave::new(UNIT),
            desk: Desk::blank(),
            now: Duration::ZERO,
            block: Duration::ZERO,
            second: Duration::ZERO,
            dark_until: Duration::ZERO,
            request: Vec::new(),
            answer: Vec::new(),
        }
    }

    /// What lies in the program's place.
    pub fn runs(&self) -> Seal {
        let place = self.chip.whole(|flash| {
            flash.bytes[PROGRAM as usize..][..(PROGRAM_PAGES * PAGE_BYTES) as usize].to_vec()
        });
        let seal = Seal::read(&place).expect("a program");
        seal.check(&place).expect("a whole program");
        seal
    }

    fn restart(&mut self) {
        self.starts += 1;
        let key = self.key;
        let before = self.runs();
        let next = self.chip.whole(|flash| update::start(flash, &key));
        assert_eq!(next, Next::Program);
        self.updater = Updater::open(self.chip.clone(), self.chip.clone());
        (self.slave, self.desk) = (Slave::new(UNIT), Desk::blank());
        let exchanged = before != self.runs();
        self.dark_until = self.now + if exchanged { EXCHANGE } else { START };
    }

    /// Time passes, block by block and second by second.
    fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        while self.block < end {
            self.now = self.block;
            self.block += BLOCK;
            if self.now < self.dark_until {
                continue;
            }
            self.between_blocks();
            if self.second < self.now {
                self.second = self.now + Duration::from_secs(1);
                self.trial();
            }
        }
        self.now = end;
    }

    fn trial(&mut self) {
        match self.updater.second(self.faults.doubts) {
            Some(Due::Confirm) => self.updater.confirm(),
            Some(Due::GiveUp) => self.restart(),
            None => {}
        }
    }

    fn between_blocks(&mut self) {
        let tray = self.desk.tray();
        tray.set_open(self.updater.is_open());
        let portion = tray.portion();
        tray.follow(self.updater.step(portion.as_ref()));
        if self.updater.state() == UpdateState::Asked && self.updater.ask(None) {
            self.restart();
        }
    }

    fn image(&self) -> Image {
        let mut image = Image::default();
        let seal = self.runs();
        image.set_word(Field::MapVersion, MAP_VERSION);
        image.set_long(Field::ProgramChecksum, seal.checksum);
        image.set_long(Field::ProgramVersion, seal.version.0);
        image.set_word(Field::Update, self.updater.state() as u16);
        let refused = self.updater.refused().map_or(0, |refused| refused as u16);
        image.set_word(Field::UpdateRefused, refused);
        let left = self.updater.seconds_left().unwrap_or(0);
        image.set_word(Field::UpdateTrial, left);
        image
    }

    fn respond(&mut self) {
        self.requests += 1;
        let Faults {
            restart_at,
            dead_from,
            ..
        } = self.faults;
        let request = std::mem::take(&mut self.request);
        self.pass(BYTE * request.len() as u32);
        if self.requests == restart_at {
            self.restart();
        }
        let dead = dead_from > 0 && self.requests >= dead_from;
        let is_lost = self.falls_on(self.faults.lost_requests);
        if dead || is_lost || self.now < self.dark_until {
            return;
        }
        self.answer = self.answer_to(&request);
        let (first, last) = self.faults.dark;
        let dark = (first..=last).contains(&self.requests);
        if dark || self.falls_on(self.faults.lost_answers) {
            self.answer.clear();
        }
        if self.falls_on(self.faults.damaged_answers) && !self.answer.is_empty() {
            self.answer[1] ^= 4;
        }
        self.pass(BYTE * self.answer.len() as u32);
    }

    fn falls_on(&self, every: usize) -> bool {
        every > 0 && self.requests.is_multiple_of(every)
    }

    fn answer_to(&mut self, request: &[u8]) -> Vec<u8> {
        if self.faults.unable && request.get(1) == Some(&4) && request[5] > 1 {
            let reads_all = sealed(&[UNIT, 0x84, 2]);
            return reads_all;
        }
        let mut collector = Collector::default();
        collector.push(request);
        let nothing = |_: usize, _: &mut [u8]| false;
        let image = self.image();
        let mut memory = Memory {
            image: &image,
            identity: &IDENTITY,
            files: Files {
                events: &nothing,
                seconds: &nothing,
                capture: &nothing,
            },
            desk: &mut self.desk,
        };
        let mut response = [0; MAX_RESPONSE_BYTES];
        let now_ms = self.now.as_millis() as u32;
        let (length, command) =
            self.slave
                .respond(now_ms, collector.frame(), &mut memory, &mut response);
        if command == Some(Command::Install) {
            self.updater.install(None);
        }
        response[..length].to_vec()
    }
}

/// With the protocol's checksum, bit by bit.
fn sealed(frame: &[u8]) -> Vec<u8> {
    let bits = |crc: u16, _| crc >> 1 ^ if crc & 1 == 1 { 0xA001 } else { 0 };
    let crc = frame
        .iter()
        .fold(!0, |crc, byte| (0..8).fold(crc ^ u16::from(*byte), bits));
    [frame, &crc.to_le_bytes()].concat()
}

/// The host's end: a wire for the master, and a clock.
#[derive(Clone)]
pub struct Shared(pub Arc<Mutex<Board>>, Duration);

impl Shared {
    pub fn new(running: &[u8], key: PublicKey, faults: Faults) -> Self {
        let board = Board::new(running, key, faults);
        Shared(Arc::new(Mutex::new(board)), Duration::ZERO)
    }

    pub fn line(&self) -> ModbusLine {
        ModbusLine::over(Box::new(self.clone()), Line::default())
    }

    pub fn look<T>(&self, at: impl FnOnce(&mut Board) -> T) -> T {
        at(&mut self.0.lock().expect("sound"))
    }
}

impl Read for Shared {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let patience = self.1;
        self.look(|board| {
            if board.answer.is_empty() {
                board.pass(patience);
                return Err(io::ErrorKind::TimedOut.into());
            }
            let length = board.answer.len().min(bytes.len());
            bytes[..length].copy_from_slice(&board.answer[..length]);
            board.answer.drain(..length);
            Ok(length)
        })
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.look(|board| board.request.extend(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.look(Board::respond);
        Ok(())
    }
}

impl Wire for Shared {
    fn forget(&mut self) -> io::Result<()> {
        self.look(|board| board.answer.clear());
        Ok(())
    }

    fn set_patience(&mut self, patience: Duration) -> io::Result<()> {
        self.1 = patience;
        Ok(())
    }
}

impl Pace for Shared {
    fn pause(&mut self, time: Duration) {
        self.look(|board| board.pass(time));
    }

    fn now(&self) -> Duration {
        self.look(|board| board.now)
    }

    fn is_stopped(&self) -> bool {
        self.look(|board| board.faults.stop_at > 0 && board.requests >= board.faults.stop_at)
    }
}
