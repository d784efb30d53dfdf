//! `drivemon board prepare`, `acknowledge`, `learn`: commands to a board.

use board::modbus::{Command, UNLOCK_KEY};
use clap::Args;
use live::ModbusLine;

use super::line::LineArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;

/// Write the option bytes of a new board and start it again; once for each board.
///
/// They let hardware start the watchdog, switch on the parity of the RAM and the brown-out level. SENSOR blinks until then.
#[derive(Debug, Args)]
pub struct Prepare {
    #[command(flatten)]
    line: LineArgs,
}

/// Forget lamps that stayed lit and doubts that were seen; starts a board again that gave up after three crashes.
#[derive(Debug, Args)]
pub struct Acknowledge {
    #[command(flatten)]
    line: LineArgs,
}

/// Let the board learn from its motor, which has to be healthy, warm and steady; ten seconds at 60 Hz.
#[derive(Debug, Args)]
pub struct Learn {
    #[command(flatten)]
    line: LineArgs,
}

impl Prepare {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        order(&mut self.line.open()?, Command::Prepare)?;
        say!("The board writes its option bytes and starts again.");
        Ok(Finding::Nothing)
    }
}

impl Acknowledge {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        order(&mut self.line.open()?, Command::Acknowledge)?;
        say!("Acknowledged.");
        Ok(Finding::Nothing)
    }
}

impl Learn {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        order(&mut self.line.open()?, Command::Learn)?;
        say!(
            "The board learns: r1 to r4 blink. `drivemon board read` shows Learning: 2 stored, 17 and more refused."
        );
        Ok(Finding::Nothing)
    }
}

/// Key and command in one request.
pub fn order(line: &mut ModbusLine, command: Command) -> Result<(), Failure> {
    Ok(line.write_holding(0, &[UNLOCK_KEY, command as u16])?)
}
