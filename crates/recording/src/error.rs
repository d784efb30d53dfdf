//! What is wrong with an input, where, and how to put it right.

use std::fmt;
use std::path::Path;

/// Who is to act on an error; decides the exit code of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The input is malformed: the user corrects it. Exit code 2.
    BadInput,
    /// The input is sound, but this crate cannot use it. Exit code 3.
    Unsupported,
}

impl Class {
    /// The exit code of a program that stops because of this error.
    pub const fn exit_code(self) -> u8 {
        match self {
            Class::BadInput => 2,
            Class::Unsupported => 3,
        }
    }
}

/// One problem at one place of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The file as the user named it.
    pub file: String,
    /// Line, counted from 1; 0 when the problem is the file as a whole.
    pub line: u64,
    /// Column of a table or key of a sidecar; empty when none is to blame.
    pub field: String,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub remedy: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if self.line > 0 {
            write!(f, ":{}", self.line)?;
        }
        if !self.field.is_empty() {
            write!(f, ": {}", self.field)?;
        }
        write!(f, ": {}", self.message)?;
        if !self.remedy.is_empty() {
            write!(f, "; {}", self.remedy)?;
        }
        Ok(())
    }
}

/// Everything that is wrong with one input; printed one problem per line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    class: Class,
    problems: Vec<Problem>,
}

impl Error {
    /// A problem of the file as a whole that the user can correct.
    pub fn bad(file: &str, message: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::at(file, 0, "", message, remedy)
    }

    /// A problem at a line and in a column or key that the user can correct.
    pub fn at(
        file: &str,
        line: u64,
        field: &str,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Error {
        let problem = Problem {
            file: file.to_owned(),
            line,
            field: field.to_owned(),
            message: message.into(),
            remedy: remedy.into(),
        };
        Error {
            class: Class::BadInput,
            problems: vec![problem],
        }
    }

    /// A file that is sound but of a kind that cannot be used.
    pub fn unsupported(file: &str, message: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error {
            class: Class::Unsupported,
            ..Error::bad(file, message, remedy)
        }
    }

    /// Problems that the user can correct, in the order in which they are to be read.
    pub fn of(problems: Vec<Problem>) -> Error {
        Error {
            class: Class::BadInput,
            problems,
        }
    }

    /// Who is to act.
    pub fn class(&self) -> Class {
        self.class
    }

    /// The exit code of a program that stops because of this error: 2 or 3.
    pub fn exit_code(&self) -> u8 {
        self.class.exit_code()
    }

    /// The problems, in the order in which they are to be read.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// A file that the system does not give; the remedy fits the reason.
    pub fn io(path: &Path, error: &std::io::Error) -> Error {
        let remedy = match error.kind() {
            std::io::ErrorKind::NotFound => "check the name and the folder",
            std::io::ErrorKind::PermissionDenied => "allow this user to read it",
            _ => "check the file and the disk",
        };
        Error::bad(
            &path.display().to_string(),
            format!("cannot be opened: {error}"),
            remedy,
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{problem}")?;
        }
        Ok(())
    }
}
