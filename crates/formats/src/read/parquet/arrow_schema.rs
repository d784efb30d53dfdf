//! The units of durations, which Parquet does not know: Arrow's writers put them into a schema of their own.
//!
//! `ARROW:schema` is a message of Arrow's IPC format in base64: a flatbuffer (Message.fbs, Schema.fbs). What is not as those
//! say is taken for absent.

use parquet::file::metadata::KeyValue;
use std::collections::BTreeMap;

/// Seconds in one unit of each column of durations.
pub(super) fn durations(metadata: Option<&Vec<KeyValue>>) -> BTreeMap<String, f64> {
    let mut pairs = metadata.into_iter().flatten();
    let schema = pairs.find(|pair| pair.key == "ARROW:schema");
    let text = schema.and_then(|pair| pair.value.as_deref());
    text.and_then(|text| fields(&base64(text)?))
        .unwrap_or_default()
}

/// `MessageHeader.Schema` and `Type.Duration` of the unions.
const SCHEMA: u8 = 1;
const DURATION: u8 = 18;

fn fields(message: &[u8]) -> Option<BTreeMap<String, f64>> {
    // A mark of continuation and the length stand before the flatbuffer.
    let buffer = match message.strip_prefix(&[0xFF; 4]) {
        Some(rest) => rest.get(4..)?,
        None => message.get(4..)?,
    };
    let message = Table::root(buffer)?;
    if message.byte(1)? != SCHEMA {
        return None;
    }
    let columns = message.table(2)?.tables(1)?;
    Some(columns.iter().filter_map(duration).collect())
}

/// Name and unit of a field that is a duration.
fn duration(field: &Table<'_>) -> Option<(String, f64)> {
    if field.byte(2)? != DURATION {
        return None;
    }
    // Absent is the default, milliseconds.
    let unit = field.table(3)?.short(0).unwrap_or(1);
    let second = [1.0, 1e-3, 1e-6, 1e-9].get(usize::from(unit))?;
    Some((field.text(0)?, *second))
}

/// A table of a flatbuffer.
struct Table<'b> {
    buffer: &'b [u8],
    at: usize,
}

impl<'b> Table<'b> {
    fn root(buffer: &'b [u8]) -> Option<Table<'b>> {
        let at = word(buffer, 0)?;
        Some(Table { buffer, at })
    }

    /// Where a field stands; `None` where it is absent.
    fn field(&self, k: usize) -> Option<usize> {
        let back = i32::from_le_bytes(self.buffer.get(self.at..)?.get(..4)?.try_into().ok()?);
        let back = isize::try_from(back).ok()?;
        let fields = self.at.checked_add_signed(back.checked_neg()?)?;
        let size = short(self.buffer, fields)?;
        let place = 4 + 2 * k;
        let offset = (place < usize::from(size)).then(|| short(self.buffer, fields + place))??;
        (offset > 0).then(|| self.at + usize::from(offset))
    }

    fn byte(&self, k: usize) -> Option<u8> {
        self.buffer.get(self.field(k)?).copied()
    }

    fn short(&self, k: usize) -> Option<u16> {
        short(self.buffer, self.field(k)?)
    }

    fn target(&self, k: usize) -> Option<usize> {
        let at = self.field(k)?;
        at.checked_add(word(self.buffer, at)?)
    }

    fn table(&self, k: usize) -> Option<Table<'b>> {
        let at = self.target(k)?;
        Some(Table { at, ..*self })
    }

    fn text(&self, k: usize) -> Option<String> {
        let at = self.target(k)?;
        let begin = at.checked_add(4)?;
        let bytes = self
            .buffer
            .get(begin..begin.checked_add(word(self.buffer, at)?)?)?;
        String::from_utf8(bytes.to_vec()).ok()
    }

    fn tables(&self, k: usize) -> Option<Vec<Table<'b>>> {
        let at = self.target(k)?;
        let count = word(self.buffer, at)?;
        // Each takes four bytes: a count that lies ends at the end of the buffer.
        (0..count.min(self.buffer.len()))
            .map(|k| {
                let place = at.checked_add(4 + 4 * k)?;
                let at = place.checked_add(word(self.buffer, place)?)?;
                Some(Table { at, ..*self })
            })
            .collect()
    }
}

fn word(buffer: &[u8], at: usize) -> Option<usize> {
    let bytes = buffer.get(at..at.checked_add(4)?)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(bytes)).ok()
}

fn short(buffer: &[u8], at: usize) -> Option<u16> {
    let bytes = buffer.get(at..at.checked_add(2)?)?.try_into().ok()?;
    Some(u16::from_le_bytes(bytes))
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim().trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() * 3 / 4);
    for four in text.chunks(4) {
        let digit = |c: &u8| DIGITS.iter().position(|digit| digit == c);
        let digits = four.iter().map(digit).collect::<Option<Vec<_>>>()?;
        let word = digits.iter().fold(0, |word, digit| word << 6 | digit);
        let word = word << (6 * (4 - four.len()));
        let three = [word >> 16, word >> 8, word].map(|byte| byte.to_le_bytes()[0]);
        bytes.extend_from_slice(&three[..four.len() - 1]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::{base64, fields};

    /// The examples of RFC 4648, section 10.
    #[test]
    fn base64_is_read() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64("Z!=="), None);
    }

    #[test]
    fn what_is_no_schema_says_nothing() {
        for length in 0..64 {
            for byte in [0, 1, 0x7F, 0xFF] {
                assert!(fields(&vec![byte; length]).unwrap_or_default().is_empty());
            }
        }
    }
}
