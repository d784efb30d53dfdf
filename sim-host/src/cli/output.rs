//! Results as files.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::failure::Failure;
use crate::report::{self, Subject};

/// Where results go besides the terminal.
#[derive(Debug, Args)]
pub struct OutputArgs {
    /// Write the whole result as JSON to FILE (`-` for standard output)
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the result as one self-contained page with figures to FILE.html
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
}

impl OutputArgs {
    /// Writes `value` where the user asked for it.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn write_json(&self, value: &impl Serialize) -> Result<(), Failure> {
        let Some(path) = &self.json else {
            return Ok(());
        };
        let mut text = serde_json::to_string_pretty(value).map_err(|error| {
            Failure::Usage(format!("the result cannot be written as JSON: {error}"))
        })?;
        text.push('\n');
        if path.as_os_str() == "-" {
            let written = std::io::stdout().write_all(text.as_bytes());
            return written.map_err(|error| cannot_write(path, error));
        }
        write_text(path, &text)
    }

    /// Writes `value` as JSON and as a page, each where the user asked for it.
    ///
    /// # Errors
    /// A path that cannot be written.
    pub fn write(&self, subject: Subject, value: &impl Serialize) -> Result<(), Failure> {
        self.write_json(value)?;
        let Some(path) = &self.report else {
            return Ok(());
        };
        let page = report::page(subject, value).map_err(|error| {
            Failure::Usage(format!("the result cannot be shown as a page: {error}"))
        })?;
        write_text(path, &page)
    }

    /// Whether the JSON takes standard output, so that nothing else may be printed there.
    pub fn takes_stdout(&self) -> bool {
        self.json
            .as_ref()
            .is_some_and(|path| path.as_os_str() == "-")
    }
}

/// Writes a text file, whole or not at all.
pub(super) fn write_text(path: &Path, text: &str) -> Result<(), Failure> {
    recording::write_whole(path, |file| file.write_all(text.as_bytes()))
        .map_err(|error| cannot_write(path, error))
}

fn cannot_write(path: &Path, error: std::io::Error) -> Failure {
    Failure::Write {
        path: path.display().to_string(),
        error,
    }
}
