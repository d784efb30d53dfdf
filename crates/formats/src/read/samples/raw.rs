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
    /// Those that were kept: their lines, and their running numbers, which skip where rows were dropped.
    Kept { lines: Vec<u64>, numbers: Vec<u64> },
}

impl Rows {
    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Rows::All(rows) => *rows,
            Rows::Kept { lines, .. } => lines.len(),
        }
    }

    /// The line of sample `k`, counted from 1.
    pub fn line(&self, k: usize) -> u64 {
        match self {
            Rows::All(_) => k as u64 + 1,
            Rows::Kept { lines, .. } => lines[k],
        }
    }

    /// The running number of sample `k`, counted from 0.
    pub fn number(&self, k: usize) -> u64 {
        match self {
            Rows::All(_) => k as u64,
            Rows::Kept { numbers, .. } => numbers[k],
        }
    }
}
