//! What is wrong with a file, where, and how to put it right.

use std::fmt;

/// One problem at one place of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The file as the user named it.
    pub file: String,
    /// Line, counted from 1; 0 when the problem is the file as a whole.
    pub line: usize,
    /// The key with its section, `parameters.inertia_kg_m2`; empty when no key is to blame.
    pub key: String,
    /// What is wrong, the allowed range and the remedy.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.key.as_str()) {
            (0, _) => write!(f, "{}: {}", self.file, self.message),
            (line, "") => write!(f, "{}:{line}: {}", self.file, self.message),
            (line, key) => write!(f, "{}:{line}: {key}: {}", self.file, self.message),
        }
    }
}

/// Problems that are printed; a file with more is not the one that was meant.
const MOST_SHOWN: usize = 50;

/// All problems of one file; printed one per line, the first fifty.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct FileError {
    problems: Vec<Problem>,
}

impl FileError {
    /// An error made of problems in the order in which they are to be read.
    pub fn new(problems: Vec<Problem>) -> FileError {
        FileError { problems }
    }

    /// A problem of the file as a whole: absent, empty, not text.
    pub fn whole(file: &str, message: impl Into<String>) -> FileError {
        FileError::new(vec![Problem {
            file: file.to_owned(),
            line: 0,
            key: String::new(),
            message: message.into(),
        }])
    }

    /// The problems, in the order of their lines.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().take(MOST_SHOWN).enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            write!(f, "{problem}")?;
        }
        match self.problems.len().saturating_sub(MOST_SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n... and {more} more problems"),
        }
    }
}
