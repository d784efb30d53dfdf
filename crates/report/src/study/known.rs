//! What is known of a motor before its recordings are looked at, and how well each parameter is known.

use discovery::IdentifyReport;
use motor::MotorFile;
use motor::motor_file::ParameterInterval;
use nameplate::plate::PlateFile;
use nameplate::{COLUMN_KEYS, Estimate, motor_text};
use schemars::JsonSchema;
use serde::Serialize;

/// A motor by its plate or its file.
#[derive(Clone, Debug)]
pub struct Known {
    /// The motor.
    pub motor: MotorFile,
    /// The motor file's text.
    pub text: String,
    /// Numbers of the plate; empty where a motor file was given.
    pub plate: Vec<PlateRow>,
    /// Numbers of the plate that exclude each other, in words.
    pub contradictions: Vec<String>,
}

/// One number of a plate.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlateRow {
    /// Its key.
    pub name: &'static str,
    /// As printed; absent where the plate does not say it.
    pub printed: Option<f64>,
    /// As the circuit gives it.
    pub circuit: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// One parameter of the motor as it is known in the end.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ParameterRow {
    /// Key in the motor file; it ends with its unit.
    pub name: String,
    /// Value, in the unit of its key.
    pub value: f64,
    /// Lower end of the 95 % interval, where one is known.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// What to record to learn it, where the recordings did not tell it.
    pub would_tell: Option<String>,
}

impl Known {
    /// By a motor file.
    pub fn of_file(motor: MotorFile, text: String) -> Known {
        Known {
            motor,
            text,
            plate: Vec::new(),
            contradictions: Vec::new(),
        }
    }

    /// By its plate.
    ///
    /// # Errors
    /// Numbers missing or outside what motors have, in words.
    pub fn of_plate(file: &PlateFile) -> Result<Known, String> {
        let estimate = Estimate::of(&file.plate).map_err(|problem| problem.to_string())?;
        let text = motor_text(file, &estimate)?;
        let motor = MotorFile::parse(&text, "the plate").map_err(|error| error.to_string())?;
        let contradictions = estimate.contradictions.iter().map(ToString::to_string);
        Ok(Known {
            motor,
            text,
            contradictions: contradictions.collect(),
            plate: plate_rows(&estimate),
        })
    }
}

impl Known {
    /// Every parameter with its interval, where the motor file has intervals.
    pub fn parameters(&self) -> Vec<ParameterRow> {
        parameters(&self.motor, None)
    }
}

fn plate_rows(estimate: &Estimate) -> Vec<PlateRow> {
    let printed = estimate.completed.plate.numbers();
    let row = |k: usize| PlateRow {
        name: COLUMN_KEYS[k],
        printed: printed[k].map(|printed| printed.value),
        circuit: estimate.columns[k].value,
        low: estimate.columns[k].low,
        high: estimate.columns[k].high,
    };
    (0..COLUMN_KEYS.len()).map(row).collect()
}

/// Every parameter with its interval: as recordings told it, or as the motor file has it.
pub(super) fn parameters(
    motor: &MotorFile,
    identified: Option<&IdentifyReport>,
) -> Vec<ParameterRow> {
    let told = identified.map_or(&[][..], |report| &report.parameters);
    let mut rows: Vec<ParameterRow> = told
        .iter()
        .map(|p| ParameterRow {
            name: p.name.clone(),
            value: p.value,
            low: Some(p.low),
            high: Some(p.high),
            would_tell: p.would_tell.clone(),
        })
        .collect();
    if rows.is_empty() {
        let intervals = motor.uncertainty.iter().flat_map(|u| &u.intervals);
        rows.extend(intervals.filter_map(|interval| with_interval(motor, interval)));
    }
    if rows.is_empty() {
        rows.extend(NOMINALS.iter().filter_map(|key| plain(motor, key)));
    }
    rows
}

const NOMINALS: [&str; 5] = [
    "stator_resistance_ohm",
    "rotor_resistance_ohm",
    "stator_leakage_henry",
    "rotor_leakage_henry",
    "magnetizing_inductance_henry",
];

fn plain(motor: &MotorFile, key: &str) -> Option<ParameterRow> {
    Some(ParameterRow {
        name: key.to_owned(),
        value: value(motor, key)?,
        low: None,
        high: None,
        would_tell: None,
    })
}

/// The lower end that a motor file writes for what may be nothing: it takes no 0.
const NOTHING: f64 = 1e-12;

fn with_interval(motor: &MotorFile, interval: &ParameterInterval) -> Option<ParameterRow> {
    Some(ParameterRow {
        low: Some(if interval.low <= NOTHING {
            0.0
        } else {
            interval.low
        }),
        high: Some(interval.high),
        ..plain(motor, &interval.key)?
    })
}

/// A parameter of the motor by its key.
fn value(motor: &MotorFile, key: &str) -> Option<f64> {
    let p = &motor.parameters;
    let nominal = match key {
        "stator_resistance_ohm" => p.r_s,
        "rotor_resistance_ohm" => p.r_r,
        "stator_leakage_henry" => p.l_ls,
        "rotor_leakage_henry" => p.l_lr,
        "magnetizing_inductance_henry" => p.l_m,
        "inertia_kg_m2" => motor.mechanics.inertia,
        "friction_nm_s" => motor.mechanics.friction,
        _ => return motor.effects.iter().find_map(|effect| effect.number(key)),
    };
    Some(nominal)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLATE: &str = "power_kw = 2.2\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1438\ncurrent_amp = 4.78\n";

    #[test]
    fn a_plate_alone_gives_every_parameter_an_interval() {
        let file = PlateFile::parse(PLATE, "plate").expect("numbers");
        let known = Known::of_plate(&file).expect("a motor");
        assert!(known.contradictions.is_empty() && known.plate.len() == COLUMN_KEYS.len());
        let rows = parameters(&known.motor, None);
        assert!(rows.len() >= 6);
        for row in rows {
            assert!(row.low.is_some_and(|low| low <= row.value), "{row:?}");
            assert!(row.high.is_some_and(|high| high >= row.value), "{row:?}");
        }
    }

    #[test]
    fn a_file_without_intervals_gives_none() {
        let text = include_str!("../../../../motors/assumed-300w.toml");
        let motor = MotorFile::parse(text, "motor").expect("it ships");
        let rows = parameters(&motor, None);
        assert_eq!(rows.len(), NOMINALS.len());
        assert!(rows.iter().all(|row| row.low.is_none() && row.value > 0.0));
    }

    #[test]
    fn a_plate_that_says_too_little_is_refused_in_words() {
        let file = PlateFile::parse("power_kw = 2.2\n", "plate").expect("a number");
        let told = Known::of_plate(&file).expect_err("nothing but a power");
        assert!(told.contains("is missing"), "{told}");
    }
}
