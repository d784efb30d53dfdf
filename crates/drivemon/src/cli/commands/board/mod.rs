//! `drivemon board`: a board in the field, over its Modbus line.

mod configure;
mod events;
mod identify;
mod key;
mod line;
pub(super) mod motor;
mod order;
mod package;
mod read;
mod record;
mod update;

use clap::{Args, Subcommand};

use report::json::Format;

use crate::cli::printing::failure::{Failure, Finding};

/// Ask a board in the field, and tell it what to do, over its Modbus line (RS-485).
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Board {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  drivemon board read --serial /dev/ttyUSB0              every value of the register map, with its unit
  drivemon board record --serial /dev/ttyUSB0            what ended the program, and what the board doubts about itself
  drivemon board events --serial /dev/ttyUSB0            what happened: starts, crashes, lamps, doubts, learning
  drivemon board configure --serial /dev/ttyUSB0 --motor motors/mine.toml   another motor, without a programmer
  drivemon board identify --serial /dev/ttyUSB0          which board it is: program, serial number, motor, calibration
  drivemon board record --serial /dev/ttyUSB0 --elf drive-monitor     the same with function, file and line
  drivemon board prepare --serial COM4                   a new board: write its option bytes, once
  drivemon board update new.dmu --serial /dev/ttyUSB0    another program, signed with your key (board key, board package)
Needs: an RS-485 adapter on the board's A and B (docs/wiring.md). Factory settings: 19200 bit/s, even parity, unit 1.
Exit codes: 0 done and nothing found, 1 a doubt or a crash, 2 bad usage, no answer, or a refusal.";

#[derive(Debug, Subcommand)]
enum Command {
    Read(read::ReadBoard),
    Identify(identify::Identify),
    Events(events::Events),
    Configure(configure::Configure),
    Record(record::Record),
    Prepare(order::Prepare),
    Acknowledge(order::Acknowledge),
    Learn(order::Learn),
    Key(key::Key),
    Package(package::MakePackage),
    Update(update::Update),
}

impl Board {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        match &self.command {
            Command::Read(read) => read.run(),
            Command::Identify(identify) => identify.run(),
            Command::Events(events) => events.run(),
            Command::Configure(configure) => configure.run(),
            Command::Record(record) => record.run(),
            Command::Prepare(prepare) => prepare.run(),
            Command::Acknowledge(acknowledge) => acknowledge.run(),
            Command::Learn(learn) => learn.run(),
            Command::Key(key) => key.run(),
            Command::Package(package) => package.run(),
            Command::Update(update) => update.run(),
        }
    }
}

/// The formats of their JSON.
pub fn formats() -> Vec<Format> {
    vec![
        Format::of::<read::ReadJson>(),
        Format::of::<identify::IdentityJson<'_>>(),
        Format::of::<events::EventsJson>(),
        Format::of::<record::RecordJson>(),
        Format::of::<configure::ConfigurationJson>(),
        Format::of::<update::UpdateJson>(),
    ]
}
