//! `drivemon board configure`: motor, line and relay of a board, changed over the line.

use std::path::PathBuf;
use std::thread::sleep;
use std::time::Duration;

use board::modbus::{Command, Field};
use board::{
    ACTIVE, CONFIGURATION_REGISTERS, Configuration, ConfigurationSource, Line, LineParity, Refused,
    RelayMode, STAGED,
};
use clap::{Args, ValueEnum};
use live::{ModbusLine, Registers};
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::line::{LineArgs, Parity};
use super::motor::{self, T_SAMPLE};
use super::order::order;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};

/// Change motor, line or relay of a board, without a programmer; without a change, show what holds.
///
/// What is written is checked by the board as a motor file is, and put on trial. It is stored only when it is confirmed over
/// the new line: this command does so. Where it cannot reach the board any more, the board goes back to what held before
/// after a minute; a power failure does the same at once. What the board has learnt holds for its motor constants only: let
/// it learn again behind a new motor file.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Configure {
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    changes: Changes,
    /// Put the motor back that the program was flashed with
    #[arg(long, conflicts_with_all = ["motor", "set_unit", "set_baud", "set_parity", "relay"])]
    flashed_motor: bool,
    /// Leave the change on trial, to be confirmed with --confirm within a minute
    #[arg(long)]
    trial: bool,
    /// Confirm what is on trial
    #[arg(long, conflicts_with_all = ["motor", "set_unit", "set_baud", "set_parity", "relay", "flashed_motor", "trial"])]
    confirm: bool,
    /// End a trial at once
    #[arg(long, conflicts_with_all = ["motor", "set_unit", "set_baud", "set_parity", "relay", "flashed_motor", "trial", "confirm"])]
    discard: bool,
    #[command(flatten)]
    json: JsonArgs,
}

/// What is to change.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is to change")]
struct Changes {
    /// Motor file whose constants, sensors and thresholds the board shall judge by
    #[arg(long, value_name = "M")]
    motor: Option<PathBuf>,
    /// Address of the board
    #[arg(long, value_name = "UNIT", value_parser = clap::value_parser!(u8).range(1..=247))]
    set_unit: Option<u8>,
    /// Speed of its line, bit/s
    #[arg(long, value_name = "BAUD", value_parser = clap::value_parser!(u32).range(1_200..=115_200))]
    set_baud: Option<u32>,
    /// Parity of its line; without parity there are two stop bits
    #[arg(long, value_enum)]
    set_parity: Option<Parity>,
    /// What opens the relay beside a dead board
    #[arg(long, value_enum)]
    relay: Option<Relay>,
}

const EXAMPLES: &str = "\
Examples:
  drivemon board configure --serial /dev/ttyUSB0                          what holds
  drivemon board configure --serial /dev/ttyUSB0 --motor motors/mine.toml another motor, or a better model of it
  drivemon board configure --serial /dev/ttyUSB0 --set-unit 7 --set-baud 38400
  drivemon board configure --serial /dev/ttyUSB0 --unit 7 --baud 38400 --relay blind
A board whose address nobody knows: hold its button while the power returns, and it answers as unit 1 at 19200 bit/s, even parity.
Exit codes: 0 done, 2 bad usage, no answer, or the board refuses.";

/// What opens the relay, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Relay {
    /// FAULT, or a doubt that stops judging
    Fault,
    /// The same, and a minute without a judgement
    Blind,
}

/// The configuration in force.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ConfigurationJson {
    /// Name of the motor.
    motor: String,
    /// Checksum of the motor's constants.
    motor_constants: String,
    /// Address on the bus.
    unit: u8,
    /// Speed of the line, bit/s.
    baud: u32,
    /// Parity of the line.
    parity: &'static str,
    /// What opens the relay.
    relay: &'static str,
    /// Where the configuration comes from.
    source: &'static str,
    /// Time that is left of a trial, s; 0 without one.
    trial_seconds_left: u16,
}

impl Answer for ConfigurationJson {
    const FORMAT: &'static str = "board-configure/1";
}

/// Between a command and a look at what it did: a block and the answer, and 40 ms of flash.
const PATIENCE: Duration = Duration::from_millis(300);
const LOOKS: u32 = 5;

impl Configure {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        // A wrong file is told before the line is asked.
        let motor = self.changes.motor.as_deref().map(motor::read).transpose()?;
        let mut line = self.line.open()?;
        Registers::read(&mut line)?;
        if self.discard {
            order(&mut line, Command::Discard)?;
            sleep(PATIENCE);
            // What holds again may have another line.
            say!("The trial has ended; the board answers as before it.");
            return Ok(Finding::Nothing);
        }
        if self.confirm {
            confirm(&mut line)?;
        }
        if self.flashed_motor {
            order(&mut line, Command::CommitCompiled)?;
            self.settle(&mut line)?;
        }
        let holds = read(&mut line)?;
        let wanted = self.changes.of(&holds, motor);
        if wanted != holds {
            write(&mut line, &wanted)?;
            order(&mut line, Command::Commit)?;
            line = self.follow(line, &wanted)?;
            self.settle(&mut line)?;
        }
        let told = tell(&mut line)?;
        self.json.give(&told, || print(&told))?;
        Ok(Finding::Nothing)
    }

    /// Over the new line; over the old one where the board has refused.
    fn follow(&self, mut old: ModbusLine, wanted: &Configuration) -> Result<ModbusLine, Failure> {
        sleep(PATIENCE);
        let settings = wanted.line().map_err(refusal)?;
        if settings == self.line.settings() {
            return Ok(old);
        }
        if let Ok(registers) = Registers::read(&mut old) {
            let refused = registers.word(Field::ConfigurationRefused);
            return Err(by_number(refused));
        }
        drop(old);
        let mut new = self.line.open_at(settings)?;
        Registers::read(&mut new)?;
        Ok(new)
    }

    /// on trial, and stored unless it is to stay on trial.
    fn settle(&self, line: &mut ModbusLine) -> Result<(), Failure> {
        wait_for(line, ConfigurationSource::Trial)?;
        if self.trial {
            return Ok(());
        }
        confirm(line)
    }
}

