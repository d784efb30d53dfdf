//! What a program says of itself, behind its vector table: length, checksum, version and board. tools/seal writes the first two.

use crc::{CRC_32_ISO_HDLC, Crc, Digest, NoTable};

use crate::layout::{PAGE_BYTES, PROGRAM_PAGES};
use crate::refusal::Refusal;

/// Where the seal lies in a program, bytes.
pub const SEAL_OFFSET: usize = 0x1E0;
/// The seal's first word.
pub const SEAL_MAGIC: u32 = 0x4C41_4553;
/// The board that this program is for: STM32G474RE with the front end of docs/wiring.md.
pub const BOARD_TYPE: u32 = 0x444D_0001;
/// The two words that the checksum leaves out, length and checksum themselves: bytes from the program's beginning.
pub const LEFT_OUT: core::ops::Range<usize> = SEAL_OFFSET + 4..SEAL_OFFSET + 12;
/// Bytes of the seal.
pub const SEAL_BYTES: usize = 20;
static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Version of a program: two numbers of 8 bits and one of 16, the greatest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version(pub u32);

impl Version {
    /// Of text such as `1.12.3`; what follows the third number does not count. Numbers that are too large are cut to their largest.
    pub const fn parse(text: &str) -> Self {
        let (mut numbers, mut at, mut k) = ([0_u32; 3], 0, 0);
        let bytes = text.as_bytes();
        while k < bytes.len() && at < 3 {
            match bytes[k] {
                digit @ b'0'..=b'9' => {
                    let grown = numbers[at] * 10 + (digit - b'0') as u32;
                    let largest = if at == 2 { 0xFFFF } else { 0xFF };
                    numbers[at] = if grown > largest { largest } else { grown };
                }
                b'.' => at += 1,
                _ => at = 3,
            }
            k += 1;
        }
        Version(numbers[0] << 24 | numbers[1] << 16 | numbers[2])
    }
}

impl core::fmt::Display for Version {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Version(bits) = self;
        write!(f, "{}.{}.{}", bits >> 24, bits >> 16 & 0xFF, bits & 0xFFFF)
    }
}

/// What a program says of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seal {
    /// Bytes of the program.
    pub length: u32,
    /// CRC-32 (ISO-HDLC) of its bytes but for length and checksum themselves.
    pub checksum: u32,
    /// Its version.
    pub version: Version,
    /// The board that it is for, [`BOARD_TYPE`] for this one.
    pub board: u32,
}

impl Seal {
    /// Reads the seal of a program, of which at least the beginning is given.
    ///
    /// # Errors
    /// [`Refusal::NoProgram`] without a seal or with an impossible length.
    pub fn read(program: &[u8]) -> Result<Self, Refusal> {
        let bytes = program.get(SEAL_OFFSET..).and_then(<[u8]>::first_chunk);
        Self::of_bytes(bytes.ok_or(Refusal::NoProgram)?)
    }

    /// From the seal's own bytes.
    ///
    /// # Errors
    /// As [`Seal::read`].
    pub fn of_bytes(bytes: &[u8; SEAL_BYTES]) -> Result<Self, Refusal> {
        let (words, _) = bytes.as_chunks::<4>();
        let [magic, length, checksum, version, board] = words else {
            return Err(Refusal::NoProgram);
        };
        let seal = Seal {
            length: u32::from_le_bytes(*length),
            checksum: u32::from_le_bytes(*checksum),
            version: Version(u32::from_le_bytes(*version)),
            board: u32::from_le_bytes(*board),
        };
        let possible = (SEAL_OFFSET + SEAL_BYTES) as u32..=PROGRAM_PAGES * PAGE_BYTES;
        let sealed = u32::from_le_bytes(*magic) == SEAL_MAGIC && possible.contains(&seal.length);
        sealed.then_some(seal).ok_or(Refusal::NoProgram)
    }

    /// Whether the program's bytes are those that were sealed; `program` may be longer.
    ///
    /// # Errors
    /// [`Refusal::Incomplete`] where bytes are missing, [`Refusal::Checksum`].
    pub fn check(&self, program: &[u8]) -> Result<(), Refusal> {
        let program = program
            .get(..self.length as usize)
            .ok_or(Refusal::Incomplete)?;
        let mut tally = Tally::default();
        tally.update(program);
        tally.check(self)
    }

    /// Whether a program may take the place of the one that runs: for this board, and not older.
    ///
    /// # Errors
    /// [`Refusal::Board`], [`Refusal::Older`].
    pub fn may_follow(&self, running: Option<Seal>) -> Result<(), Refusal> {
        if self.board != BOARD_TYPE {
            return Err(Refusal::Board);
        }
        let older = running.is_some_and(|running| self.version < running.version);
        (!older).then_some(()).ok_or(Refusal::Older)
    }
}

/// The checksum of a program, of whose bytes some come after the others.
#[derive(Clone)]
pub struct Tally {
    digest: Digest<'static, u32, NoTable>,
    bytes: usize,
}

impl Default for Tally {
    fn default() -> Self {
        Tally {
            digest: CRC.digest(),
            bytes: 0,
        }
    }
}

impl Tally {
    /// Bytes that were taken.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Takes the next bytes; length and checksum themselves are left out.
    pub fn update(&mut self, bytes: &[u8]) {
        let before = LEFT_OUT.start.saturating_sub(self.bytes);
        let until = LEFT_OUT.end.saturating_sub(self.bytes);
        let (head, _) = bytes.split_at(before.min(bytes.len()));
        let (_, tail) = bytes.split_at(until.min(bytes.len()));
        self.digest.update(head);
        self.digest.update(tail);
        self.bytes += bytes.len();
    }

    /// Whether these were the bytes that were sealed.
    ///
    /// # Errors
    /// [`Refusal::Checksum`].
    pub fn check(self, seal: &Seal) -> Result<(), Refusal> {
        let holds = self.digest.finalize() == seal.checksum;
        holds.then_some(()).ok_or(Refusal::Checksum)
    }
}
