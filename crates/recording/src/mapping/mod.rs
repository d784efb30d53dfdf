//! How the columns of a file become channels: names, units, scales, as flags or sidecar say.

pub(crate) mod sidecar;

use crate::data::channel::{Channel, Quantity};
use crate::data::units::Unit;
use crate::error::Error;
use crate::suggest::closest;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// What a column may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// The clock, `t`.
    Time,
    /// A channel.
    Channel(Channel),
}

impl Target {
    /// The target that a file or a flag calls `name`.
    pub fn parse(name: &str) -> Option<Target> {
        match name {
            "t" => Some(Target::Time),
            _ => Channel::parse(name).map(Target::Channel),
        }
    }

    /// What it measures.
    pub fn quantity(self) -> Quantity {
        match self {
            Target::Time => Quantity::Time,
            Target::Channel(channel) => channel.quantity(),
        }
    }

    /// Every target, the clock first.
    pub fn all() -> impl Iterator<Item = Target> {
        std::iter::once(Target::Time).chain(Channel::all().map(Target::Channel))
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Target::Time => f.write_str("t"),
            Target::Channel(channel) => channel.fmt(f),
        }
    }
}

/// The factor of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    /// Finite and not 0.
    Known(f64),
    /// Declared to be unknown: the channel is right up to a factor.
    Unknown,
}

/// How one column becomes a channel: `SI = unit(scale (raw - offset))`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// Name of the column in the file; the target's own name when absent.
    pub name: Option<String>,
    /// Unit of `scale (raw - offset)`; SI when absent.
    pub unit: Option<Unit>,
    /// Factor; 1 when absent.
    pub scale: Option<Factor>,
    /// Raw reading at zero, in the column's own unit; 0 when absent.
    pub offset: Option<f64>,
    /// How much later than the row's time the channel was sampled, s; negative where a filter lets it show what was before.
    pub delay: Option<f64>,
    /// Who said so.
    pub origin: Origin,
}

/// Who said how a column is to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// The user, for this run: an assumption that every result depends on.
    #[default]
    User,
    /// The sidecar, a part of the recording.
    Sidecar,
    /// The file itself.
    File,
}

impl ColumnMap {
    /// The SI value of a raw reading.
    pub fn to_si(&self, quantity: Quantity, raw: f64) -> f64 {
        let unit = self.unit.unwrap_or_else(|| Unit::si(quantity));
        let factor = match self.scale {
            Some(Factor::Known(factor)) => factor,
            Some(Factor::Unknown) | None => 1.0,
        };
        unit.to_si(factor * (raw - self.offset.unwrap_or(0.0)))
    }

    /// The conversion in words: `speed = 1.0144 x (speed_raw + 2.11) rad/s`.
    pub(crate) fn sentence(&self, target: Target, column: &str) -> Option<String> {
        if *self
            == (ColumnMap {
                origin: self.origin,
                ..ColumnMap::default()
            })
        {
            return None;
        }
        let who = match self.origin {
            Origin::User => "user's assumption",
            Origin::Sidecar => "as the sidecar declares",
            Origin::File => "as the file declares",
        };
        let unit = self.unit.unwrap_or_else(|| Unit::si(target.quantity()));
        let shifted = match self.offset {
            Some(offset) if offset < 0.0 => format!("({column} + {})", -offset),
            Some(offset) if offset > 0.0 => format!("({column} - {offset})"),
            _ => column.to_owned(),
        };
        let scaled = match self.scale {
            Some(Factor::Known(scale)) => format!("{scale} x {shifted}"),
            Some(Factor::Unknown) => format!("an unknown factor x {shifted}"),
            None => shifted,
        };
        let late = self.delay.map_or(String::new(), |delay| {
            format!(", sampled {} us after the row's time", in_micro(delay))
        });
        Some(format!("{target} = {scaled} in {}{late}, {who}", unit.name))
    }

    fn over(self, below: ColumnMap) -> ColumnMap {
        ColumnMap {
            name: self.name.or(below.name),
            unit: self.unit.or(below.unit),
            scale: self.scale.or(below.scale),
            offset: self.offset.or(below.offset),
            delay: self.delay.or(below.delay),
            origin: self.origin,
        }
    }
}

/// Everything that a user may say about how a file is to be read. `None` means: not said.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mapping {
    /// Per target; a target that is not mapped is read from the column of its own name, in SI.
    pub columns: BTreeMap<Target, ColumnMap>,
    /// Whether `va vb vc` hold the line voltages v_ab, v_bc, v_ca.
    pub line_voltages: Option<bool>,
    /// Sampling rate, Hz, of a file without a usable `t`; a `t` column is then ignored.
    pub sample_rate_hz: Option<f64>,
    /// Whether rows with empty or NaN cells are dropped (a gap in time) instead of refused.
    pub skip_missing: Option<bool>,
    /// What separates the columns; a comma when absent.
    pub delimiter: Option<u8>,
    /// Whether numbers are written `3,7`.
    pub decimal_comma: Option<bool>,
    /// Pulses per turn of the encoder behind a column of counts.
    pub encoder_pulses_per_revolution: Option<u32>,
    /// The sidecar to read instead of the one beside the recording.
    pub sidecar: Option<PathBuf>,
}

