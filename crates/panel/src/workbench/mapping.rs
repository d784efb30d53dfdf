//! How columns become channels, as the page says it: the flags of the command line.

use std::collections::BTreeMap;

use recording::{Error, Mapping};
use serde::{Deserialize, Serialize};

/// What the page's form holds; empty texts mean: not said.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Columns {
    /// By channel: the column that it is read from, as `--column`.
    pub column: BTreeMap<String, String>,
    /// By channel: the unit of the column, as `--unit`.
    pub unit: BTreeMap<String, String>,
    /// By channel: a factor, as `--scale`.
    pub scale: BTreeMap<String, String>,
    /// By channel: the reading at zero, as `--offset`.
    pub offset: BTreeMap<String, String>,
    /// By channel: how much later than its row it was sampled, with a unit of time, as `--delay`.
    pub delay: BTreeMap<String, String>,
    /// As `--sample-rate`, Hz.
    pub sample_rate_hz: Option<f64>,
    /// As `--delimiter`.
    pub delimiter: String,
    /// As `--decimal-comma`.
    pub decimal_comma: bool,
    /// As `--line-voltages`.
    pub line_voltages: bool,
    /// As `--skip-missing`.
    pub skip_missing: bool,
    /// As `--pulses-per-revolution`.
    pub pulses_per_revolution: Option<u32>,
}

type Set = fn(&mut Mapping, &str) -> Result<(), Error>;

impl Columns {
    /// The mapping that the flags would give.
    ///
    /// # Errors
    /// What the flags would be refused with.
    pub fn mapping(&self) -> Result<Mapping, Error> {
        let mut mapping = Mapping {
            line_voltages: self.line_voltages.then_some(true),
            skip_missing: self.skip_missing.then_some(true),
            decimal_comma: self.decimal_comma.then_some(true),
            encoder_pulses_per_revolution: self.pulses_per_revolution,
            ..Mapping::default()
        };
        let settings: [(&BTreeMap<String, String>, Set); 5] = [
            (&self.column, Mapping::set_column),
            (&self.unit, Mapping::set_unit),
            (&self.scale, Mapping::set_scale),
            (&self.offset, Mapping::set_offset),
            (&self.delay, Mapping::set_delay),
        ];
        for (by_channel, set) in settings {
            for (channel, value) in by_channel.iter().filter(|(_, value)| !value.is_empty()) {
                set(&mut mapping, &format!("{channel}={value}"))?;
            }
        }
        if let Some(rate) = self.sample_rate_hz {
            mapping.set_sample_rate(rate)?;
        }
        if !self.delimiter.is_empty() {
            mapping.set_delimiter(&self.delimiter)?;
        }
        Ok(mapping)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_form_says_what_the_flags_say() {
        let text = r#"{"column": {"ia": "I1", "ib": ""}, "unit": {"ia": "mA"}, "scale": {"ia": "2"}, "offset": {"ia": "-0.5"}, "delay": {"ib": "11.55us"},
            "sample_rate_hz": 5000, "delimiter": ";", "decimal_comma": true}"#;
        let columns: Columns = serde_json::from_str(text).expect("JSON");
        let mut expected = Mapping {
            decimal_comma: Some(true),
            ..Mapping::default()
        };
        expected.set_column("ia=I1").expect("sound");
        expected.set_unit("ia=mA").expect("sound");
        expected.set_scale("ia=2").expect("sound");
        expected.set_offset("ia=-0.5").expect("sound");
        expected.set_delay("ib=11.55us").expect("sound");
        expected.set_sample_rate(5000.0).expect("sound");
        expected.set_delimiter(";").expect("sound");
        assert_eq!(columns.mapping(), Ok(expected));
        assert_eq!(Columns::default().mapping(), Ok(Mapping::default()));
    }

    #[test]
    fn the_factor_of_the_speed_may_be_unknown() {
        let columns: Columns =
            serde_json::from_str(r#"{"scale": {"speed": "unknown"}}"#).expect("JSON");
        let mut expected = Mapping::default();
        expected.set_scale("speed=unknown").expect("sound");
        assert_eq!(columns.mapping(), Ok(expected));
    }

    #[test]
    fn what_the_flags_refuse_is_refused() {
        for text in [
            r#"{"column": {"x": "I1"}}"#,
            r#"{"unit": {"ia": "parsec"}}"#,
            r#"{"scale": {"ia": "much"}}"#,
            r#"{"delay": {"ia": "11.55"}}"#,
            r#"{"sample_rate_hz": -1}"#,
            r#"{"delimiter": "x"}"#,
        ] {
            let columns: Columns = serde_json::from_str(text).expect("JSON");
            assert!(columns.mapping().is_err(), "{text}");
        }
    }
}
