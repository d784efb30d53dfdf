//! `drivemon board read`: the whole register map.

use clap::Args;
use live::Registers;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::line::LineArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Read every value that the board shows, with its unit.
#[derive(Debug, Args)]
pub struct ReadBoard {
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    json: JsonArgs,
}

/// Every value that the board shows.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ReadJson {
    /// In the order of the register map.
    values: Vec<Value>,
}

impl Answer for ReadJson {
    const FORMAT: &'static str = "board-read/1";
}

/// A value as the board shows it.
#[derive(Debug, Serialize, JsonSchema)]
struct Value {
    /// What it is.
    name: String,
    /// In words or digits.
    value: String,
    /// Its unit; empty where it has no unit.
    unit: &'static str,
}

impl ReadBoard {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let registers = Registers::read(&mut self.line.open()?)?;
        let rows = registers.rows();
        let values = rows
            .into_iter()
            .map(|(name, value, unit)| Value { name, value, unit })
            .collect();
        let read = ReadJson { values };
        self.json.give(&read, || print(&read.values))?;
        let fault = registers.word(board::modbus::Field::Verdict) == 2;
        Ok(match fault || registers.doubts().is_any() {
            true => Finding::Something,
            false => Finding::Nothing,
        })
    }
}

fn print(values: &[Value]) {
    let widest = values.iter().map(|value| value.name.len()).max();
    for value in values {
        let unit = if value.unit.is_empty() {
            String::new()
        } else {
            format!(" {}", value.unit)
        };
        let name = format!("{:width$}", value.name, width = widest.unwrap_or(0));
        say!("{}  {}{unit}", paint::strong(name), value.value);
    }
}
