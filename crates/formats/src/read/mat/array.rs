//! The arrays of a MAT-file.

use super::element::{Element, Elements, MATRIX, truncated};
use recording::Error;

/// A variable or a field of a structure.
pub(super) struct Array {
    /// Its name; a field has none of its own.
    pub name: String,
    /// Extent in each direction.
    pub extents: Vec<usize>,
    /// What it holds.
    pub content: Content,
}

/// What an array holds.
pub(super) enum Content {
    /// Real numbers, the first direction running fastest.
    Numbers(Vec<f64>),
    /// The named fields of a single structure.
    Fields(Vec<(String, Array)>),
    /// Something that is no signal, in words.
    Other(&'static str),
}

/// Structures in structures that are followed.
const DEEPEST: usize = 8;
/// Names of variables and fields are shorter.
const LONGEST_NAME: usize = 1024;

/// Reads an array from the elements inside its own.
///
/// # Errors
/// Elements that are missing, or hold another number of values than the extents say.
pub(super) fn read(name: &str, inside: &Elements<'_>, depth: usize) -> Result<Array, Error> {
    let mut elements = inside.again();
    let flags = part(name, &mut elements)?;
    let extents = part(name, &mut elements)?;
    let label = part(name, &mut elements)?;
    let extents = integers(&extents, elements.big_endian);
    let extents = extents.into_iter().map(|n| usize::try_from(n).unwrap_or(0));
    let extents: Vec<usize> = extents.collect();
    let word = integers(&flags, elements.big_endian).first().copied();
    let content = match word.unwrap_or(0) {
        word if word & 0x0800 != 0 => Content::Other("complex numbers"),
        word => content(name, word & 0xFF, &extents, &mut elements, depth)?,
    };
    Ok(Array {
        name: text(label.data),
        extents,
        content,
    })
}

fn content(
    name: &str,
    class: i64,
    extents: &[usize],
    elements: &mut Elements<'_>,
    depth: usize,
) -> Result<Content, Error> {
    let one = extents.iter().all(|&n| n == 1);
    Ok(match class {
        1 => Content::Other("cells"),
        2 if one && depth < DEEPEST => Content::Fields(fields(name, elements, depth)?),
        2 => Content::Other("an array of structures"),
        4 => Content::Other("text"),
        5 => Content::Other("a sparse matrix"),
        6..=15 => Content::Numbers(numbers(name, extents, elements)?),
        _ => Content::Other("an object"),
    })
}

fn numbers(name: &str, extents: &[usize], elements: &mut Elements<'_>) -> Result<Vec<f64>, Error> {
    let part = part(name, elements)?;
    let size = size_of(part.kind).ok_or_else(|| truncated(name, part.offset))?;
    let values: Vec<f64> = part
        .data
        .chunks_exact(size)
        .map(|bytes| number(part.kind, bytes, elements.big_endian))
        .collect();
    let declared = extents
        .iter()
        .try_fold(1usize, |product, &n| product.checked_mul(n));
    if declared != Some(values.len()) {
        return Err(truncated(name, part.offset));
    }
    Ok(values)
}

fn fields(
    name: &str,
    elements: &mut Elements<'_>,
    depth: usize,
) -> Result<Vec<(String, Array)>, Error> {
    let length = part(name, elements)?;
    let names = part(name, elements)?;
    let length = integers(&length, elements.big_endian).first().copied();
    let length = length
        .and_then(|length| usize::try_from(length).ok())
        .filter(|length| (1..=LONGEST_NAME).contains(length))
        .ok_or_else(|| truncated(name, names.offset))?;
    let mut fields = Vec::new();
    for field in names.data.chunks_exact(length) {
        let array = part(name, elements)?;
        if array.kind == MATRIX && !array.data.is_empty() {
            let array = read(name, &array.inside(elements.big_endian), depth + 1)?;
            fields.push((text(field), array));
        }
    }
    Ok(fields)
}

fn part<'b>(name: &str, elements: &mut Elements<'b>) -> Result<Element<'b>, Error> {
    elements.next(name)?.ok_or_else(|| truncated(name, 0))
}

fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0);
    String::from_utf8_lossy(&bytes[..end.unwrap_or(bytes.len())]).into_owned()
}

fn integers(element: &Element<'_>, big_endian: bool) -> Vec<i64> {
    let words = element.data.chunks_exact(4);
    #[allow(clippy::cast_possible_truncation)]
    words
        .map(|bytes| number(5, bytes, big_endian) as i64)
        .collect()
}

/// Bytes of one number of a type; `None` for what is no number.
fn size_of(kind: u32) -> Option<usize> {
    match kind {
        1 | 2 => Some(1),
        3 | 4 => Some(2),
        5..=7 => Some(4),
        9 | 12 | 13 => Some(8),
        _ => None,
    }
}

#[allow(clippy::cast_precision_loss, clippy::cast_possible_wrap)]
fn number(kind: u32, bytes: &[u8], big_endian: bool) -> f64 {
    let mut low_first = [0; 8];
    low_first[..bytes.len()].copy_from_slice(bytes);
    if big_endian {
        low_first[..bytes.len()].reverse();
    }
    let bits = u64::from_le_bytes(low_first);
    let [b0, b1, b2, b3, ..] = low_first;
    match kind {
        1 => f64::from(i8::from_le_bytes([b0])),
        3 => f64::from(i16::from_le_bytes([b0, b1])),
        5 => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
        7 => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
        9 => f64::from_bits(bits),
        12 => bits as i64 as f64,
        _ => bits as f64,
    }
}
