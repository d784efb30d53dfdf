//! `drivemon completions` and `drivemon man`: what a shell and `man` want to know, made from the same definitions as `--help`.

use std::path::PathBuf;

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::cli::Cli;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, terminal};

/// Print what a shell needs to complete drivemon's commands, flags and files
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  drivemon completions bash > ~/.local/share/bash-completion/completions/drivemon
  drivemon completions zsh > ~/.zfunc/_drivemon
  drivemon completions fish > ~/.config/fish/completions/drivemon.fish")]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Write manual pages, one for drivemon and one for each of its commands
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  drivemon man ~/.local/share/man/man1
  man drivemon-explain")]
pub struct Man {
    /// Folder to write into; it must exist
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

impl Completions {
    /// Prints the script.
    ///
    /// # Errors
    /// None.
    pub fn run(self) -> Result<Finding, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "drivemon", &mut script);
        terminal::bytes(&script);
        Ok(Finding::Nothing)
    }
}

impl Man {
    /// Writes the pages.
    ///
    /// # Errors
    /// The folder does not exist or cannot be written.
    pub fn run(self) -> Result<Finding, Failure> {
        let folder = self.folder.display();
        clap_mangen::generate_to(Cli::command(), &self.folder).map_err(|error| {
            Failure::Usage(format!(
                "{folder}: {error}; make the folder, or name another"
            ))
        })?;
        say!(
            "{folder}: {}",
            paint::strong("drivemon.1 and one page for each command")
        );
        Ok(Finding::Nothing)
    }
}
