//! How the columns of a file become channels: names, units, scales, as flags or sidecar say.

mod flags;
mod sensor;
pub(crate) mod sidecar;
mod typed;

use crate::data::channel::{Channel, Quantity, Signal};
use crate::data::units::Unit;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

pub use sensor::Sensor;
pub use typed::{Flags, quoted};

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

/// What a column is called in a list of columns: a target, or a line voltage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Where the column goes; v_ab is kept where va is, v_bc where vb is, v_ca where vc is.
    pub target: Target,
    /// Of a line voltage, whether it is the other way round: `vba`.
    pub line: Option<bool>,
}

/// Names of line voltages, with the phase that keeps them and whether they are the other way round.
const LINE: [(&str, Signal, bool); 6] = [
    ("vab", Signal::Va, false),
    ("vbc", Signal::Vb, false),
    ("vca", Signal::Vc, false),
    ("vba", Signal::Va, true),
    ("vcb", Signal::Vb, true),
    ("vac", Signal::Vc, true),
];

impl Slot {
    /// The slot that a flag or a file calls `name`.
    pub fn parse(name: &str) -> Option<Slot> {
        let line = LINE.iter().find(|(line, ..)| *line == name);
        let of_line = line.map(|(_, signal, is_reversed)| Slot {
            target: Target::Channel(Channel::first(*signal)),
            line: Some(*is_reversed),
        });
        let plain = || Target::parse(name).map(|target| Slot { target, line: None });
        of_line.or_else(plain)
    }
}

/// The order of day and month in dates such as `3/4/2024`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DateOrder {
    /// `31/12/2024`.
    DayFirst,
    /// `12/31/2024`.
    MonthFirst,
}

/// The factor of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    /// Finite and not 0.
    Known(f64),
    /// Declared to be unknown: the channel is right up to a factor.
    Unknown,
}

impl Factor {
    /// How a flag or a sidecar writes [`Factor::Unknown`].
    pub const UNKNOWN: &str = "unknown";
}

/// How one column becomes a channel: `SI = sensor(unit(scale (raw - offset)))`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap {
    /// Name of the column in the file; the target's own name when absent.
    pub name: Option<String>,
    /// Unit of `scale (raw - offset)`; SI when absent.
    pub unit: Option<Unit>,
    /// The sensor behind the column, which then holds what the sensor gives out.
    pub sensor: Option<Sensor>,
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

impl Origin {
    /// The end of a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Origin::User => "user's assumption",
            Origin::Sidecar => "as the sidecar declares",
            Origin::File => "as the file declares",
        }
    }
}

/// Something that was said, and by whom.
#[derive(Clone, Debug, PartialEq)]
pub struct Said<T> {
    /// What was said.
    pub what: T,
    /// Who said so.
    pub origin: Origin,
}

impl ColumnMap {
    /// The SI value of a raw reading.
    pub fn to_si(&self, quantity: Quantity, raw: f64) -> f64 {
        let unit = self.unit.unwrap_or_else(|| Unit::si(self.raw(quantity)));
        let factor = match self.scale {
            Some(Factor::Known(factor)) => factor,
            Some(Factor::Unknown) | None => 1.0,
        };
        let raw = unit.to_si(factor * (raw - self.offset.unwrap_or(0.0)));
        self.sensor.as_ref().map_or(raw, |sensor| sensor.to_si(raw))
    }

    /// What the column holds: the quantity, or what its sensor gives out.
    pub fn raw(&self, quantity: Quantity) -> Quantity {
        self.sensor.as_ref().map_or(quantity, Sensor::raw)
    }

    /// Whether a reading is its own SI value: nothing is to be computed.
    pub fn is_plain(&self, quantity: Quantity) -> bool {
        let unit = self.unit.is_none_or(|unit| unit == Unit::si(quantity));
        let scale = !matches!(self.scale, Some(Factor::Known(factor)) if factor != 1.0);
        unit && scale && self.offset.unwrap_or(0.0) == 0.0 && self.sensor.is_none()
    }

    /// The conversion in words: `speed = 1.0144 x (speed_raw + 2.11) rad/s`.
    pub fn sentence(&self, target: Target, column: &str) -> Option<String> {
        if *self
            == (ColumnMap {
                origin: self.origin,
                ..ColumnMap::default()
            })
        {
            return None;
        }
        let who = self.origin.words();
        let unit = self
            .unit
            .unwrap_or_else(|| Unit::si(self.raw(target.quantity())));
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
        let sensor = self.sensor.as_ref().map_or(String::new(), |sensor| {
            format!(" through a sensor of {}", sensor.text())
        });
        Some(format!(
            "{target} = {scaled} in {}{sensor}{late}, {who}",
            unit.name
        ))
    }

    fn over(self, below: ColumnMap) -> ColumnMap {
        ColumnMap {
            name: self.name.or(below.name),
            unit: self.unit.or(below.unit),
            sensor: self.sensor.or(below.sensor),
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
    /// Separator of groups of three digits; `Some(None)` says that nothing does.
    pub thousands: Option<Option<char>>,
    /// Whether day or month comes first in dates that leave it open.
    pub date_order: Option<DateOrder>,
    /// The columns in their order, by the names of channels; `-` for one that is not used.
    pub names: Option<Said<Vec<String>>>,
    /// The sensors of all voltages or all currents that have none of their own.
    pub sensors: BTreeMap<Quantity, Said<Sensor>>,
    /// Pulses per turn of the encoder behind a column of counts.
    pub encoder_pulses_per_revolution: Option<u32>,
    /// The sidecar to read instead of the one beside the recording.
    pub sidecar: Option<PathBuf>,
}

impl Mapping {
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
            thousands: self.thousands.or(below.thousands),
            date_order: self.date_order.or(below.date_order),
            names: self.names.or(below.names),
            sensors: below.sensors.into_iter().chain(self.sensors).collect(),
            encoder_pulses_per_revolution: self
                .encoder_pulses_per_revolution
                .or(below.encoder_pulses_per_revolution),
            sidecar: self.sidecar.or(below.sidecar),
        }
    }
}

/// A time in microseconds with at most three decimals.
fn in_micro(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e3
}

#[cfg(test)]
mod tests;
