//! Which alphabet a text file is written in, by its first bytes.

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Bytes that are looked at for zeros.
const ZEROS_WITHIN: usize = 4096;

/// The encoding of a text that is not UTF-8; `None` for UTF-8.
pub(super) fn other_than_utf8(head: &[u8]) -> Option<&'static Encoding> {
    match head {
        [0xFF, 0xFE, ..] => return Some(UTF_16LE),
        [0xFE, 0xFF, ..] => return Some(UTF_16BE),
        _ => {}
    }
    utf16_without_mark(head).or_else(|| is_torn(head).then_some(WINDOWS_1252))
}

/// Digits, letters and separators of a table have a zero as the other half of their UTF-16 unit.
fn utf16_without_mark(head: &[u8]) -> Option<&'static Encoding> {
    let units = &head[..head.len().min(ZEROS_WITHIN) / 2 * 2];
    let zeros = |half: usize| {
        units
            .iter()
            .skip(half)
            .step_by(2)
            .filter(|b| **b == 0)
            .count()
    };
    let (first, second, all) = (zeros(0), zeros(1), units.len() / 2);
    let most = |n: usize| all > 0 && n * 10 >= all * 9;
    match (first, second) {
        (0, n) if most(n) => Some(UTF_16LE),
        (n, 0) if most(n) => Some(UTF_16BE),
        _ => None,
    }
}

/// Whether a byte is in it that UTF-8 does not allow; a character cut at the end is no such byte.
fn is_torn(head: &[u8]) -> bool {
    std::str::from_utf8(head).is_err_and(|error| error.error_len().is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn little(text: &str) -> Vec<u8> {
        text.encode_utf16().flat_map(u16::to_le_bytes).collect()
    }

    #[test]
    fn each_alphabet_is_told_by_its_bytes() {
        let big: Vec<u8> = "t;ia".encode_utf16().flat_map(u16::to_be_bytes).collect();
        let cases: [(&[u8], Option<&Encoding>); 7] = [
            (b"t,ia\n0,1\n", None),
            ("t;\u{b5}s".as_bytes(), None),
            (&"t;\u{b5}s".as_bytes()[..3], None),
            (b"t;\xB5s", Some(WINDOWS_1252)),
            (b"\xFF\xFEt\0", Some(UTF_16LE)),
            (&little("t;ia\n0;1\n"), Some(UTF_16LE)),
            (&big, Some(UTF_16BE)),
        ];
        for (bytes, expected) in cases {
            assert_eq!(other_than_utf8(bytes), expected, "{bytes:?}");
        }
        assert_eq!(other_than_utf8(&[0; 64]), None);
    }
}
