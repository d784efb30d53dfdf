//! `drivemon fleet`.

use std::future::Future;

use clap::{Args, Subcommand};

use super::error::CommandError;
use super::export::Export;
use super::report::{PageOfMonth, Report};
use super::simulate::Simulate;
use super::terminal::Terminal;
use super::users::Users;

/// Plants of many motors: boards to try a gateway with, people, what was kept.
#[derive(Debug, Args)]
pub struct Fleet {
    #[command(subcommand)]
    command: FleetCommand,
}

#[derive(Debug, Subcommand)]
enum FleetCommand {
    /// Simulate boards on Modbus TCP, for trying a gateway and for training
    ///
    /// The protocol, the event log and the seconds are those of the board's own program. The motors are made up: they start,
    /// carry changing load, warm up and rest, and some begin to fail. Nothing about detection can be concluded from them.
    /// The samples around an alarm are those of a simulated 300 W motor with that fault.
    /// The boards have the addresses 1, 2, 3 ... of a line, as many as --per-port says; the next ones are behind the next port.
    #[command(after_help = "\
Examples:
  drivemon fleet simulate 20 --config-out plant.toml              20 healthy motors
  drivemon gateway plant.toml                                     in a second terminal
  drivemon fleet simulate 300 --faulty 3 --faults-within 60       three of them fail within a minute
Ctrl-C ends it.")]
    Simulate(Simulate),
    /// The people of a plant: who may see its page, acknowledge alarms, configure
    #[command(after_help = "\
Examples:
  drivemon fleet user add Anna --role acknowledge --fleet plant.toml   prints Anna's token, once
  drivemon fleet user list --fleet plant.toml
  drivemon fleet user remove Anna --fleet plant.toml                   the token is refused from now on
docs/fleet/page.md says what each role may do.")]
    User(Users),
    /// Write a day of seconds, or the recording of an alarm; also while the gateway runs
    #[command(after_help = "\
Examples:
  drivemon fleet export --fleet plant.toml --day 2026-11-25 -o 2026-11-25.parquet    for DuckDB, Polars, pandas
  drivemon fleet export --fleet plant.toml --alarm 17 -o alarm-17.csv                for drivemon explain and compare
docs/fleet/store.md names the columns. Seconds that were thinned to minutes are not in it.")]
    Export(Export),
    /// Write a month as a page: availability, alarms, who acknowledged them, models in force, trends; also while the gateway runs
    #[command(after_help = "\
Examples:
  drivemon fleet report --fleet plant.toml --month 2026-10 -o october.html
docs/fleet/page.md says what it counts, and how people mark a false alarm.")]
    Report(Report),
}

impl Fleet {
    /// Runs the command until `end`; `page` makes the page of a month.
    ///
    /// # Errors
    /// As the command's.
    pub fn run(
        &self,
        terminal: Terminal,
        page: PageOfMonth,
        end: impl Future<Output = ()>,
    ) -> Result<(), CommandError> {
        match &self.command {
            FleetCommand::Simulate(simulate) => simulate.run(terminal, end),
            FleetCommand::User(users) => users.run(terminal),
            FleetCommand::Export(export) => export.run(terminal),
            FleetCommand::Report(report) => report.run(page, terminal),
        }
    }
}