/// Rates between one sample in ten seconds and 100 MHz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.1..=1e8;

impl Mapping {
    /// `--column TARGET=NAME`: the target is read from the column `NAME`.
    ///
    /// # Errors
    /// Text that is not `TARGET=NAME`, or an unknown target.
    pub fn set_column(&mut self, flag: &str) -> Result<(), Error> {
        let (target, name) = split("--column", flag)?;
        self.entry(target).name = Some(name.to_owned());
        Ok(())
    }

    /// `--unit TARGET=UNIT`.
    ///
    /// # Errors
    /// Text that is not `TARGET=UNIT`, an unknown target, or a unit of another quantity.
    pub fn set_unit(&mut self, flag: &str) -> Result<(), Error> {
        let (target, name) = split("--unit", flag)?;
        let unit = Unit::parse(target.quantity(), name).map_err(|known| {
            let message = format!("`{name}` is not a unit of {target}");
            Error::at(
                COMMAND_LINE,
                0,
                "--unit",
                message,
                format!("use one of {known}"),
            )
        })?;
        self.entry(target).unit = Some(unit);
        Ok(())
    }

    /// `--scale TARGET=FACTOR`; the factor of the speed may be `unknown`.
    ///
    /// # Errors
    /// Text that is not `TARGET=FACTOR`, an unknown target, a factor that is 0 or not finite, or an unknown factor
    /// of another channel than the speed.
    pub fn set_scale(&mut self, flag: &str) -> Result<(), Error> {
        let (target, text) = split("--scale", flag)?;
        if text == UNKNOWN {
            if let Some(message) = refused_unknown(target) {
                let remedy = "give a factor; only that of the speed can be fitted";
                return Err(Error::at(COMMAND_LINE, 0, "--scale", message, remedy));
            }
            self.entry(target).scale = Some(Factor::Unknown);
            return Ok(());
        }
        let scale = number("--scale", text)?;
        if scale == 0.0 {
            let remedy = "give a factor other than 0";
            return Err(Error::at(
                COMMAND_LINE,
                0,
                "--scale",
                "the factor is 0",
                remedy,
            ));
        }
        self.entry(target).scale = Some(Factor::Known(scale));
        Ok(())
    }

    /// `--offset TARGET=RAW`: the raw reading at zero.
    ///
    /// # Errors
    /// Text that is not `TARGET=RAW`, an unknown target, or a number that is not finite.
    pub fn set_offset(&mut self, flag: &str) -> Result<(), Error> {
        let (target, text) = split("--offset", flag)?;
        self.entry(target).offset = Some(number("--offset", text)?);
        Ok(())
    }

    /// `--delay TARGET=TIME`, the time with its unit, s, ms or us: how much later than its row the channel was sampled.
    ///
    /// # Errors
    /// Text that is not `TARGET=TIME`, an unknown target, the clock itself, or more than 0.1 s.
    pub fn set_delay(&mut self, flag: &str) -> Result<(), Error> {
        let (target, text) = split("--delay", flag)?;
        if target == Target::Time {
            let message = "the clock cannot be late against itself";
            let remedy = "name the channels that were sampled at other instants";
            return Err(Error::at(COMMAND_LINE, 0, "--delay", message, remedy));
        }
        self.entry(target).delay = Some(delay(text)?);
        Ok(())
    }

    /// `--sample-rate HZ`.
    ///
    /// # Errors
    /// A rate outside 0.1 Hz to 100 MHz.
    pub fn set_sample_rate(&mut self, rate_hz: f64) -> Result<(), Error> {
        if !RATES_HZ.contains(&rate_hz) {
            let message = format!("{rate_hz} Hz is not a sampling rate");
            let remedy = "give samples per second, 0.1 to 1e8";
            return Err(Error::at(COMMAND_LINE, 0, "--sample-rate", message, remedy));
        }
        self.sample_rate_hz = Some(rate_hz);
        Ok(())
    }

    /// `--pulses-per-revolution N`.
    ///
    /// # Errors
    /// No pulse, or more than any encoder has.
    pub fn set_pulses(&mut self, pulses: u32) -> Result<(), Error> {
        if !(1..=1_000_000).contains(&pulses) {
            let message = format!("an encoder does not have {pulses} pulses in one turn");
            let remedy = "give the number on its plate, 1 to 1000000";
            let flag = "--pulses-per-revolution";
            return Err(Error::at(COMMAND_LINE, 0, flag, message, remedy));
        }
        self.encoder_pulses_per_revolution = Some(pulses);
        Ok(())
    }

