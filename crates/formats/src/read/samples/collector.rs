//! Gathers the columns of a file that are used, row by row or block by block.

use super::raw::{Kept, Piece, Raw, Rows};
use crate::read::budget::{most_numbers, too_large};
use crate::read::header::Header;
use crate::read::plan::Plan;
use crate::read::table_file::{Block, Row};
use recording::{Column, Error, Target};

struct UsedColumn {
    target: Target,
    index: usize,
    name: String,
}

/// The rows that were gathered and not yet given away.
pub(super) struct Collector {
    file: String,
    width: u64,
    used: Vec<UsedColumn>,
    values: Vec<Vec<f64>>,
    row: Vec<f64>,
    rows: Kept,
    taken: u64,
    skipped: u64,
    skip_missing: bool,
    /// Rows at the front that were in the piece before.
    before: usize,
    /// Whether all rows are to be kept, so that their number is bounded.
    is_bounded: bool,
}

impl Collector {
    /// With room for `room` rows; `is_bounded`: refuses more numbers than fit into memory.
    pub fn new(header: &Header, plan: &Plan, room: usize, is_bounded: bool) -> Collector {
        let used = plan.columns.iter().map(|(target, index)| UsedColumn {
            target: *target,
            index: *index,
            name: header.names[*index].clone(),
        });
        let used: Vec<UsedColumn> = used.collect();
        Collector {
            file: header.file.clone(),
            width: header.names.len() as u64,
            values: used.iter().map(|_| Vec::with_capacity(room)).collect(),
            row: vec![0.0; used.len()],
            used,
            rows: Kept::default(),
            taken: 0,
            skipped: 0,
            skip_missing: plan.mapping.skip_missing.unwrap_or(false),
            before: 0,
            is_bounded,
        }
    }

    /// Rows that were in no piece yet.
    pub fn fresh(&self) -> usize {
        self.rows.len() - self.before
    }

    /// Takes one row.
    ///
    /// # Errors
    /// A cell without a finite number, or too many rows.
    pub fn take(&mut self, cells: &dyn Row) -> Result<(), Error> {
        self.count(1)?;
        for (slot, column) in self.row.iter_mut().zip(&self.used) {
            match cells.number(column.index, &column.name)? {
                Some(x) if x.is_finite() => *slot = x,
                _ if self.skip_missing => {
                    self.skipped += 1;
                    return Ok(());
                }
                Some(x) => return Err(cells.not_finite(column.index, &column.name, x)),
                None => return Err(cells.missing(&column.name)),
            }
        }
        for (column, x) in self.values.iter_mut().zip(&self.row) {
            column.push(*x);
        }
        self.rows.push(1, cells.line(), self.taken - 1);
        Ok(())
    }

    /// Takes a block of rows, column by column where every number is finite.
    ///
    /// # Errors
    /// As [`Collector::take`].
    pub fn take_block(&mut self, block: &Block<'_>) -> Result<(), Error> {
        let is_whole =
            |column: &UsedColumn| block.column(column.index).iter().all(|x| x.is_finite());
        if !self.used.iter().all(is_whole) {
            return (0..block.rows()).try_for_each(|k| self.take(&block.row(k)));
        }
        self.count(block.rows() as u64)?;
        for (values, column) in self.values.iter_mut().zip(&self.used) {
            values.extend_from_slice(block.column(column.index));
        }
        let rows = block.rows();
        self.rows
            .push(rows, block.row(0).line(), self.taken - rows as u64);
        Ok(())
    }

    fn count(&mut self, rows: u64) -> Result<(), Error> {
        self.taken += rows;
        match self.is_bounded && self.taken.saturating_mul(self.width) > most_numbers() {
            true => Err(too_large(&self.file)),
            false => Ok(()),
        }
    }

    /// Goes on in the memory of the piece before, with room for `room` rows: growing step by step would leave holes in the
    /// memory, and new memory has to be cleared.
    pub fn go_on(&mut self, buffers: impl Iterator<Item = Vec<f64>>, room: usize) {
        let buffers = buffers.chain(std::iter::repeat_with(Vec::new));
        for (values, mut buffer) in self.values.iter_mut().zip(buffers) {
            buffer.clear();
            buffer.reserve_exact(room);
            buffer.append(values);
            *values = buffer;
        }
    }

    /// Gives away the first `rows` fresh rows with `margin` rows on either side, as far as there are any.
    pub fn give(&mut self, rows: usize, margin: usize) -> Piece {
        let kept = self.before..self.before + rows;
        let end = (kept.end + margin).min(self.rows.len());
        let again = kept.end.saturating_sub(margin);
        let targets = self.used.iter().map(|column| column.target);
        let columns = self.values.iter_mut().map(|x| front(x, end, again));
        let piece = Piece {
            raw: Raw {
                columns: targets.zip(columns.map(Column::from)).collect(),
                rows: Rows::Kept(self.rows.part(0..end)),
                skipped: self.skipped,
            },
            kept: kept.clone(),
        };
        self.rows = self.rows.part(again..self.rows.len());
        self.before = kept.end - again;
        piece
    }
}

/// The first `end` of `all`, which goes on with what follows from `again` on.
fn front(all: &mut Vec<f64>, end: usize, again: usize) -> Vec<f64> {
    let rest = all[again..].to_vec();
    let mut front = std::mem::replace(all, rest);
    front.truncate(end);
    front
}
