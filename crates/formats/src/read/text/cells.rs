//! Lines cut into cells.

use super::number::is_number;
use super::stamp;

/// Separator of two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    /// One character.
    Byte(u8),
    /// Any number of blanks and tabs.
    Blanks,
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing, or a word for "no number".
    Missing,
    Number,
    /// A date, a time of day, or both.
    Stamp,
    Text,
}

/// The cells of a line, trimmed and without quotes.
pub(super) fn cells(line: &str, separator: Separator) -> Vec<&str> {
    match separator {
        Separator::Blanks => cut(line.trim(), |c| c == ' ' || c == '\t', true),
        Separator::Byte(byte) => cut(line, |c| c == char::from(byte), false),
    }
}

fn cut(line: &str, is_separator: impl Fn(char) -> bool, in_runs: bool) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = line;
    loop {
        let end = end_of_cell(rest, &is_separator);
        found.push(unquoted(&rest[..end]));
        let Some(separator) = rest[end..].chars().next() else {
            return found;
        };
        rest = &rest[end + separator.len_utf8()..];
        if in_runs {
            rest = rest.trim_start_matches(&is_separator);
        }
    }
}

/// Where a cell ends; a separator between quotes is no end.
fn end_of_cell(text: &str, is_separator: &impl Fn(char) -> bool) -> usize {
    let end = |text: &str| text.find(is_separator).unwrap_or(text.len());
    let quote = text.len() - text.trim_start_matches(' ').len();
    let closing = text[quote..]
        .strip_prefix('"')
        .and_then(|inner| inner.find('"'));
    match closing {
        Some(inner) => {
            let behind = quote + inner + 2;
            behind + end(&text[behind..])
        }
        None => end(text),
    }
}

/// A cell without blanks and quotes around it.
pub(super) fn unquoted(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'))
        .unwrap_or(text)
        .trim()
}

/// Whether a cell says that there is no number.
pub(super) fn is_missing(text: &str) -> bool {
    const WORDS: [&str; 8] = ["nan", "-nan", "+nan", "na", "n/a", "null", "-", "--"];
    text.is_empty() || WORDS.iter().any(|word| text.eq_ignore_ascii_case(word))
}

/// What a cell holds.
pub(super) fn kind(cell: &str) -> Kind {
    match cell {
        _ if is_missing(cell) => Kind::Missing,
        _ if is_number(cell) => Kind::Number,
        _ if stamp::parse(cell).is_some() => Kind::Stamp,
        _ => Kind::Text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_between_quotes_do_not_separate() {
        let comma = Separator::Byte(b',');
        assert_eq!(cells("\"1,5\", x ,", comma), ["1,5", "x", ""]);
        assert_eq!(cells("a\"b,c", comma), ["a\"b", "c"]);
        assert_eq!(cells("\"a,b", comma), ["\"a", "b"]);
        assert_eq!(cells("  1 \t 2  3 ", Separator::Blanks), ["1", "2", "3"]);
        assert_eq!(
            cells("\"Time (s)\" Ua", Separator::Blanks),
            ["Time (s)", "Ua"]
        );
        assert_eq!(cells("", comma), [""]);
    }

    #[test]
    fn cells_are_told_by_what_they_hold() {
        let cases = [
            ("", Kind::Missing),
            ("N/A", Kind::Missing),
            ("-1.5E-3", Kind::Number),
            ("1.234,5", Kind::Number),
            ("01.03.2024", Kind::Stamp),
            ("12:00:00.5", Kind::Stamp),
            ("Volt", Kind::Text),
            ("3.7 A", Kind::Text),
        ];
        for (cell, expected) in cases {
            assert_eq!(kind(cell), expected, "{cell}");
        }
    }
}
