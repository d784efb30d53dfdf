//! `drivemon board read`: the whole register map.

use clap::Args;
use serde::Serialize;

use super::line::LineArgs;
use super::registers::Registers;
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

#[derive(Debug, Serialize)]
struct Value {
    name: String,
    value: String,
    unit: &'static str,
}

impl ReadBoard {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let registers = Registers::read(&mut self.line.open()?)?;
        let rows = registers.rows();
        let values: Vec<Value> = rows
            .into_iter()
            .map(|(name, value, unit)| Value { name, value, unit })
            .collect();
        self.json.give(&values, || print(&values))?;
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
