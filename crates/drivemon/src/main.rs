//! The `drivemon` command.

use std::process::ExitCode;

use clap::Parser;
use drivemon::cli::Cli;

fn main() -> ExitCode {
    match Cli::try_parse() {
        Ok(cli) => cli.run(),
        Err(error) => Cli::answer(&error),
    }
}
