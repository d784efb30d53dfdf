//! `drivemon board key`: the pair of keys that programs are signed and checked with.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Make the pair of keys that programs for your boards are signed and checked with.
#[derive(Debug, Args)]
pub struct Key {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(New),
}

/// Make a new pair: NAME.key signs programs and stays with you, NAME.pub goes into the loader of each board.
///
/// Of random numbers of the operating system (Ed25519). A file that exists is never overwritten. One pair serves all boards
/// of an owner; boards whose loader has another public half take no program that this one signs.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct New {
    /// Name of the key, or a path that ends in it
    #[arg(value_name = "NAME")]
    name: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  drivemon board key new plant-7                                       plant-7.key and plant-7.pub
  DRIVE_MONITOR_UPDATE_KEY=plant-7.pub drivemon flash --motor M        a board whose loader checks with it, once
  drivemon board package ELF --key plant-7.key -o new.dmu              a program that such a board takes
Keep NAME.key where no other person reads it, and a copy in a second place, e.g. printed in a safe. Lost: the boards take no
new program over the line any more, only by a debugger. Leaked: anybody who has it can sign programs that they take.";

impl Key {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let Command::New(new) = &self.command;
        let [secret, public] = program::new_key(&new.name)?;
        let (secret, public) = (secret.display(), public.display());
        say!(
            "{}  signs programs; keep it to yourself, with a copy in a second place",
            paint::strong(&secret)
        );
        say!(
            "{}  goes into the loader: DRIVE_MONITOR_UPDATE_KEY={public}; everybody may have it",
            paint::strong(&public)
        );
        say!(
            "Lost: your boards can only be written with a debugger. Leaked: anybody who has {secret} can sign programs for them."
        );
        Ok(Finding::Nothing)
    }
}
