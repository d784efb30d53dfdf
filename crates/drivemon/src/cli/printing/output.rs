//! Results as files.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use report::json::Answer;

use crate::cli::printing::failure::Failure;
use crate::cli::printing::terminal;
use report::{self, Subject};

/// Where results go besides the terminal.
#[derive(Debug, Args)]
pub struct OutputArgs {
    #[command(flatten)]
    pub json: JsonArgs,
    /// Write the result as one self-contained page with figures to FILE.html
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
}

/// Where the result goes as JSON.
#[derive(Debug, Args)]
pub struct JsonArgs {
    /// Write the whole result as JSON to FILE (`-` for standard output)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// The name of standard output, and for standard input.
pub(crate) const DASH: &str = "-";

impl OutputArgs {
    /// Writes the files that the user asked for, then shows the result on the terminal, unless the JSON takes it.
    ///
    /// # Errors
    /// A path that cannot be written; the result is shown all the same.
    pub fn give(
        &self,
        subject: Subject,
        value: &impl Answer,
        show: impl FnOnce(),
    ) -> Result<(), Failure> {
        let page = self.write_page(subject, value);
        self.json.give(value, show).and(page)
    }

    fn write_page(&self, subject: Subject, value: &impl Answer) -> Result<(), Failure> {
        let Some(path) = &self.report else {
            return Ok(());
        };
        let page = report::page(subject, value).map_err(|error| {
            Failure::Usage(format!("the result cannot be shown as a page: {error}"))
        })?;
        write_text(path, &page)
    }
}

impl JsonArgs {
    /// Writes the file that the user asked for, then shows the result on the terminal, unless the JSON takes it.
    ///
    /// # Errors
    /// A path that cannot be written; the result is shown all the same.
    pub fn give(&self, value: &impl Answer, show: impl FnOnce()) -> Result<(), Failure> {
        let written = self.write(value);
        self.show(show);
        written
    }

    /// Shows something on the terminal, unless the JSON takes it.
    pub fn show(&self, show: impl FnOnce()) {
        if !self.takes_stdout() {
            show();
        }
    }

    /// Writes `value` where the user asked for it.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn write(&self, value: &impl Answer) -> Result<(), Failure> {
        match &self.json {
            // A long answer is not made a text first: it would be in memory once more.
            Some(path) if path.as_os_str() != DASH => write_json(path, value),
            Some(_) => self.write_text(&text_of(value)?),
            None => Ok(()),
        }
    }

    /// Writes a text that is JSON already.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn write_text(&self, text: &str) -> Result<(), Failure> {
        match &self.json {
            Some(path) if path.as_os_str() == DASH => {
                terminal::bytes(format!("{text}\n").as_bytes());
                Ok(())
            }
            Some(path) => write_text(path, &format!("{text}\n")),
            None => Ok(()),
        }
    }

    /// The file that is written; none where the JSON goes to standard output.
    pub fn file(&self) -> Option<&PathBuf> {
        self.json.as_ref().filter(|path| path.as_os_str() != DASH)
    }

    /// Whether the JSON takes standard output, so that nothing else may be printed there.
    pub fn takes_stdout(&self) -> bool {
        self.json
            .as_ref()
            .is_some_and(|path| path.as_os_str() == DASH)
    }
}

/// A value as JSON, in lines.
///
/// # Errors
/// A value that JSON cannot say.
pub(crate) fn text_of(value: &impl Answer) -> Result<String, Failure> {
    report::json::text(value)
        .map_err(|error| Failure::Usage(format!("the result cannot be written as JSON: {error}")))
}

fn write_json(path: &Path, value: &impl Answer) -> Result<(), Failure> {
    formats::write_whole(path, |file| {
        report::json::write(value, &mut *file)?;
        file.write_all(b"\n")
    })
    .map_err(|error| cannot_write(path, error))
}

/// Writes a text file, whole or not at all.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file, whole or not at all.
pub(crate) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    formats::write_whole(path, |file| file.write_all(bytes))
        .map_err(|error| cannot_write(path, error))
}

fn cannot_write(path: &Path, error: std::io::Error) -> Failure {
    Failure::Write {
        path: path.display().to_string(),
        error,
    }
}
