//! `drivemon schema`: the keys of every command's JSON.

use clap::Args;
use report::json::{self, Format};
use serde_json::Value;

#[cfg(feature = "gateway")]
use crate::cli::commands::gateway;
use crate::cli::commands::{board, calibrate, live, motor, simulated};
use crate::cli::printing::answers::Refused;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

/// Print the JSON Schema of a command's --json: every key with its type, its unit and what it means.
///
/// Each JSON names its format in the key `format`, as `monitor/1`. The number rises where a key goes or changes its
/// meaning; a new key leaves it as it is, so read the keys that you know and ignore the others. Of several recordings
/// the JSON is a list of these objects.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  drivemon schema                              the formats
  drivemon schema monitor                      the schema of `drivemon monitor --json`
  drivemon schema monitor > monitor.schema.json && check-jsonschema --schemafile monitor.schema.json answer.json
docs/json.md lists the keys of all formats.
Exit codes: 0 printed, 2 no such format.")]
pub struct SchemaArgs {
    /// The format; without it all are listed
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

impl SchemaArgs {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let formats = formats();
        let Some(name) = &self.name else {
            list(&formats);
            return Ok(Finding::Nothing);
        };
        let found = formats.iter().find(|format| {
            let (bare, _) = format.name.split_once('/').unwrap_or((format.name, ""));
            format.name == name || bare == name
        });
        let format = found.ok_or_else(|| unknown(name, &formats))?;
        let text = serde_json::to_string_pretty(&format.schema)
            .map_err(|error| Failure::Usage(format!("{}: {error}", format.name)))?;
        say!("{text}");
        Ok(Finding::Nothing)
    }
}

/// The formats of all commands.
pub fn formats() -> Vec<Format> {
    let mut all = json::formats();
    all.extend(calibrate::formats());
    all.extend(motor::formats());
    all.extend(simulated::formats());
    all.push(Format::of::<live::Watched>());
    #[cfg(feature = "gateway")]
    all.push(Format::of::<gateway::Counted>());
    all.extend(board::formats());
    all.push(Format::of::<Refused>());
    all
}

fn list(formats: &[Format]) {
    let widest = formats.iter().map(|format| format.name.len()).max();
    let width = widest.unwrap_or(0);
    for format in formats {
        let about = format.schema.get("description").and_then(Value::as_str);
        let about = about.unwrap_or_default().lines().next().unwrap_or_default();
        say!(
            "{}  {about}",
            paint::strong(format!("{:width$}", format.name))
        );
    }
}

fn unknown(name: &str, formats: &[Format]) -> Failure {
    let names: Vec<&str> = formats.iter().map(|format| format.name).collect();
    Failure::Usage(format!(
        "no JSON has the format `{name}`; there are {}",
        names.join(", ")
    ))
}
