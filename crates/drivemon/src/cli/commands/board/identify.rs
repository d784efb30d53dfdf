//! `drivemon board identify`: who answers on the line.

use std::collections::BTreeMap;

use board::modbus::Object;
use clap::Args;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::line::LineArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::JsonArgs;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Tell which board answers: program, source, serial number, motor and calibration.
///
/// Two boards with the same program checksum, motor constants and calibration judge alike.
#[derive(Debug, Args)]
pub struct Identify {
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    json: JsonArgs,
}

/// What the board is, by the names of the objects of function 43/14.
#[derive(Debug, Serialize, JsonSchema)]
pub struct IdentityJson<'a> {
    /// Maker, product, revision, checksums and serial number, each by its name.
    #[serde(flatten)]
    objects: BTreeMap<&'a str, &'a str>,
}

impl Answer for IdentityJson<'_> {
    const FORMAT: &'static str = "board-identify/1";
}

impl Identify {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let told = self.line.open()?.identify()?;
        let named: Vec<(String, String)> = told.into_iter().map(named).collect();
        let objects = named
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_str()))
            .collect();
        let identity = IdentityJson { objects };
        self.json.give(&identity, || print(&named))?;
        Ok(Finding::Nothing)
    }
}

/// An object of other firmware keeps its number.
fn named((number, text): (u8, String)) -> (String, String) {
    let Some(object) = Object::by_number(number) else {
        return (format!("object {number:#04x}"), text);
    };
    let none = match object {
        Object::Revision => text.is_empty().then_some("not built from a repository"),
        Object::Program => (text == "00000000").then_some("not sealed"),
        Object::Calibration => (text == "00000000").then_some("none: values of the motor file"),
        _ => None,
    };
    let value = none.map_or(text, str::to_owned);
    (object.label().to_owned(), value)
}

fn print(named: &[(String, String)]) {
    let widest = named.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in named {
        say!("{}  {value}", paint::strong(format!("{name:widest$}")));
    }
}