    /// `--delimiter C`: one ASCII character, or `tab`.
    ///
    /// # Errors
    /// Anything else.
    pub fn set_delimiter(&mut self, text: &str) -> Result<(), Error> {
        self.delimiter = Some(delimiter(text).ok_or_else(|| {
            let message = format!("`{text}` does not separate columns");
            Error::at(COMMAND_LINE, 0, "--delimiter", message, DELIMITERS)
        })?);
        Ok(())
    }

    /// The mapping of a target, made when absent.
    pub fn entry(&mut self, target: Target) -> &mut ColumnMap {
        self.columns.entry(target).or_default()
    }

    /// This mapping where it says something, the other one elsewhere: flags over a sidecar.
    pub fn over(self, below: Mapping) -> Mapping {
        let mut columns = below.columns;
        for (target, map) in self.columns {
            let merged = map.over(columns.remove(&target).unwrap_or_default());
            columns.insert(target, merged);
        }
        Mapping {
            columns,
            line_voltages: self.line_voltages.or(below.line_voltages),
            sample_rate_hz: self.sample_rate_hz.or(below.sample_rate_hz),
            skip_missing: self.skip_missing.or(below.skip_missing),
            delimiter: self.delimiter.or(below.delimiter),
            decimal_comma: self.decimal_comma.or(below.decimal_comma),
            encoder_pulses_per_revolution: self
                .encoder_pulses_per_revolution
                .or(below.encoder_pulses_per_revolution),
            sidecar: self.sidecar.or(below.sidecar),
        }
    }
}

pub(crate) const COMMAND_LINE: &str = "command line";
/// The word for an unknown factor.
pub(crate) const UNKNOWN: &str = "unknown";

/// Why the factor of a target cannot be left open; `None` for the speed.
pub(crate) fn refused_unknown(target: Target) -> Option<String> {
    (target != Target::Channel(Channel::SPEED))
        .then(|| format!("the factor of {target} cannot be unknown"))
}

pub(crate) const DELIMITERS: &str = "use one of `,` `;` `|` `tab`";

/// The byte that a flag or sidecar calls a delimiter.
pub(crate) fn delimiter(text: &str) -> Option<u8> {
    match text {
        "," => Some(b','),
        ";" => Some(b';'),
        "|" => Some(b'|'),
        "tab" | "\t" => Some(b'\t'),
        _ => None,
    }
}

/// Largest delay either way, s: more is another recording.
pub(crate) const LARGEST_DELAY_S: f64 = 0.1;

/// Units of a delay, the longest ending first.
const DELAY_UNITS: [(&str, f64); 3] = [("us", 1e-6), ("ms", 1e-3), ("s", 1.0)];

/// A time such as `11.55us`, in s.
fn delay(text: &str) -> Result<f64, Error> {
    let wrong = |message: String| {
        let remedy = "write it with its unit, s, ms or us, for example 11.55us";
        Error::at(COMMAND_LINE, 0, "--delay", message, remedy)
    };
    let found = DELAY_UNITS
        .iter()
        .find_map(|(unit, factor)| Some((text.strip_suffix(unit)?, factor)));
    let Some((digits, factor)) = found else {
        return Err(wrong(format!("`{text}` has no unit of time")));
    };
    let seconds = factor * number("--delay", digits)?;
    if seconds.abs() > LARGEST_DELAY_S {
        return Err(wrong(format!("{text} is more than 100 ms")));
    }
    Ok(seconds)
}

/// A time in microseconds with at most three decimals.
fn in_micro(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e3
}

fn split<'f>(flag: &str, text: &'f str) -> Result<(Target, &'f str), Error> {
    let Some((target, value)) = text.split_once('=').filter(|(_, value)| !value.is_empty()) else {
        let message = format!("`{text}` is not of the form CHANNEL=VALUE");
        let remedy = format!("write for example {flag} speed={}", example(flag));
        return Err(Error::at(COMMAND_LINE, 0, flag, message, remedy));
    };
    match Target::parse(target) {
        Some(target) => Ok((target, value)),
        None => {
            let message = format!("`{target}` is not a channel");
            Err(Error::at(COMMAND_LINE, 0, flag, message, channels(target)))
        }
    }
}

fn example(flag: &str) -> &'static str {
    match flag {
        "--column" => "speed_raw",
        "--unit" => "rpm",
        "--scale" => "1.02",
        "--delay" => "11.55us",
        _ => "-2.11",
    }
}

/// The remedy for a name that is not a channel.
pub(crate) fn channels(misspelt: &str) -> String {
    let names: Vec<String> = Target::all().map(|target| target.to_string()).collect();
    match closest(misspelt, names.iter().map(String::as_str)) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => "use one of t, va vb vc, ia ib ic, speed, torque, temperature; \
                 a second probe has a 2 behind its name"
            .to_owned(),
    }
}

fn number(flag: &str, text: &str) -> Result<f64, Error> {
    text.trim()
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite())
        .ok_or_else(|| {
            let message = format!("`{text}` is not a finite number");
            let remedy = "write it with a decimal point, as 1.02";
            Error::at(COMMAND_LINE, 0, flag, message, remedy)
        })
}

#[cfg(test)]
mod tests;
