//! `drivemon motor tests`: parameters from the standard tests of a test bench.

mod answer;
mod instruments;
mod print;

use std::path::PathBuf;

use clap::Args;
use nameplate::measured::Tested;
use nameplate::measured::table::{self, Row, TEMPLATE};
use nameplate::plate::PlateFile;
use nameplate::{Estimate, tested_text};

use super::plate::PlateArgs;
use crate::cli::arguments::files::Files;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{JsonArgs, write_text};
use crate::cli::printing::terminal;
pub use answer::TestsJson;
use instruments::InstrumentArgs;

/// Learn a motor's parameters from standard tests: DC resistance, no-load, locked rotor, load, coast-down.
///
/// The steps are those of IEEE 112 and IEC 60034-28, each optional. The plate comes first; a single motor may differ from it by
/// the tolerances of IEC 60034-1. Every test narrows the 95 % intervals, a table shows by how much, and what is still wide is
/// said with the test that would tell it. A test that contradicts the plate or another test is named with its row.
///
/// One table, CSV or xlsx, holds all tests, a row for each point (--template prints one to fill in):
///   dc-resistance  resistance_ohm between two terminals, temperature_degc of the winding; one row for each pair
///   no-load        voltage_volt between lines, current_amp, power_watt; uncoupled. One voltage tells the magnetizing inductance,
///                  six from 110 to 25 % also its saturation, and core loss apart from friction
///   locked-rotor   the same at about rated current; a second row at a quarter of the rated frequency tells the rotor resistance
///                  in running from that at standstill
///   load           the same with speed_rpm, and torque_nm or shaft_power_kw where measured: they tell stray-load loss
///   coast-down     speed_rpm over time_s after switching off at no load; with the friction of the no-load rows it tells the inertia
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, verbatim_doc_comment)]
pub struct Tests {
    #[command(flatten)]
    plate: PlateArgs,
    /// Motor file whose [nameplate] is the plate; its parameters are not used
    #[arg(long, value_name = "MOTOR.toml", conflicts_with = "plate")]
    motor: Option<PathBuf>,
    /// Tables of tests, CSV or xlsx; may be given several times
    #[arg(long = "tests", value_name = "TABLE", required_unless_present = "template", num_args = 1..)]
    tables: Vec<PathBuf>,
    /// Motor file to write
    #[arg(
        short,
        long = "out",
        value_name = "OUT.toml",
        required_unless_present = "template"
    )]
    out: Option<PathBuf>,
    /// Print a table to fill in, and nothing else
    #[arg(long, exclusive = true)]
    template: bool,
    #[command(flatten)]
    instruments: InstrumentArgs,
    #[command(flatten)]
    json: JsonArgs,
}

const EXAMPLES: &str = "\
Example:
  drivemon motor tests --template > tests.csv
  drivemon motor tests --plate pump-plate.toml --tests tests.csv -o pump.toml
Exit codes: 0 written, 1 written, but a test contradicts the plate or another test, 2 bad input.";

impl Tests {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let Some(out) = self.out.as_ref().filter(|_| !self.template) else {
            terminal::bytes(TEMPLATE.as_bytes());
            return Ok(Finding::Nothing);
        };
        let mut files = Files::default()
            .may_read("the plate", self.plate.file())
            .may_read("the motor file", self.motor.as_ref())
            .writes("-o", out)
            .may_write("--json", self.json.file());
        for table in &self.tables {
            files = files.reads("the table", table);
        }
        files.check()?;
        let file = self.plate()?;
        let rows = self.rows()?;
        let estimate =
            Estimate::of(&file.plate).map_err(|problem| Failure::Usage(problem.to_string()))?;
        let instruments = self.instruments.read()?;
        let tested = Tested::of(&estimate, &rows, &instruments, file.inertia_kg_m2)
            .map_err(Failure::Usage)?;
        write_text(out, &tested_text(&file, &tested).map_err(Failure::Usage)?)?;
        let result = TestsJson::of(out, &estimate, &tested, &rows);
        self.json.give(&result, || print::print(&result))?;
        Ok(match result.contradictions.is_empty() {
            true => Finding::Nothing,
            false => Finding::Something,
        })
    }

    fn plate(&self) -> Result<PlateFile, Failure> {
        match &self.motor {
            Some(path) => {
                let motor = motor::MotorFile::read(path)?;
                self.plate.over(of_motor(&motor).map_err(Failure::Usage)?)
            }
            None => self.plate.read(),
        }
    }

    fn rows(&self) -> Result<Vec<Row>, Failure> {
        let mut rows = Vec::new();
        for path in &self.tables {
            let label = path.display().to_string();
            let text = match formats::workbook_text(path)? {
                Some(text) => text,
                None => document::read_text(path)?,
            };
            rows.extend(table::read_csv(&text, &label).map_err(Failure::Usage)?);
        }
        Ok(rows)
    }
}

/// The nameplate of a motor file as a plate.
fn of_motor(motor: &motor::MotorFile) -> Result<PlateFile, String> {
    let plate = &motor.nameplate;
    let mut file = PlateFile {
        name: Some(motor.name.clone()),
        delta: plate.connection == motor::motor_file::Connection::Delta,
        ..PlateFile::default()
    };
    let mut set = |key: &str, value: f64| {
        let told = file.set(key, &value.to_string());
        told.map_err(|problem| format!("{key}: {problem}"))
    };
    set("power_kw", plate.power_watt / 1000.0)?;
    set("voltage_volt", plate.voltage_line_rms_volt)?;
    set("frequency_hz", plate.frequency_hz)?;
    set("current_amp", plate.current_rms_amp)?;
    if let Some(speed) = plate.speed_rpm {
        set("speed_rpm", speed)?;
    }
    Ok(file)
}
