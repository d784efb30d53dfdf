//! `drivemon motor catalogue`: the circuits of many motors at once.

use std::path::{Path, PathBuf};

use clap::Args;
use nameplate::catalogue::{Row, header, read, record};
use nameplate::{COLUMN_KEYS, Estimate};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::arguments::files::Files;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{JsonArgs, write_text};
use crate::cli::printing::progress;
use crate::cli::printing::terminal::say;

/// Equivalent circuits for a table of motors.
///
/// IN.csv has one motor per row and any of the columns power_kw, voltage_volt, frequency_hz, speed_rpm, efficiency_percent,
/// power_factor, current_amp, breakdown_torque_ratio, locked_rotor_torque_ratio, locked_rotor_current_ratio; an empty cell is
/// unknown, other columns are passed on. OUT.csv adds every parameter with its 95 % interval, what the circuit gives for
/// each column, the worst relative error, and what contradicts what. A motor takes a few milliseconds on each core.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Catalogue {
    /// Table of motors
    #[arg(value_name = "IN.csv")]
    input: PathBuf,
    /// Table to write
    #[arg(short, long = "out", value_name = "OUT.csv")]
    out: PathBuf,
    #[command(flatten)]
    json: JsonArgs,
}

const EXAMPLES: &str = "\
Example:
  drivemon motor catalogue motors.csv -o circuits.csv
Exit codes: 0 every motor has its circuit, 1 some rows have contradictions or no circuit (columns contradiction and problem),
2 bad input.";

/// What came of a list of plates.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CatalogueJson {
    /// Rows of the table.
    motors: usize,
    /// Of these with a circuit.
    solved: usize,
    /// Of these with numbers that contradict each other.
    contradictions: usize,
    /// Largest difference between plate and circuit, the median over the motors, percent.
    median_worst_error_percent: f64,
    /// Motors whose largest difference is at most 1 %.
    within_1_percent: usize,
    /// Motors whose largest difference is at most 5 %.
    within_5_percent: usize,
    /// Time that it took, s.
    seconds: f64,
}

impl report::json::Answer for CatalogueJson {
    const FORMAT: &'static str = "motor-catalogue/1";
}

type Answer = Result<Estimate, String>;

impl Catalogue {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        Files::default()
            .reads("the table", &self.input)
            .writes("-o", &self.out)
            .may_write("--json", self.json.file())
            .check()?;
        let (input, rows) = self.read()?;
        let begun = std::time::Instant::now();
        let answers = answers(&rows);
        let seconds = begun.elapsed().as_secs_f64();
        write_text(&self.out, &table(&input, &rows, &answers)?)?;
        let result = summary(&answers, seconds);
        self.json.give(&result, || print(&result, &self.out))?;
        let clean = result.solved == result.motors && result.contradictions == 0;
        Ok(if clean {
            Finding::Nothing
        } else {
            Finding::Something
        })
    }

    fn read(&self) -> Result<(Vec<String>, Vec<Row>), Failure> {
        let label = self.input.display();
        let file = std::fs::File::open(&self.input).map_err(|error| {
            Failure::Usage(format!("{label}: {error}; name a table that exists"))
        })?;
        let (header, rows) =
            read(file).map_err(|error| Failure::Usage(format!("{label}: {error}")))?;
        if rows.is_empty() {
            let known = COLUMN_KEYS.join(", ");
            return Err(Failure::Usage(format!(
                "{label}: no motor below the header; columns are {known}"
            )));
        }
        Ok((header, rows))
    }
}

fn answers(rows: &[Row]) -> Vec<Answer> {
    let bar = progress::bar("motors", rows.len() as u64);
    let answers = rows
        .par_iter()
        .map(|row| {
            bar.inc(1);
            let plate = row
                .plate
                .as_ref()
                .map_err(|problem| format!("line {}: {problem}", row.line))?;
            Estimate::of(plate).map_err(|problem| problem.to_string())
        })
        .collect();
    bar.finish_and_clear();
    answers
}

fn table(input: &[String], rows: &[Row], answers: &[Answer]) -> Result<String, Failure> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let failed =
        |error: csv::Error| Failure::Usage(format!("the table cannot be written: {error}"));
    writer.write_record(header(input)).map_err(failed)?;
    for (row, answer) in rows.iter().zip(answers) {
        writer
            .write_record(record(input, row, answer))
            .map_err(failed)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| Failure::Usage(format!("the table cannot be written: {error}")))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn summary(answers: &[Answer], seconds: f64) -> CatalogueJson {
    let solved: Vec<&Estimate> = answers
        .iter()
        .filter_map(|answer| answer.as_ref().ok())
        .collect();
    let mut errors: Vec<f64> = solved
        .iter()
        .map(|estimate| 100.0 * estimate.worst_error)
        .collect();
    errors.sort_by(f64::total_cmp);
    let within = |limit: f64| errors.iter().filter(|error| **error <= limit).count();
    CatalogueJson {
        motors: answers.len(),
        solved: solved.len(),
        contradictions: solved
            .iter()
            .filter(|e| !e.contradictions.is_empty())
            .count(),
        median_worst_error_percent: errors.get(errors.len() / 2).copied().unwrap_or_default(),
        within_1_percent: within(1.0),
        within_5_percent: within(5.0),
        seconds,
    }
}

fn print(result: &CatalogueJson, out: &Path) {
    let CatalogueJson {
        motors,
        solved,
        seconds,
        ..
    } = result;
    say!(
        "  {solved} of {motors} motors have a circuit, {:.0} a second",
        *motors as f64 / seconds.max(1e-9)
    );
    say!(
        "  worst error: median {:.3} %",
        result.median_worst_error_percent
    );
    say!(
        "  within 1 %: {}   within 5 %: {}",
        result.within_1_percent,
        result.within_5_percent
    );
    say!(
        "  contradictions: {} (column contradiction)",
        result.contradictions
    );
    say!("\n{} is written.", out.display());
}
