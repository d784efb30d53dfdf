//! TOML files read with errors that a person can act on: file, line, key, value, range and remedy.
//!
//! The motor file and the scenario file are both read through [`Document`] and [`Section`]. Every
//! problem of a file is collected, so that one run shows all of them.

mod bounds;
mod problem;
mod section;
mod text;
mod value;

pub use bounds::Bounds;
pub use problem::{FileError, Problem};
pub use section::{Choice, Section};
pub use text::read_text;
pub use value::{Array, Entry, Table, Value};

use std::cell::RefCell;

/// A parsed TOML file and the problems found in it so far.
#[derive(Debug)]
pub struct Document {
    file: String,
    root: Table,
    problems: RefCell<Vec<Problem>>,
}

impl Document {
    /// Parses TOML text; `file` is the name that errors print.
    ///
    /// # Errors
    /// Text that is empty or not TOML, each problem with its line and the remedy.
    pub fn parse(text: &str, file: &str) -> Result<Document, FileError> {
        text::check_size(text.len() as u64).map_err(|message| FileError::whole(file, message))?;
        let root = value::parse(text, file)?;
        Ok(Document {
            file: file.to_owned(),
            root,
            problems: RefCell::new(Vec::new()),
        })
    }

    /// The top level of the file.
    pub fn root(&self) -> Section<'_> {
        Section::new(self, &self.root, String::new(), 1)
    }

    /// Records a problem at a line (counted from 1) and a key.
    pub fn report(&self, line: usize, key: &str, message: impl Into<String>) {
        self.problems.borrow_mut().push(Problem {
            file: self.file.clone(),
            line,
            key: key.to_owned(),
            message: message.into(),
        });
    }

    /// Whether nothing has been reported so far.
    pub fn is_clean(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// All problems so far, for a reader that cannot go on.
    pub fn failure(&self) -> FileError {
        sorted(self.problems.borrow().clone())
    }

    /// Ends reading: what was read, or every problem in the order of its line.
    ///
    /// # Errors
    /// All problems reported while reading; also when `value` is `None`, which a reader returns only
    /// after it has reported why.
    pub fn finish<T>(self, value: Option<T>) -> Result<T, FileError> {
        let problems = self.problems.into_inner();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => Err(sorted(problems)),
        }
    }
}

fn sorted(mut problems: Vec<Problem>) -> FileError {
    problems.sort_by_key(|problem| problem.line);
    FileError::new(problems)
}

#[cfg(test)]
mod tests;
