//! `drivemon motor new`: a motor file from a nameplate.

use std::path::PathBuf;

use clap::Args;
use nameplate::contradiction::Contradiction;
use nameplate::physical::KEYS;
use nameplate::{COLUMN_KEYS, Estimate, Interval, motor_text};
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::plate::PlateArgs;
use crate::cli::arguments::files::Files;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{JsonArgs, write_text};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Make a motor file from a nameplate.
///
/// Power, voltage and speed are enough; every further number narrows the intervals. Missing numbers follow from the others
/// or are expected as in 304 motors of published catalogues. Every parameter gets a 95 % interval. Numbers that contradict
/// each other are named, and the file is written all the same.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct New {
    #[command(flatten)]
    plate: PlateArgs,
    /// Motor file to write
    #[arg(short, long = "out", value_name = "MOTOR.toml")]
    out: PathBuf,
    #[command(flatten)]
    json: JsonArgs,
}

const EXAMPLES: &str = "\
Example:
  drivemon motor new --power-kw 5.5 --voltage-volt 400 --frequency-hz 50 --speed-rpm 1455 \\
    --current-amp 10.4 --power-factor 0.85 --efficiency-percent 89.2 -o pump.toml
  drivemon monitor today.csv --motor pump.toml
Exit codes: 0 written, 1 written, but numbers of the plate contradict each other, 2 bad input.";

/// What the numbers of a plate tell of the motor.
#[derive(Debug, Serialize, JsonSchema)]
pub struct NewJson {
    /// The motor file that was written.
    motor_file: String,
    /// Parameters of the circuit with their intervals.
    parameters: Vec<Named>,
    /// Numbers of the plate as the circuit gives them.
    plate: Vec<Named>,
    /// Largest difference between the plate and the circuit, percent.
    worst_error_percent: f64,
    /// Numbers that contradict each other.
    contradictions: Vec<String>,
    /// What would narrow the intervals, the best first.
    would_help: Vec<Help>,
}

impl Answer for NewJson {
    const FORMAT: &'static str = "motor-new/1";
}

/// A quantity with its interval.
#[derive(Debug, Serialize, JsonSchema)]
struct Named {
    /// Its name, with the unit.
    name: &'static str,
    #[serde(flatten)]
    interval: Interval,
    /// The number on the plate; absent where the plate has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    printed: Option<f64>,
}

/// What a number that is missing would narrow.
#[derive(Debug, Serialize, JsonSchema)]
struct Help {
    /// The number.
    missing: &'static str,
    /// The parameter.
    parameter: &'static str,
    /// Ends of its interval over each other, as it is now.
    factor_now: f64,
    /// The same with the number.
    factor_then: f64,
}

impl New {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        Files::default()
            .may_read("the plate", self.plate.file())
            .writes("-o", &self.out)
            .may_write("--json", self.json.file())
            .check()?;
        let file = self.plate.read()?;
        let estimate =
            Estimate::of(&file.plate).map_err(|problem| Failure::Usage(problem.to_string()))?;
        let text = motor_text(&file, &estimate).map_err(Failure::Usage)?;
        write_text(&self.out, &text)?;
        let result = self.result(&estimate);
        self.json.give(&result, || print(&result))?;
        Ok(if estimate.contradictions.is_empty() {
            Finding::Nothing
        } else {
            Finding::Something
        })
    }

    fn result(&self, estimate: &Estimate) -> NewJson {
        let parameter = |(name, interval): (&&'static str, &Interval)| Named {
            name,
            interval: *interval,
            printed: None,
        };
        let printed = estimate.completed.plate.numbers();
        let column = |k: usize| Named {
            name: COLUMN_KEYS[k],
            interval: estimate.columns[k],
            printed: printed[k].map(|printed| printed.value),
        };
        NewJson {
            motor_file: self.out.display().to_string(),
            parameters: KEYS
                .iter()
                .zip(&estimate.parameters)
                .map(parameter)
                .collect(),
            plate: (0..COLUMN_KEYS.len()).map(column).collect(),
            worst_error_percent: 100.0 * estimate.worst_error,
            contradictions: estimate
                .contradictions
                .iter()
                .map(Contradiction::to_string)
                .collect(),
            would_help: would_help(estimate),
        }
    }
}

/// For each missing number the parameter that it would narrow most.
fn would_help(estimate: &Estimate) -> Vec<Help> {
    let plate = estimate.completed.plate;
    let missing = (3..COLUMN_KEYS.len()).filter(|&k| plate.numbers()[k].is_none());
    let mut all: Vec<Help> = missing.filter_map(|k| help(estimate, k)).collect();
    all.sort_by(|a, b| (b.factor_now / b.factor_then).total_cmp(&(a.factor_now / a.factor_then)));
    all
}

/// Narrowings below are not worth a look at the plate.
const WORTH: f64 = 1.02;
/// A number that would be printed has about three digits.
const THREE_DIGITS: f64 = 0.002;

fn help(estimate: &Estimate, k: usize) -> Option<Help> {
    let mut plate = estimate.completed.plate;
    let value = estimate.columns[k].value;
    if let Some(place) = plate.places().into_iter().nth(k) {
        *place = Some(nameplate::plate::Printed {
            value,
            half_step: THREE_DIGITS * value,
        });
    }
    let then = Estimate::of(&plate).ok()?;
    // The first five: stator, rotor, both leakages, magnetizing inductance.
    let factor = |interval: &Interval| interval.high / interval.value;
    let gain = |j: &usize| factor(&estimate.parameters[*j]) / factor(&then.parameters[*j]);
    let most = (0..5).max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    (gain(&most) > WORTH).then(|| Help {
        missing: COLUMN_KEYS[k],
        parameter: KEYS[most],
        factor_now: factor(&estimate.parameters[most]),
        factor_then: factor(&then.parameters[most]),
    })
}

fn print(result: &NewJson) {
    say!(
        "  {:<30} {:>12} {:>26}",
        "parameter",
        "value",
        "95 % interval"
    );
    for named in &result.parameters {
        let Interval { value, low, high } = named.interval;
        say!(
            "  {:<30} {:>12} {:>12} .. {:>10}",
            named.name,
            short(value),
            short(low),
            short(high)
        );
    }
    say!("\n  {:<30} {:>12} {:>12}", "plate", "printed", "circuit");
    for named in &result.plate {
        let printed = named.printed.map_or("-".to_owned(), short);
        say!(
            "  {:<30} {:>12} {:>12}",
            named.name,
            printed,
            short(named.interval.value)
        );
    }
    for contradiction in &result.contradictions {
        say!("\n  {} {contradiction}", paint::caution("contradiction:"));
    }
    for help in &result.would_help {
        say!(
            "  {} would narrow {} from a factor of {:.2} to {:.2}",
            paint::strong(help.missing),
            help.parameter,
            help.factor_now,
            help.factor_then
        );
    }
    say!("\n{} is written.", result.motor_file);
    say!("  drivemon monitor REC --motor {}", result.motor_file);
}

/// Four digits.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.3e}");
    }
    let places = 3 - value.abs().max(1e-9).log10().floor() as i32;
    format!("{value:.*}", usize::try_from(places.max(0)).unwrap_or(0))
}
