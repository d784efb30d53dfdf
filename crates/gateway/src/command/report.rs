//! `drivemon fleet report`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::error::CommandError;
use super::terminal::Terminal;
use super::users::OfPlant;

/// Makes the page of a month: of a store, and the month as it was asked for.
pub type PageOfMonth = fn(&Path, &str) -> Result<String, String>;

/// A month of a plant as a page.
#[derive(Debug, Args)]
pub(super) struct Report {
    #[command(flatten)]
    of: OfPlant,
    /// The month in UTC, as 2026-10; one that is not over is counted up to now
    #[arg(long, value_name = "YYYY-MM")]
    month: String,
    /// The page to write, HTML
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl Report {
    /// Runs the command.
    pub fn run(&self, page: PageOfMonth, terminal: Terminal) -> Result<(), CommandError> {
        let page = page(&self.of.store()?, &self.month);
        let page = page.map_err(CommandError::Output)?;
        std::fs::write(&self.output, page).map_err(|error| CommandError::File {
            option: "-o",
            path: self.output.display().to_string(),
            error,
        })?;
        (terminal.complain)(&format!("{}: {}", self.output.display(), self.month));
        Ok(())
    }
}
