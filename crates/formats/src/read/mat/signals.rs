//! Which variables of a MAT-file are signals, and what their columns are called.

use super::super::columns::check_size;
use super::super::header::Unreadable;
use super::array::{Array, Content};
use recording::{Error, Target};

/// The columns of a file.
#[derive(Default)]
pub(super) struct Signals {
    /// Name and values of each.
    pub columns: Vec<(String, Vec<f64>)>,
    /// The variables that are no column.
    pub unreadable: Vec<Unreadable>,
}

/// The columns of variables: a vector gives one, a matrix one per signal (`i_1 i_2 i_3`), a structure
/// one per field (`drive.va`).
///
/// # Errors
/// No vector at all, or a channel of another length than the clock.
pub(super) fn of(file: &str, arrays: Vec<Array>) -> Result<Signals, Error> {
    let mut signals = Signals::default();
    for mut array in arrays {
        let name = std::mem::take(&mut array.name);
        signals.add(file, name, array)?;
    }
    if signals.columns.is_empty() {
        let remedy = "save each signal as a vector: t, va, vb, vc, ia, ib, ic, speed";
        return Err(Error::bad(file, "holds no vector of numbers", remedy));
    }
    signals.keep_one_length();
    Ok(signals)
}

impl Signals {
    fn add(&mut self, file: &str, name: String, array: Array) -> Result<(), Error> {
        match array.content {
            Content::Numbers(values) => self.split(file, &name, &array.extents, values)?,
            Content::Fields(fields) => {
                for (field, array) in fields {
                    self.add(file, format!("{name}.{field}"), array)?;
                }
            }
            Content::Other(what) => self.leave_out(&name, what),
        }
        Ok(())
    }

    fn leave_out(&mut self, name: &str, what: &str) {
        self.unreadable.push(Unreadable::holds(name, what));
    }

    /// Signals run along the longer direction of a matrix.
    fn split(
        &mut self,
        file: &str,
        name: &str,
        extents: &[usize],
        values: Vec<f64>,
    ) -> Result<(), Error> {
        let &[rows, columns] = extents else {
            self.leave_out(name, "an array of more than two directions");
            return Ok(());
        };
        match (rows, columns) {
            (0, _) | (_, 0) => self.leave_out(name, "nothing"),
            (1, 1) => self.leave_out(name, "one number, not a signal"),
            (1, _) | (_, 1) => self.columns.push((name.to_owned(), values)),
            (rows, columns) => {
                check_size(file, rows as u64, columns)?;
                let (samples, signals) = (rows.max(columns), rows.min(columns));
                // Along columns a signal's samples are neighbours, along rows they are a row apart.
                let (next, first) = if rows >= columns {
                    (1, rows)
                } else {
                    (rows, 1)
                };
                for k in 0..signals {
                    let at = |n: usize| values[k * first + n * next];
                    let signal = (0..samples).map(at).collect();
                    self.columns.push((format!("{name}_{}", k + 1), signal));
                }
            }
        }
        Ok(())
    }

    /// Leaves out what is not as long as the clock, unless it is named as a channel: then it is an
    /// error that somebody else reports.
    fn keep_one_length(&mut self) {
        let clock = self.columns.iter().find(|(name, _)| name == "t");
        let longest = self.columns.iter().map(|(_, values)| values.len()).max();
        let length = clock.map_or(longest.unwrap_or(0), |(_, values)| values.len());
        let columns = std::mem::take(&mut self.columns);
        for (name, values) in columns {
            if values.len() == length || Target::parse(&name).is_some() {
                self.columns.push((name, values));
            } else {
                let what = format!("{} values, not {length}", values.len());
                self.leave_out(&name, &what);
            }
        }
    }
}
