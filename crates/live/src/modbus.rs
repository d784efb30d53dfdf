//! A Modbus RTU master: asks a board over a serial line.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use board::{Line, LineParity};
use crc::{CRC_16_MODBUS, Crc};
use serialport::{ClearBuffer, DataBits, Parity, SerialPort, StopBits};

use crate::source::{SourceError, port_error};

const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_MODBUS);
/// How long the first byte of an answer may take, and the longest gap within one.
const PATIENCE: Duration = Duration::from_millis(600);
const GAP: Duration = Duration::from_millis(60);
/// Requests before the board is called silent: noise may destroy one.
const ATTEMPTS: u32 = 3;
/// Longest frame of the protocol.
const FRAME_BYTES: usize = 256;
/// Registers of one request, at most.
const MOST_READ: u16 = 125;
const MOST_WRITTEN: usize = 123;

/// Why a board could not be asked.
#[derive(Debug, thiserror::Error)]
pub enum ModbusError {
    /// The port.
    #[error(transparent)]
    Port(#[from] SourceError),
    /// Nothing came back.
    #[error(
        "no answer from unit {unit} at {baud} bit/s; is this the RS-485 line (not the debugger's port)? A new board \
         speaks 19200 bit/s, even parity, unit 1, and so does one whose button is held while the power returns"
    )]
    Silent {
        /// Who was asked.
        unit: u8,
        /// How fast.
        baud: u32,
    },
    /// Something came back that is no answer.
    #[error(
        "the answer of unit {unit} is damaged; check termination, the wires' order and the speed"
    )]
    Damaged {
        /// Who was asked.
        unit: u8,
    },
    /// The board refuses.
    #[error("the board refuses function {function}: {}", exception(*code))]
    Refused {
        /// What was asked for.
        function: u8,
        /// The protocol's number.
        code: u8,
    },
}

fn exception(code: u8) -> String {
    match code {
        1 => "unknown to it, or a command while it is locked (exception 1)".into(),
        2 => "no such register (exception 2)".into(),
        3 => "a value it does not take (exception 3)".into(),
        4 => "it could not do it (exception 4)".into(),
        6 => "it is busy; try again (exception 6)".into(),
        other => format!("exception {other}"),
    }
}

/// What the bytes of a line go through: a serial port, or what stands for one.
pub trait Wire: Read + Write + Send {
    /// Forgets what came and was not read.
    ///
    /// # Errors
    /// The connection is gone.
    fn forget(&mut self) -> std::io::Result<()>;

    /// How long a read waits for bytes.
    ///
    /// # Errors
    /// The connection is gone.
    fn set_patience(&mut self, patience: Duration) -> std::io::Result<()>;
}

impl Wire for Box<dyn SerialPort> {
    fn forget(&mut self) -> std::io::Result<()> {
        Ok(self.clear(ClearBuffer::Input)?)
    }

    fn set_patience(&mut self, patience: Duration) -> std::io::Result<()> {
        Ok(self.set_timeout(patience)?)
    }
}

/// A line with one board on it.
pub struct ModbusLine {
    wire: Box<dyn Wire>,
    settings: Line,
    patience: Duration,
}

impl ModbusLine {
    /// Opens a serial port.
    ///
    /// # Errors
    /// No such port, no permission, or settings that it cannot do.
    pub fn open(name: &str, settings: Line) -> Result<Self, ModbusError> {
        let (parity, stop_bits) = match settings.parity {
            LineParity::Even => (Parity::Even, StopBits::One),
            LineParity::Odd => (Parity::Odd, StopBits::One),
            LineParity::None => (Parity::None, StopBits::Two),
        };
        let opened = serialport::new(name, settings.baud)
            .data_bits(DataBits::Eight)
            .parity(parity)
            .stop_bits(stop_bits)
            .timeout(PATIENCE)
            .open();
        let port = opened.map_err(|error| port_error(name, error))?;
        Ok(ModbusLine::over(Box::new(port), settings))
    }

    /// Over a wire that is set up as `settings` say.
    pub fn over(wire: Box<dyn Wire>, settings: Line) -> Self {
        ModbusLine {
            wire,
            settings,
            patience: PATIENCE,
        }
    }

    /// Asks another board of the same line from now on.
    pub fn set_unit(&mut self, unit: u8) {
        self.settings.unit = unit;
    }

    /// How long the first byte of an answer may take; 0.6 s at first.
    pub fn set_patience(&mut self, patience: Duration) {
        self.patience = patience;
    }

    /// Reads input registers, as many requests as that takes.
    ///
    /// # Errors
    /// No sound answer.
    pub fn read_inputs(&mut self, first: u16, count: u16) -> Result<Vec<u16>, ModbusError> {
        self.read_registers(4, first, count)
    }

    /// Reads holding registers, as many requests as that takes.
    ///
    /// # Errors
    /// No sound answer.
    pub fn read_holding(&mut self, first: u16, count: u16) -> Result<Vec<u16>, ModbusError> {
        self.read_registers(3, first, count)
    }

