//! The names of a file's columns.

use crate::error::Error;

/// What a file says about its columns before the first sample.
pub(super) struct Header {
    /// The file as the user named it.
    pub file: String,
    /// Line of the header, counted from 1; 0 in a binary file.
    pub line: u64,
    /// The column names, trimmed and without quotes; none is empty or stands there twice.
    pub names: Vec<String>,
    /// The unit that the file declares for each column; empty when it declares none at all.
    pub units: Vec<Option<String>>,
    /// What had to be assumed to read the file, one sentence each.
    pub notes: Vec<String>,
    /// Columns that cannot be used: refused where they are asked for, named where they are not.
    pub unreadable: Vec<Unreadable>,
}

/// A column that is there and cannot be read.
pub(super) struct Unreadable {
    /// Its name.
    pub name: String,
    /// Why, as a sentence about it.
    pub why: String,
    /// What the user can do about it.
    pub remedy: &'static str,
}

impl Unreadable {
    /// A column of something else than numbers: `what` says of what.
    pub fn holds(name: &str, what: &str) -> Unreadable {
        Unreadable {
            name: name.to_owned(),
            why: format!("it holds {what}"),
            remedy: "export it as a column of real numbers, one per sample, or map another column with --column",
        }
    }

    /// The sentence for a column that was not asked for.
    pub fn note(&self) -> String {
        format!("column {} is not used: {}", shown(&self.name), self.why)
    }
}

impl Header {
    /// A header without units.
    ///
    /// # Errors
    /// Names that are empty, stand there twice, or are numbers.
    pub fn new(file: String, line: u64, names: Vec<String>) -> Result<Header, Error> {
        check(&file, line, &names)?;
        Ok(Header {
            file,
            line,
            names,
            units: Vec::new(),
            notes: Vec::new(),
            unreadable: Vec::new(),
        })
    }

    /// An error about the header, at its line.
    pub fn error(&self, field: &str, message: impl Into<String>, remedy: &str) -> Error {
        Error::at(&self.file, self.line, field, message, remedy)
    }
}

fn check(file: &str, line: u64, names: &[String]) -> Result<(), Error> {
    let bad = |message: String, remedy: &str| Err(Error::at(file, line, "", message, remedy));
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        let message = "the first line holds numbers, not column names".to_owned();
        return bad(
            message,
            "put a line such as t,va,vb,vc,ia,ib,ic,speed before it",
        );
    }
    for (k, name) in names.iter().enumerate() {
        if name.is_empty() {
            return bad(
                format!("column {} has no name", k + 1),
                "name it, or remove it",
            );
        }
        if names[..k].contains(name) {
            let message = format!("column `{}` stands there twice", shown(name));
            return bad(message, "rename or remove one of the two");
        }
    }
    Ok(())
}

/// A name from a file, cut to what fits a message.
pub(super) fn shown(name: &str) -> String {
    name.chars().take(40).filter(|c| !c.is_control()).collect()
}
