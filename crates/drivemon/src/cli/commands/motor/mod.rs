//! `drivemon motor`: motor files from plates, tables and tests.

mod catalogue;
pub(crate) mod identify;
mod new;
pub(crate) mod plate;

use clap::{Args, Subcommand};

use crate::cli::printing::failure::{Failure, Finding};

/// Motor files from a nameplate or a table of motors; every parameter with an interval.
#[derive(Debug, Args)]
pub struct Motor {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(new::New),
    Catalogue(catalogue::Catalogue),
    Identify(identify::Identify),
}

impl Motor {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        match &self.command {
            Command::New(new) => new.run(),
            Command::Catalogue(catalogue) => catalogue.run(),
            Command::Identify(identify) => identify.run(),
        }
    }
}
