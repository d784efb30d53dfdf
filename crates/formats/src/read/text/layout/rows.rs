//! The first lines of a file as rows of cells, and where the samples begin.

use crate::read::text::cells::{Kind, Separator, cells, kind};
use std::cmp::Reverse;

/// A line of the file that is neither empty nor a comment.
#[derive(Clone, Debug)]
pub(in crate::read::text) struct Row<'h> {
    /// Counted from 1.
    pub line: u64,
    pub cells: Vec<&'h str>,
    pub kinds: Vec<Kind>,
}

impl<'h> Row<'h> {
    fn new(line: u64, text: &'h str, separator: Separator) -> Row<'h> {
        let cells = cells(text, separator);
        let kinds = cells.iter().map(|cell| kind(cell)).collect();
        Row { line, cells, kinds }
    }

    /// Cells up to the last that is not empty.
    pub fn width(&self) -> usize {
        let last = self.cells.iter().rposition(|cell| !cell.is_empty());
        last.map_or(0, |last| last + 1)
    }

    pub fn count(&self, wanted: Kind) -> usize {
        self.kinds.iter().filter(|kind| **kind == wanted).count()
    }

    /// Whether this can be a row of samples: it has a number, begins with no text, and more than half of its cells are numbers.
    pub fn is_sample(&self) -> bool {
        let first = self.kinds.iter().find(|kind| **kind != Kind::Missing);
        let filled = self.cells.iter().filter(|cell| !cell.is_empty()).count();
        let values = filled - self.count(Kind::Text).min(filled);
        self.count(Kind::Number) > 0 && first != Some(&Kind::Text) && 2 * values > filled
    }
}

/// Marks of a line that is no row.
const COMMENTS: [&str; 3] = ["#", "%", "//"];

/// The text of a comment.
pub(in crate::read::text) fn comment(line: &str) -> Option<&str> {
    let line = line.trim_start();
    COMMENTS
        .iter()
        .find_map(|mark| line.strip_prefix(mark))
        .map(|text| text.trim_start_matches(['#', '%', '/']))
}

/// The lines of a text, numbered from 1.
pub(in crate::read::text) fn numbered(text: &str) -> impl Iterator<Item = (u64, &str)> {
    (1..).zip(text.lines())
}

/// The rows of a text.
pub(in crate::read::text) fn rows(text: &str, separator: Separator) -> Vec<Row<'_>> {
    let written =
        numbered(text).filter(|(_, line)| !line.trim().is_empty() && comment(line).is_none());
    written
        .map(|(line, text)| Row::new(line, text, separator))
        .collect()
}

/// The longest run of rows of samples of one width, as indices.
pub(in crate::read::text) fn longest_run(rows: &[Row<'_>]) -> std::ops::Range<usize> {
    let mut best = 0..0;
    let mut first = 0;
    for k in 0..=rows.len() {
        let goes_on = |row: &Row<'_>| {
            row.is_sample() && rows[first].is_sample() && row.width() == rows[first].width()
        };
        if k < rows.len() && first < k && goes_on(&rows[k]) {
            continue;
        }
        if k > first && rows[first].is_sample() && k - first > best.len() {
            best = first..k;
        }
        first = k;
    }
    best
}

/// What separates the cells: that which makes the longest table, of those the one with the fewest words, then the widest.
pub(in crate::read::text) fn separator(text: &str) -> Option<Separator> {
    let bytes = [b',', b';', b'\t', b'|'].map(Separator::Byte);
    let candidates = bytes.into_iter().chain([Separator::Blanks]);
    let scored = candidates.filter_map(|separator| {
        let rows = rows(text, separator);
        let run = longest_run(&rows);
        let width = rows.get(run.start).filter(|_| !run.is_empty())?.width();
        let words: usize = rows[run.clone()]
            .iter()
            .map(|row| row.count(Kind::Text))
            .sum();
        (width > 1).then_some(((run.len(), Reverse(words), width), separator))
    });
    // The first of equals: blanks, which come last, only where nothing else separates.
    let best = scored.reduce(|best, one| if one.0 > best.0 { one } else { best });
    best.map(|(_, separator)| separator)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_separator_is_what_makes_a_table() {
        let comma = Some(Separator::Byte(b','));
        let semicolon = Some(Separator::Byte(b';'));
        let tab = Some(Separator::Byte(b'\t'));
        for (text, expected) in [
            ("t,ia\n0,1\n1,2\n", comma),
            ("t;ia\n0,1;1,5\n0,2;2,5\n", semicolon),
            ("t\tia\n0,1\t1,5\n0,2\t2,5\n", tab),
            ("t ia\n0.1  1.5\n0.2  -2.5\n", Some(Separator::Blanks)),
            ("a, b, c\n0.1, 1.5, 3\n", comma),
            ("2024-01-01 12:00:00.0;1,5;2\n", semicolon),
            ("ia\n1\n2\n", None),
            ("", None),
        ] {
            assert_eq!(separator(text), expected, "{text}");
        }
    }

    #[test]
    fn samples_begin_where_the_longest_run_begins() {
        let text = "Interval,1e-4\nLength,5\nt,ia\n0,1\n1,2\n2,3\n";
        let rows = rows(text, Separator::Byte(b','));
        assert_eq!(longest_run(&rows), 3..6);
    }
}
