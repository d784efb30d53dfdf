//! What is durable of each motor: the numbers above which something is new.

use std::collections::HashMap;

use rusqlite::Connection;

use crate::entry::{Gap, GapOf};
use crate::motor::MotorId;

/// What is durable of one motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks {
    /// Key of the motor.
    pub key: i64,
    /// How many boards this motor had before: numbers begin anew with each.
    pub board: u32,
    /// Newest event.
    pub event: u32,
    /// Newest second: start and number.
    pub second: Option<(u32, u32)>,
}

/// What a number is, beside what is durable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// Stored before.
    Already,
    /// The next one.
    Next,
    /// New, and the numbers from this one up to the one before are missing.
    After(u32),
}

impl Marks {
    /// Takes an event's number.
    pub fn event(&mut self, number: u32) -> Found {
        let before = self.event;
        if number <= before {
            return Found::Already;
        }
        self.event = number;
        // What the log held before this store first saw the board was never promised.
        match before != 0 && number > before + 1 {
            true => Found::After(before + 1),
            false => Found::Next,
        }
    }

    /// Takes a second's number. A start later than the one before is a new run of the program.
    pub fn second(&mut self, start: u32, number: u32) -> Found {
        let Some(before) = self.second else {
            self.second = Some((start, number));
            return Found::Next;
        };
        if (start, number) <= before {
            return Found::Already;
        }
        self.second = Some((start, number));
        let expected = if start == before.0 { before.1 + 1 } else { 1 };
        match number > expected {
            true => Found::After(expected),
            false => Found::Next,
        }
    }

    /// A gap that was told: its numbers will not come. `false`: they came, or were told before.
    pub fn gap(&mut self, gap: &Gap) -> bool {
        match gap.what {
            GapOf::Events if gap.last <= self.event => return false,
            GapOf::Events => self.event = gap.last,
            GapOf::Seconds { start } if self.second.is_some_and(|m| (start, gap.last) <= m) => {
                return false;
            }
            GapOf::Seconds { start } => self.second = Some((start, gap.last)),
            // Frames cannot be asked again: the reader that counts them tells each gap once.
            GapOf::Frames => {}
        }
        true
    }

    /// Another board: its numbers begin anew.
    pub fn new_board(&mut self) {
        *self = Self {
            key: self.key,
            board: self.board + 1,
            ..Self::default()
        };
    }
}

/// Marks of all motors.
pub(super) fn read(connection: &Connection) -> rusqlite::Result<HashMap<MotorId, Marks>> {
    let text = "SELECT id, key, board, event, mark_start, mark_number FROM motor JOIN state ON state.motor = motor.key";
    let mut statement = connection.prepare(text)?;
    let rows = statement.query_map([], |row| {
        let second = row.get::<_, Option<u32>>(4)?.zip(row.get(5)?);
        let marks = Marks {
            key: row.get(1)?,
            board: row.get(2)?,
            event: row.get(3)?,
            second,
        };
        Ok((super::id_of(row, 0)?, marks))
    })?;
    rows.collect()
}