    fn read_registers(
        &mut self,
        function: u8,
        first: u16,
        count: u16,
    ) -> Result<Vec<u16>, ModbusError> {
        let mut words = Vec::with_capacity(usize::from(count));
        while words.len() < usize::from(count) {
            let from = first + words.len() as u16;
            let number = (count - words.len() as u16).min(MOST_READ);
            let [[a, b], [c, d]] = [from, number].map(u16::to_be_bytes);
            let answer = self.ask(function, &[a, b, c, d])?;
            let values = answer.get(1..).unwrap_or_default();
            if values.len() != 2 * usize::from(number) {
                return Err(self.damaged());
            }
            words.extend(pairs(values));
        }
        Ok(words)
    }

    /// Writes holding registers, as many requests as that takes.
    ///
    /// # Errors
    /// No sound answer, or a refusal.
    pub fn write_holding(&mut self, first: u16, values: &[u16]) -> Result<(), ModbusError> {
        for (k, part) in values.chunks(MOST_WRITTEN).enumerate() {
            let from = first + (k * MOST_WRITTEN) as u16;
            let [[a, b], [c, d]] = [from, part.len() as u16].map(u16::to_be_bytes);
            let mut data = vec![a, b, c, d, 2 * part.len() as u8];
            data.extend(part.iter().flat_map(|word| word.to_be_bytes()));
            self.ask(16, &data)?;
        }
        Ok(())
    }

    /// Sends a request and gives the data of the answer. A damaged or missing answer is asked for again.
    ///
    /// # Errors
    /// No sound answer, or a refusal.
    pub fn ask(&mut self, function: u8, data: &[u8]) -> Result<Vec<u8>, ModbusError> {
        let mut last = self.silent();
        for _ in 0..ATTEMPTS {
            match self.ask_once(function, data) {
                Err(error @ (ModbusError::Silent { .. } | ModbusError::Damaged { .. })) => {
                    last = error;
                }
                answered => return answered,
            }
        }
        Err(last)
    }

    fn ask_once(&mut self, function: u8, data: &[u8]) -> Result<Vec<u8>, ModbusError> {
        let mut request = vec![self.settings.unit, function];
        request.extend(data);
        request.extend(CRC.checksum(&request).to_le_bytes());
        let ended = |error| ModbusError::Port(SourceError::Ended(error));
        self.wire.forget().map_err(ended)?;
        self.wire.write_all(&request).map_err(ended)?;
        self.wire.flush().map_err(ended)?;
        let answer = self.collect().map_err(ended)?;
        self.unwrap(function, &answer)
    }

    /// Bytes until the answer is whole or the line falls silent.
    fn collect(&mut self) -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut piece = [0; FRAME_BYTES];
        // A longest frame of a slow line takes longer than one gap.
        let end = Instant::now() + self.patience + Duration::from_secs(2);
        while Instant::now() < end && bytes.len() < FRAME_BYTES && !is_whole(&bytes) {
            let patience = if bytes.is_empty() { self.patience } else { GAP };
            self.wire.set_patience(patience)?;
            match self.wire.read(&mut piece) {
                Ok(0) => break,
                Ok(length) => bytes.extend(&piece[..length]),
                Err(error) if error.kind() == ErrorKind::TimedOut => break,
                Err(error) => return Err(error),
            }
        }
        Ok(bytes)
    }

    fn unwrap(&self, function: u8, answer: &[u8]) -> Result<Vec<u8>, ModbusError> {
        if answer.is_empty() {
            return Err(self.silent());
        }
        let (frame, checksum) = answer
            .split_last_chunk::<2>()
            .ok_or_else(|| self.damaged())?;
        match frame {
            _ if CRC.checksum(frame).to_le_bytes() != *checksum => Err(self.damaged()),
            [unit, refused, code] if *unit == self.settings.unit && *refused == function | 0x80 => {
                Err(ModbusError::Refused {
                    function,
                    code: *code,
                })
            }
            [unit, done, data @ ..] if *unit == self.settings.unit && *done == function => {
                Ok(data.to_vec())
            }
            _ => Err(self.damaged()),
        }
    }

    fn silent(&self) -> ModbusError {
        ModbusError::Silent {
            unit: self.settings.unit,
            baud: self.settings.baud,
        }
    }

    pub(crate) fn damaged(&self) -> ModbusError {
        ModbusError::Damaged {
            unit: self.settings.unit,
        }
    }
}

/// Whether an answer is complete, of those that tell their length: nobody needs to wait for the silence behind it.
fn is_whole(bytes: &[u8]) -> bool {
    let length = match bytes {
        [_, function, ..] if function & 0x80 != 0 => 5,
        [_, 3 | 4 | 20 | 21, count, ..] => 5 + usize::from(*count),
        [_, 6 | 16, ..] => 8,
        _ => return false,
    };
    bytes.len() >= length
}

fn pairs(bytes: &[u8]) -> impl Iterator<Item = u16> {
    let (pairs, _) = bytes.as_chunks::<2>();
    pairs.iter().map(|pair| u16::from_be_bytes(*pair))
}
