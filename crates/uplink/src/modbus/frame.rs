//! Frames of Modbus TCP, and the answer to a request. No input, no output.

use super::map::Plant;

/// Longest frame of the protocol: header and a protocol data unit of 253 bytes.
pub const LARGEST_FRAME: usize = 260;
const HEADER: usize = 7;
/// Most registers in one answer (MODBUS Application Protocol V1.1b3, 6.3 and 6.4).
const MOST_REGISTERS: u16 = 125;

const READ_HOLDING: u8 = 3;
const READ_INPUT: u8 = 4;

const ILLEGAL_FUNCTION: u8 = 1;
const ILLEGAL_ADDRESS: u8 = 2;
const ILLEGAL_VALUE: u8 = 3;
const NO_PATH: u8 = 10;

/// A request as it stands in a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request<'b> {
    /// The master's number of it, which the answer repeats.
    pub transaction: u16,
    /// Whom it is for.
    pub unit: u8,
    /// Function and what belongs to it.
    pub data: &'b [u8],
}

/// What a buffer begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame<'b> {
    /// Not a whole frame yet.
    Incomplete,
    /// A request, and the bytes it took.
    Whole(Request<'b>, usize),
    /// No frame of Modbus TCP: where the next one begins cannot be told.
    Broken,
}

/// Splits the first frame off a buffer.
pub fn split(buffer: &[u8]) -> Frame<'_> {
    let Some((header, rest)) = buffer.split_first_chunk::<HEADER>() else {
        return Frame::Incomplete;
    };
    let [t1, t0, p1, p0, l1, l0, unit] = *header;
    // The length counts the unit too.
    let length = usize::from(u16::from_be_bytes([l1, l0]));
    if [p1, p0] != [0, 0] || !(2..=LARGEST_FRAME - HEADER + 1).contains(&length) {
        return Frame::Broken;
    }
    let Some(data) = rest.get(..length - 1) else {
        return Frame::Incomplete;
    };
    let request = Request {
        transaction: u16::from_be_bytes([t1, t0]),
        unit,
        data,
    };
    Frame::Whole(request, HEADER + length - 1)
}

/// The answer to a request; whether it is an exception.
pub fn answer(request: &Request<'_>, plant: &Plant, now_ms: i64) -> (Vec<u8>, bool) {
    let done = registers(request, plant, now_ms);
    let function = request.data.first().copied().unwrap_or(0);
    let data = match &done {
        Ok(words) => {
            let mut data = vec![function, (words.len() * 2) as u8];
            data.extend(words.iter().flat_map(|word| word.to_be_bytes()));
            data
        }
        Err(code) => vec![function | 0x80, *code],
    };
    let mut frame = Vec::with_capacity(HEADER + data.len());
    frame.extend(request.transaction.to_be_bytes());
    frame.extend([0, 0]);
    frame.extend((data.len() as u16 + 1).to_be_bytes());
    frame.push(request.unit);
    frame.extend(data);
    (frame, done.is_err())
}

fn registers(request: &Request<'_>, plant: &Plant, now_ms: i64) -> Result<Vec<u16>, u8> {
    let (function, rest) = request.data.split_first().ok_or(ILLEGAL_FUNCTION)?;
    if !plant.has(request.unit) {
        return Err(NO_PATH);
    }
    if !matches!(*function, READ_HOLDING | READ_INPUT) {
        return Err(ILLEGAL_FUNCTION);
    }
    let [a1, a0, c1, c0] = *<&[u8; 4]>::try_from(rest).map_err(|_| ILLEGAL_VALUE)?;
    let (first, count) = (u16::from_be_bytes([a1, a0]), u16::from_be_bytes([c1, c0]));
    if !(1..=MOST_REGISTERS).contains(&count) {
        return Err(ILLEGAL_VALUE);
    }
    plant
        .range(request.unit, first, count, now_ms)
        .ok_or(ILLEGAL_ADDRESS)
}
