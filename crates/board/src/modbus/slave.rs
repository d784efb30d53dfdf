//! The protocol: requests in, answers out, and commands behind an unlock.

use crc::{CRC_16_MODBUS, Crc, NoTable};
use heapless::Vec;

use super::answer::{Answer, MAX_RESPONSE_BYTES};
use super::exception::Exception;
use super::file::{self, Piece};
use super::identity;
use super::memory::Memory;
use crate::configuration::Desk;

const CRC: Crc<u16, NoTable> = Crc::<u16, NoTable>::new(&CRC_16_MODBUS);
/// Longest frame of the protocol.
pub const MAX_REQUEST_BYTES: usize = 256;
/// What must be written to holding register 0 before a command.
pub const UNLOCK_KEY: u16 = 0x4D4D;
/// How long a command may follow the key, ms.
const UNLOCK_MS: u32 = 10_000;
/// How long a piece of a program may follow the one before, ms.
const PIECE_MS: u32 = 10_000;
const KEY_REGISTER: u16 = 0;
const COMMAND_REGISTER: u16 = 1;
const HOLDING_REGISTERS: u16 = 2;

const READ_HOLDING: u8 = 3;
const READ_INPUT: u8 = 4;
const WRITE_ONE: u8 = 6;
const WRITE_MANY: u8 = 16;
const READ_FILE: u8 = 20;
const WRITE_FILE: u8 = 21;
const IDENTIFY: u8 = 43;

/// What a master may ask for beside reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Command {
    /// Forget latched lamps, as a short press of the button.
    Acknowledge = 1,
    /// Learn from the running motor, as a very long press.
    Learn = 2,
    /// Write the option bytes and start again.
    Prepare = 3,
    /// Check the configuration that was written and put it on trial.
    Commit = 4,
    /// Store the configuration on trial.
    Confirm = 5,
    /// End the trial: what held before it holds again.
    Discard = 6,
    /// Put the motor constants that were compiled in on trial; the line stays.
    CommitCompiled = 7,
    /// The samples around an alarm are fetched: wait for the next one.
    ReleaseCapture = 8,
    /// Check the program that was received, and let the loader exchange it for the one that runs.
    Install = 9,
}

impl Command {
    /// All of them, in the order of their numbers.
    pub const ALL: [Command; 9] = [
        Command::Acknowledge,
        Command::Learn,
        Command::Prepare,
        Command::Commit,
        Command::Confirm,
        Command::Discard,
        Command::CommitCompiled,
        Command::ReleaseCapture,
        Command::Install,
    ];

    fn by_number(number: u16) -> Option<Self> {
        let numbered = |command: &Command| *command as u16 == number;
        Self::ALL.into_iter().find(numbered)
    }
}

/// The slave's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slave {
    unit: u8,
    unlocked_at_ms: Option<u32>,
    /// When the last piece of a program came whose first one came under the key.
    piece_at_ms: Option<u32>,
}

impl Slave {
    /// Answers to another address from now on, 1..=247.
    pub fn set_unit(&mut self, unit: u8) {
        self.unit = unit;
    }

    /// A locked slave with the address `unit`, 1..=247.
    pub fn new(unit: u8) -> Self {
        Slave {
            unit,
            unlocked_at_ms: None,
            piece_at_ms: None,
        }
    }

    /// Takes what came between two silences at time `now_ms` (wrapping) and writes the answer. Its length is 0 where the
    /// protocol demands silence: damaged frames, other addresses, broadcasts.
    #[inline(never)]
    pub fn respond(
        &mut self,
        now_ms: u32,
        request: &[u8],
        memory: &mut Memory<'_>,
        response: &mut [u8; MAX_RESPONSE_BYTES],
    ) -> (usize, Option<Command>) {
        let Some((function, data)) = self.unwrap(request) else {
            return (0, None);
        };
        let mut answer = Answer::new(response);
        answer.push(self.unit);
        answer.push(function);
        let mut command = None;
        let outcome = match function {
            READ_FILE => file::read(data, memory.files, &mut answer),
            WRITE_FILE => self.write_file(now_ms, data, memory.desk, &mut answer),
            IDENTIFY => identity::read(data, memory, &mut answer),
            _ => self.execute(now_ms, function, data, memory, &mut answer, &mut command),
        };
        if let Err(exception) = outcome {
            answer.clear();
            answer.push(self.unit);
            answer.push(function | 0x80);
            answer.push(exception as u8);
        }
        let checksum = CRC.checksum(answer.written());
        answer.push_word(checksum.swap_bytes());
        (answer.length(), command)
    }

