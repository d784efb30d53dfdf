//! The flags of a command line that say how a file is to be read, as they are typed.

use super::Mapping;
use crate::error::Error;
use std::path::PathBuf;

/// What a user says about how a file is to be read: the flags of the commands, or the arguments of the same names elsewhere.
/// Empty means: not said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flags {
    /// `CHANNEL=COLUMN`: a channel is read from another column.
    pub column: Vec<String>,
    /// `CHANNEL,...`: the columns in their order, `-` for one that is not used.
    pub columns: Option<String>,
    /// `CHANNEL=SCALE`: the sensor behind a column, `100mV/A`.
    pub sensor: Vec<String>,
    /// `CHANNEL=UNIT`.
    pub unit: Vec<String>,
    /// `CHANNEL=FACTOR`, applied after the offset.
    pub scale: Vec<String>,
    /// `CHANNEL=VALUE`: the raw reading at zero.
    pub offset: Vec<String>,
    /// `CHANNEL=TIME`: how much later than its row a channel was sampled, `11.55us`.
    pub delay: Vec<String>,
    /// Sampling rate of a file without a clock, Hz.
    pub sample_rate: Option<f64>,
    /// Whether va vb vc hold the line voltages v_ab v_bc v_ca.
    pub line_voltages: bool,
    /// Whether rows without a number are left out.
    pub skip_missing: bool,
    /// What separates the columns.
    pub delimiter: Option<String>,
    /// Whether numbers are written 3,7.
    pub decimal_comma: bool,
    /// What stands between thousands.
    pub thousands: Option<String>,
    /// `dmy` or `mdy`.
    pub date_order: Option<String>,
    /// Pulses of the encoder in one turn.
    pub pulses_per_revolution: Option<u32>,
    /// The sidecar to use instead of the one beside the recording.
    pub sidecar: Option<PathBuf>,
}

impl Flags {
    /// What they say.
    ///
    /// # Errors
    /// The first flag that cannot be understood, with the remedy.
    pub fn mapping(&self) -> Result<Mapping, Error> {
        let mut mapping = Mapping {
            line_voltages: self.line_voltages.then_some(true),
            skip_missing: self.skip_missing.then_some(true),
            decimal_comma: self.decimal_comma.then_some(true),
            sidecar: self.sidecar.clone(),
            ..Mapping::default()
        };
        type Set = fn(&mut Mapping, &str) -> Result<(), Error>;
        // A unit is one of what the sensor gives out.
        let lists: [(&[String], Set); 6] = [
            (&self.column, Mapping::set_column),
            (&self.sensor, Mapping::set_sensor),
            (&self.unit, Mapping::set_unit),
            (&self.scale, Mapping::set_scale),
            (&self.offset, Mapping::set_offset),
            (&self.delay, Mapping::set_delay),
        ];
        for (flags, set) in lists {
            flags.iter().try_for_each(|flag| set(&mut mapping, flag))?;
        }
        if let Some(rate) = self.sample_rate {
            mapping.set_sample_rate(rate)?;
        }
        if let Some(pulses) = self.pulses_per_revolution {
            mapping.set_pulses(pulses)?;
        }
        let texts: [(&Option<String>, Set); 4] = [
            (&self.delimiter, Mapping::set_delimiter),
            (&self.columns, Mapping::set_columns),
            (&self.thousands, Mapping::set_thousands),
            (&self.date_order, Mapping::set_date_order),
        ];
        for (text, set) in texts {
            text.iter().try_for_each(|text| set(&mut mapping, text))?;
        }
        Ok(mapping)
    }

    /// The flags as they are typed, each with a blank before it: a command that reads the same file needs them too.
    pub fn typed(&self) -> String {
        let words = self.words();
        words
            .iter()
            .map(|word| format!(" {}", quoted(word)))
            .collect()
    }

    /// The flags as words of a command line.
    pub fn words(&self) -> Vec<String> {
        let mut words = Vec::new();
        let mut add = |flag: &str, value: &str| {
            let both = [flag, value].into_iter().filter(|word| !word.is_empty());
            words.extend(both.map(str::to_owned));
        };
        let lists = [
            ("--column", &self.column),
            ("--sensor", &self.sensor),
            ("--unit", &self.unit),
            ("--scale", &self.scale),
            ("--offset", &self.offset),
            ("--delay", &self.delay),
        ];
        for (flag, values) in lists {
            values.iter().for_each(|value| add(flag, value));
        }
        let text = |x: &PathBuf| x.display().to_string();
        let values = [
            ("--sample-rate", self.sample_rate.map(|x| x.to_string())),
            ("--columns", self.columns.clone()),
            ("--delimiter", self.delimiter.clone()),
            ("--thousands", self.thousands.clone()),
            ("--date-order", self.date_order.clone()),
            (
                "--pulses-per-revolution",
                self.pulses_per_revolution.map(|x| x.to_string()),
            ),
            ("--sidecar", self.sidecar.as_ref().map(text)),
        ];
        for (flag, value) in values {
            value.iter().for_each(|value| add(flag, value));
        }
        let switches = [
            ("--line-voltages", self.line_voltages),
            ("--skip-missing", self.skip_missing),
            ("--decimal-comma", self.decimal_comma),
        ];
        for (flag, _) in switches.into_iter().filter(|(_, on)| *on) {
            add(flag, "");
        }
        words
    }
}

/// A word of a command line, in quotes where a shell needs them.
pub fn quoted(name: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+=:,@\\".contains(c);
    if name.chars().all(plain) {
        name.to_owned()
    } else {
        format!("\"{name}\"")
    }
}
