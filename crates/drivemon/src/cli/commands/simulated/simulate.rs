//! `drivemon simulate`: a recording from a scenario file.

use std::path::PathBuf;

use clap::Args;

use crate::cli::arguments::files::{Files, spare_what_is_no_sidecar};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::progress;
use crate::cli::printing::terminal::say;
use scenario::Scenario;
use scenario::simulate;

/// Make a recording from a scenario: supply, load, faults, effects, sensors, seed.
///
/// The recording gets a sidecar beside it. The same scenario and seed give the same bytes.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Simulate {
    /// Scenario file
    #[arg(value_name = "SCENARIO")]
    scenario: PathBuf,
    /// Recording to write (.csv, .csv.gz or .parquet); the sidecar gets the same name with .toml
    #[arg(short, long, value_name = "REC")]
    output: PathBuf,
    /// Seed of the sensor noise, instead of the scenario's
    #[arg(long)]
    seed: Option<u64>,
}

const EXAMPLES: &str = "\
Examples:
  drivemon simulate sim-host/scenarios/direct-on-line-start.toml -o start.csv.gz
  drivemon monitor start.csv.gz --motor motors/peer-2k2.toml";

/// Steps of the progress bar.
const STEPS: u64 = 1000;

impl Simulate {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let mut scenario = Scenario::read(&self.scenario)?;
        Files::default()
            .reads("the scenario", &self.scenario)
            .may_read("the motor file", scenario.motor_path.as_ref())
            .writes_recording("-o", &self.output)
            .check()?;
        spare_what_is_no_sidecar(&self.output)?;
        scenario.seed = self.seed.unwrap_or(scenario.seed);
        let bar = progress::bar("simulating", STEPS);
        let done = |share: f64| bar.set_position((share * STEPS as f64) as u64);
        let pieces = simulate::Pieces::new(&scenario, formats::PIECE_ROWS, done);
        let pieces = pieces.map_err(|error| self.failure(&error))?;
        let (mut samples, mut span) = (0, None);
        let mut told = pieces.map(|piece| {
            let piece = piece.map_err(|error| self.failure(&error))?;
            let [begin, end] = [piece.t()[0], piece.t()[piece.len() - 1]];
            span = Some([span.map_or(begin, |[begin, _]: [f64; 2]| begin), end]);
            samples += piece.len();
            Ok::<_, Failure>(piece)
        });
        formats::write_in_pieces(&self.output, &mut told)?;
        drop(told);
        bar.finish_and_clear();
        say!(
            "{}: {samples} samples, {:.3} s of \"{}\"",
            self.output.display(),
            span.map_or(0.0, |[begin, end]| end - begin),
            scenario.name
        );
        Ok(Finding::Nothing)
    }

    fn failure(&self, error: &dyn std::fmt::Display) -> Failure {
        Failure::Usage(format!("{}: {error}", self.scenario.display()))
    }
}
