//! The command line: one file per subcommand.

mod arguments;
mod commands;
mod printing;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub use printing::failure::{Failure, Finding};

/// Monitor a three-phase induction motor, and find out where its model is wrong.
#[derive(Debug, Parser)]
#[command(name = "drivemon", version, about, long_about = LONG_ABOUT, after_help = AFTER_HELP)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

const LONG_ABOUT: &str = "\
Monitor a three-phase induction motor, and find out where its model is wrong.

drivemon runs the same core that lights the lamps on the board: phase voltages, phase currents and the
encoder become four residuals r1..r4, the residuals meet thresholds, and the pattern of lamps names what
is likely wrong with the motor or with a sensor.";

const AFTER_HELP: &str = "\
First steps:
  drivemon demo                                        the whole method on a simulated motor, in seconds
  drivemon simulate SCENARIO.toml -o rec.csv.gz        make a recording with a fault in it
  drivemon check rec.csv --plate plate.toml            is it in good order? From a nameplate and a recording
  drivemon motor new --ask -o motor.toml               a motor file from a nameplate
  drivemon monitor rec.csv.gz --motor motor.toml       see what the lamps would have shown
  drivemon compare rec.csv.gz --motor motor.toml       where the model fails
  drivemon explain rec.csv.gz --motor motor.toml       which physical effect it misses
  drivemon adopt EFFECT rec.csv.gz --motor motor.toml -o better.toml
  drivemon export better.toml --to python              the model in another language: Python, C, MATLAB, Modelica, FMU
  drivemon calibrate healthy.csv.gz --motor motor.toml -o calibrated.toml
  drivemon batch DIR --motor-map map.toml -o out.parquet   many recordings, one row each
  drivemon panel                                       the lamps in a browser, on a simulated motor
  drivemon gateway plant.toml                          many boards, one store
  drivemon flash --motor motor.toml                    build the firmware for this motor and write it to the board
  drivemon board read --serial PORT                    ask a board in the field

Exit codes: 0 fine or healthy, 1 a finding (a fault was lit), 2 bad input or usage, 3 the data do not support an answer.
Colour is left out when NO_COLOR is set or the output is not a terminal.
A fault monitor is no protection device: it does not replace fuses, motor protection switches or safety relays.";

// One of them exists in a run of the program.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Subcommand)]
enum Command {
    Demo(commands::simulated::demo::Demo),
    Simulate(commands::simulated::simulate::Simulate),
    Monitor(commands::monitor::MonitorArgs),
    Compare(commands::study::compare::Compare),
    Explain(commands::study::explain::Explain),
    Adopt(commands::study::adopt::Adopt),
    Export(commands::export::Export),
    Campaign(commands::simulated::campaign::Campaign),
    Calibrate(commands::calibrate::Calibrate),
    Check(commands::check::Check),
    Batch(commands::batch::Batch),
    Motor(commands::motor::Motor),
    #[cfg(feature = "panel")]
    Panel(commands::panel::Panel),
    #[cfg(feature = "gateway")]
    Gateway(commands::gateway::GatewayArgs),
    #[cfg(feature = "gateway")]
    Fleet(commands::gateway::Fleet),
    Flash(commands::flash::Flash),
    Board(commands::board::Board),
    Schema(commands::schema::SchemaArgs),
    Completions(commands::completions::Completions),
    Man(commands::completions::Man),
}

impl Cli {
    /// Shows the help, the version, or what is wrong with a command line; the exit code.
    pub fn answer(error: &clap::Error) -> ExitCode {
        printing::terminal::page(error);
        match printing::terminal::finish() {
            Err(failure) => ExitCode::from(told(&failure)),
            Ok(()) => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
        }
    }

    /// Runs the chosen subcommand and turns its outcome into the exit code.
    pub fn run(self) -> ExitCode {
        let outcome = match self.command {
            Command::Demo(demo) => demo.run(),
            Command::Simulate(simulate) => simulate.run(),
            Command::Monitor(monitor) => monitor.run(),
            Command::Compare(compare) => compare.run(),
            Command::Explain(explain) => explain.run(),
            Command::Adopt(adopt) => adopt.run(),
            Command::Export(export) => export.run(),
            Command::Campaign(campaign) => campaign.run(),
            Command::Calibrate(calibrate) => calibrate.run(),
            Command::Check(check) => check.run(),
            Command::Batch(batch) => batch.run(),
            Command::Motor(motor) => motor.run(),
            #[cfg(feature = "panel")]
            Command::Panel(panel) => panel.run(),
            #[cfg(feature = "gateway")]
            Command::Gateway(gateway) => gateway.run(),
            #[cfg(feature = "gateway")]
            Command::Fleet(fleet) => commands::gateway::fleet(&fleet),
            Command::Flash(flash) => flash.run(),
            Command::Board(board) => board.run(),
            Command::Schema(schema) => schema.run(),
            Command::Completions(completions) => completions.run(),
            Command::Man(man) => man.run(),
        };
        ExitCode::from(concluded(outcome))
    }
}

/// Ends the output and says what failed; the exit code.
fn concluded(outcome: Result<Finding, Failure>) -> u8 {
    let shown = printing::terminal::finish();
    let failures = [outcome.as_ref().err(), shown.as_ref().err()];
    // 2, bad input or usage, outweighs 3.
    let code = failures.into_iter().flatten().map(told).min();
    code.unwrap_or_else(|| outcome.map_or(0, Finding::exit_code))
}

/// Prints what failed; the exit code.
fn told(failure: &Failure) -> u8 {
    printing::terminal::complain(format_args!(
        "{}{failure}",
        printing::paint::error("error: ")
    ));
    failure.exit_code()
}
