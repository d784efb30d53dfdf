//! `drivemon motor`: motor files from plates, tables and tests.

mod catalogue;
pub(crate) mod identify;
mod new;
pub(crate) mod plate;
mod standard_tests;

use clap::{Args, Subcommand};
use report::json::Format;

use crate::cli::printing::failure::{Failure, Finding};

/// Motor files from a nameplate, standard tests, recordings or a table of motors; every parameter with an interval.
#[derive(Debug, Args)]
pub struct Motor {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(new::New),
    Tests(standard_tests::Tests),
    Catalogue(catalogue::Catalogue),
    Identify(identify::Identify),
}

impl Motor {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        match &self.command {
            Command::New(new) => new.run(),
            Command::Tests(tests) => tests.run(),
            Command::Catalogue(catalogue) => catalogue.run(),
            Command::Identify(identify) => identify.run(),
        }
    }
}

/// The formats of their JSON.
pub fn formats() -> Vec<Format> {
    vec![
        Format::of::<new::NewJson>(),
        Format::of::<standard_tests::TestsJson>(),
        Format::of::<identify::IdentifyJson<'_>>(),
        Format::of::<catalogue::CatalogueJson>(),
    ]
}
