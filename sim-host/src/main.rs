//! The `drivemon` command.

use std::process::ExitCode;

use clap::Parser;
use sim_host::cli::Cli;

fn main() -> ExitCode {
    Cli::parse().run()
}