impl Changes {
    fn of(
        &self,
        holds: &Configuration,
        motor: Option<(String, board::MotorImage)>,
    ) -> Configuration {
        let mut wanted = holds.clone();
        let before = holds.line().unwrap_or_default();
        wanted.set_line(Line {
            unit: self.set_unit.unwrap_or(before.unit),
            baud: self.set_baud.unwrap_or(before.baud),
            parity: self.set_parity.map_or(before.parity, LineParity::from),
        });
        if let Some(relay) = self.relay {
            wanted.set_relay(match relay {
                Relay::Fault => RelayMode::Fault,
                Relay::Blind => RelayMode::FaultOrBlind,
            });
        }
        if let Some((name, image)) = motor {
            wanted.set_motor(&name, &image);
        }
        wanted
    }
}

fn read(line: &mut ModbusLine) -> Result<Configuration, Failure> {
    let registers = line.read_holding(ACTIVE, CONFIGURATION_REGISTERS)?;
    let mut holds = Configuration::BLANK;
    for (at, register) in (0..).zip(registers) {
        holds.set_register(at, register);
    }
    holds.line().map_err(|refused| match refused {
        Refused::Layout => Failure::Usage(
            "the board's configuration has another layout than this drivemon knows: use the drivemon of the firmware's version"
                .into(),
        ),
        other => refusal(other),
    })?;
    Ok(holds)
}

fn write(line: &mut ModbusLine, wanted: &Configuration) -> Result<(), Failure> {
    wanted.check(T_SAMPLE as f32).map_err(refusal)?;
    let registers: Vec<u16> = wanted.registers().collect();
    let bar = progress::bar("writing", u64::from(CONFIGURATION_REGISTERS));
    let mut first = STAGED;
    for part in registers.chunks(120) {
        line.write_holding(first, part)?;
        first += part.len() as u16;
        bar.inc(part.len() as u64);
    }
    bar.finish_and_clear();
    Ok(())
}

fn confirm(line: &mut ModbusLine) -> Result<(), Failure> {
    order(line, Command::Confirm)?;
    wait_for(line, ConfigurationSource::Confirmed)
}

fn wait_for(line: &mut ModbusLine, wanted: ConfigurationSource) -> Result<(), Failure> {
    for _ in 0..LOOKS {
        sleep(PATIENCE);
        let registers = Registers::read(line)?;
        let refused = registers.word(Field::ConfigurationRefused);
        match registers.word(Field::Configuration) {
            _ if refused != 0 => return Err(by_number(refused)),
            source if source == wanted as u16 => return Ok(()),
            _ => {}
        }
    }
    Err(Failure::Usage(
        "the board did not take the configuration; `drivemon board read` shows Configuration and ConfigurationRefused"
            .into(),
    ))
}

fn by_number(number: u16) -> Failure {
    let known = Refused::ALL
        .into_iter()
        .find(|refused| *refused as u16 == number);
    known.map_or_else(
        || Failure::Usage(format!("the board refuses the configuration ({number})")),
        refusal,
    )
}

fn refusal(refused: Refused) -> Failure {
    let remedy = match refused {
        Refused::Flash => {
            "; the supply may be low, and after a minute what held before holds again"
        }
        Refused::NoTrial => "; a trial lasts a minute",
        Refused::Layout | Refused::Effects | Refused::Choice => {
            "; firmware and drivemon must have the same version"
        }
        _ => "",
    };
    Failure::Usage(format!(
        "the configuration is refused: {}{remedy}",
        refused.label()
    ))
}

fn tell(line: &mut ModbusLine) -> Result<ConfigurationJson, Failure> {
    let holds = read(line)?;
    let registers = Registers::read(line)?;
    let settings = holds.line().map_err(refusal)?;
    let source = match registers.word(Field::Configuration) {
        0 => "as flashed",
        1 => "configured and confirmed",
        2 => "on trial",
        3 => {
            "line as configured, motor as flashed: the program was flashed with another motor since"
        }
        4 => "as flashed: what was configured is lost",
        _ => "unknown",
    };
    Ok(ConfigurationJson {
        motor: holds.name().text().unwrap_or_default().to_owned(),
        motor_constants: format!("{:08x}", holds.identification()),
        unit: settings.unit,
        baud: settings.baud,
        parity: match settings.parity {
            LineParity::None => "none",
            LineParity::Odd => "odd",
            LineParity::Even => "even",
        },
        relay: match holds.relay().map_err(refusal)? {
            RelayMode::Fault => "opens on FAULT",
            RelayMode::FaultOrBlind => "opens on FAULT, and after a minute without a judgement",
        },
        source,
        trial_seconds_left: registers.word(Field::TrialSeconds),
    })
}

fn print(told: &ConfigurationJson) {
    let row = |name: &str, value: String| say!("{}  {value}", paint::strong(format!("{name:15}")));
    row("motor", told.motor.clone());
    row("motor constants", told.motor_constants.clone());
    let line = format!(
        "unit {}, {} bit/s, parity {}",
        told.unit, told.baud, told.parity
    );
    row("line", line);
    row("relay", told.relay.into());
    let trial = match told.trial_seconds_left {
        0 => String::new(),
        seconds => format!(", {seconds} s left to confirm it"),
    };
    row("configuration", format!("{}{trial}", told.source));
}
