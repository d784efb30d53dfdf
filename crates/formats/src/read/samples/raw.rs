//! The samples of a file before they are channels.

use recording::{Column, Target};
use std::collections::BTreeMap;
use std::ops::Range;

/// The samples of a file as they stand there, with their rows.
pub(crate) struct Raw {
    pub columns: BTreeMap<Target, Column>,
    pub rows: Rows,
    /// Rows that were dropped.
    pub skipped: u64,
}

/// Rows of a file, with rows beside them.
pub(crate) struct Piece {
    pub raw: Raw,
    /// Which rows of `raw` the piece holds; the others belong to its neighbours.
    pub kept: Range<usize>,
}

/// Which rows of a file the samples are.
pub(crate) enum Rows {
    /// All of them, so many.
    All(usize),
    /// Those that were kept.
    Kept(Kept),
}

/// Rows that were kept of a file: their lines, and their running numbers, which skip where rows were dropped.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    /// Where lines or numbers do not go on one by one, first the beginning.
    runs: Vec<Run>,
    len: usize,
}

/// Rows whose lines and numbers follow one another.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Which of the kept rows is the first.
    first: usize,
    line: u64,
    number: u64,
}

impl Run {
    fn goes_on_to(&self, next: &Run) -> bool {
        let rows = (next.first - self.first) as u64;
        self.line + rows == next.line && self.number + rows == next.number
    }
}

impl Kept {
    /// How many.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Takes `rows` more, the first at `line` with the running number `number`.
    pub fn push(&mut self, rows: usize, line: u64, number: u64) {
        if rows == 0 {
            return;
        }
        let first = self.len;
        let run = Run {
            first,
            line,
            number,
        };
        if !self.runs.last().is_some_and(|last| last.goes_on_to(&run)) {
            self.runs.push(run);
        }
        self.len += rows;
    }

    fn run(&self, k: usize) -> Option<&Run> {
        let behind = self.runs.partition_point(|run| run.first <= k);
        self.runs.get(behind.checked_sub(1)?)
    }

    fn line(&self, k: usize) -> u64 {
        self.run(k)
            .map_or(0, |run| run.line + (k - run.first) as u64)
    }

    fn number(&self, k: usize) -> u64 {
        self.run(k)
            .map_or(0, |run| run.number + (k - run.first) as u64)
    }

    /// The rows of a range alone.
    pub fn part(&self, range: Range<usize>) -> Kept {
        let mut part = Kept::default();
        let later = self.runs.iter().map(|run| run.first);
        let begins = later.filter(|first| range.contains(first) && *first > range.start);
        let begins: Vec<usize> = std::iter::once(range.start).chain(begins).collect();
        for (k, begin) in begins.iter().enumerate() {
            let end = begins.get(k + 1).copied().unwrap_or(range.end);
            part.push(end - begin, self.line(*begin), self.number(*begin));
        }
        part
    }
}

impl Rows {
    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Rows::All(rows) => *rows,
            Rows::Kept(kept) => kept.len(),
        }
    }

    /// The line of sample `k`, counted from 1.
    pub fn line(&self, k: usize) -> u64 {
        match self {
            Rows::All(_) => k as u64 + 1,
            Rows::Kept(kept) => kept.line(k),
        }
    }

    /// The running number of sample `k`, counted from 0.
    pub fn number(&self, k: usize) -> u64 {
        match self {
            Rows::All(_) => k as u64,
            Rows::Kept(kept) => kept.number(k),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Kept;

    /// A header, a comment behind the third row, and a row without a number that was dropped behind the fifth.
    #[test]
    fn lines_and_numbers_skip_what_is_no_sample() {
        let (lines, numbers) = ([2, 3, 4, 6, 7, 9, 10], [0, 1, 2, 3, 4, 6, 7]);
        let mut kept = Kept::default();
        let rows = lines.iter().zip(numbers);
        rows.for_each(|(line, number)| kept.push(1, *line, number));
        assert_eq!((kept.len(), kept.runs.len()), (7, 3));
        for from in 0..=7 {
            for to in from..=7 {
                let part = kept.part(from..to);
                let told = |k| (part.line(k), part.number(k));
                let expected = (from..to).map(|k| (lines[k], numbers[k]));
                assert!((0..part.len()).map(told).eq(expected), "{from}..{to}");
            }
        }
    }
}