    /// Function and data of a sound frame for this slave.
    fn unwrap<'a>(&self, request: &'a [u8]) -> Option<(u8, &'a [u8])> {
        let (frame, checksum) = request.split_last_chunk::<2>()?;
        let sound = CRC.checksum(frame).to_le_bytes() == *checksum;
        match frame {
            [unit, function, data @ ..] if sound && *unit == self.unit => Some((*function, data)),
            _ => None,
        }
    }

    fn execute(
        &mut self,
        now_ms: u32,
        function: u8,
        data: &[u8],
        memory: &mut Memory<'_>,
        answer: &mut Answer<'_>,
        command: &mut Option<Command>,
    ) -> Result<(), Exception> {
        if !matches!(function, READ_HOLDING | READ_INPUT | WRITE_ONE | WRITE_MANY) {
            return Err(Exception::Function);
        }
        let (first, second, rest) = words(data)?;
        match function {
            READ_INPUT | READ_HOLDING if !rest.is_empty() => Err(Exception::Value),
            READ_INPUT => {
                let range = memory.image.range(first, counted(second)?);
                read(answer, range.ok_or(Exception::Address)?)
            }
            READ_HOLDING => {
                let count = counted(second)?;
                self.read_holding(now_ms, first, count, memory.desk, answer)
            }
            WRITE_ONE if rest.is_empty() => {
                *command = self.write(now_ms, first, second, memory.desk)?;
                answer.push_word(first);
                answer.push_word(second);
                Ok(())
            }
            WRITE_MANY => {
                *command = self.write_many(now_ms, (first, second), rest, memory.desk)?;
                answer.push_word(first);
                answer.push_word(second);
                Ok(())
            }
            WRITE_ONE => Err(Exception::Value),
            _ => Err(Exception::Function),
        }
    }

    /// A piece of a program: the first one needs the key, the others the one before.
    fn write_file(
        &mut self,
        now_ms: u32,
        data: &[u8],
        desk: &mut Desk,
        answer: &mut Answer<'_>,
    ) -> Result<(), Exception> {
        let piece = Piece::of_request(data)?;
        let goes_on = is_within(now_ms, self.piece_at_ms, PIECE_MS);
        let begins = piece.is_first() && self.is_unlocked(now_ms);
        if !goes_on && !begins {
            return Err(Exception::Function);
        }
        let laid = piece.lay(desk.tray());
        if !goes_on && laid.is_ok() {
            self.unlocked_at_ms = None;
        }
        if goes_on || laid.is_ok() {
            self.piece_at_ms = Some(now_ms);
        }
        answer.push_all(data);
        laid
    }

    fn read_holding(
        &self,
        now_ms: u32,
        first: u16,
        count: u16,
        desk: &Desk,
        answer: &mut Answer<'_>,
    ) -> Result<(), Exception> {
        answer.push(2 * count as u8);
        for at in 0..count {
            let address = first.checked_add(at).ok_or(Exception::Address)?;
            let word = match address {
                KEY_REGISTER => Some(u16::from(self.is_unlocked(now_ms))),
                COMMAND_REGISTER => Some(0),
                _ => desk.register(address),
            };
            answer.push_word(word.ok_or(Exception::Address)?);
        }
        Ok(())
    }

    fn is_unlocked(&self, now_ms: u32) -> bool {
        is_within(now_ms, self.unlocked_at_ms, UNLOCK_MS)
    }

    fn write(
        &mut self,
        now_ms: u32,
        register: u16,
        value: u16,
        desk: &mut Desk,
    ) -> Result<Option<Command>, Exception> {
        match register {
            _ if desk.write(register, value) => Ok(None),
            KEY_REGISTER => {
                let right = value == UNLOCK_KEY;
                self.unlocked_at_ms = right.then_some(now_ms);
                right.then_some(None).ok_or(Exception::Value)
            }
            COMMAND_REGISTER if !self.is_unlocked(now_ms) => Err(Exception::Function),
            COMMAND_REGISTER => {
                let command = Command::by_number(value).ok_or(Exception::Value)?;
                self.unlocked_at_ms = None;
                Ok(Some(command))
            }
            _ => Err(Exception::Address),
        }
    }

    /// Key and command in one request, either alone, or words of a configuration.
    fn write_many(
        &mut self,
        now_ms: u32,
        (first, count): (u16, u16),
        rest: &[u8],
        desk: &mut Desk,
    ) -> Result<Option<Command>, Exception> {
        let [bytes, values @ ..] = rest else {
            return Err(Exception::Value);
        };
        let whole = usize::from(*bytes) == values.len() && values.len() == 2 * usize::from(count);
        if !whole || count == 0 {
            return Err(Exception::Value);
        }
        let commands = u32::from(first) + u32::from(count) <= u32::from(HOLDING_REGISTERS);
        if !commands && !Desk::is_writable(first, count) {
            return Err(Exception::Address);
        }
        let (values, _) = values.as_chunks::<2>();
        let mut command = None;
        for (register, value) in (first..).zip(values) {
            command = self.write(now_ms, register, u16::from_be_bytes(*value), desk)?;
        }
        Ok(command)
    }
}

/// Whether `since` was at most so long ago.
fn is_within(now_ms: u32, since: Option<u32>, most_ms: u32) -> bool {
    since.is_some_and(|since| now_ms.wrapping_sub(since) <= most_ms)
}

/// Every function here begins with two words.
fn words(data: &[u8]) -> Result<(u16, u16, &[u8]), Exception> {
    match data {
        [a, b, c, d, rest @ ..] => Ok((
            u16::from_be_bytes([*a, *b]),
            u16::from_be_bytes([*c, *d]),
            rest,
        )),
        _ => Err(Exception::Value),
    }
}

/// A count of registers within the protocol's limit.
fn counted(count: u16) -> Result<u16, Exception> {
    (1..=125)
        .contains(&count)
        .then_some(count)
        .ok_or(Exception::Value)
}

fn read(answer: &mut Answer<'_>, registers: &[u16]) -> Result<(), Exception> {
    answer.push(2 * registers.len() as u8);
    registers.iter().for_each(|word| answer.push_word(*word));
    Ok(())
}

/// Bytes between two silences. Longer ones are not frames.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Collector {
    bytes: Vec<u8, MAX_REQUEST_BYTES>,
    too_long: bool,
}

impl Collector {
    /// Takes bytes from the wire.
    #[inline(never)]
    pub fn push(&mut self, bytes: &[u8]) {
        self.too_long |= self.bytes.extend_from_slice(bytes).is_err();
    }

    /// The frame that a silence ends; empty when there is none.
    pub fn frame(&self) -> &[u8] {
        if self.too_long {
            return &[];
        }
        &self.bytes
    }

    /// Begins anew.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.too_long = false;
    }
}

#[cfg(test)]
mod tests;
