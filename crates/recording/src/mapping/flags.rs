//! The flags that say how a file is to be read.

use super::sensor::{self, Sensor};
use super::{DateOrder, Factor, Mapping, Origin, Said, Slot, Target};
use crate::data::channel::{Channel, Quantity};
use crate::data::units::Unit;
use crate::error::Error;
use crate::suggest::closest;

/// Rates between one sample in ten seconds and 100 MHz.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.1..=1e8;

impl Mapping {
    /// `--column TARGET=NAME`: the target is read from the column `NAME`.
    ///
    /// # Errors
    /// Text that is not `TARGET=NAME`, or an unknown target.
    pub fn set_column(&mut self, flag: &str) -> Result<(), Error> {
        let (slot, name) = split("--column", flag)?;
        self.entry(slot.target).name = Some(name.to_owned());
        self.note_line(slot);
        Ok(())
    }

    /// Takes a line voltage for what it is; one that is the other way round has a factor of -1.
    pub(super) fn note_line(&mut self, slot: Slot) {
        if let Some(is_reversed) = slot.line {
            self.line_voltages = Some(true);
            if is_reversed {
                self.entry(slot.target).scale = Some(Factor::Known(-1.0));
            }
        }
    }

    /// `--unit TARGET=UNIT`.
    ///
    /// # Errors
    /// Text that is not `TARGET=UNIT`, an unknown target, or a unit of another quantity.
    pub fn set_unit(&mut self, flag: &str) -> Result<(), Error> {
        let (target, name) = target_of("--unit", flag)?;
        let quantity = self.raw(target);
        let unit = Unit::parse(quantity, name).map_err(|known| {
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
        let (target, text) = target_of("--scale", flag)?;
        if text == Factor::UNKNOWN {
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
        let (target, text) = target_of("--offset", flag)?;
        self.entry(target).offset = Some(number("--offset", text)?);
        Ok(())
    }

    /// `--delay TARGET=TIME`, the time with its unit, s, ms or us: how much later than its row the channel was sampled.
    ///
    /// # Errors
    /// Text that is not `TARGET=TIME`, an unknown target, the clock itself, or more than 0.1 s.
    pub fn set_delay(&mut self, flag: &str) -> Result<(), Error> {
        let (target, text) = target_of("--delay", flag)?;
        if target == Target::Time {
            let message = "the clock cannot be late against itself";
            let remedy = "name the channels that were sampled at other instants";
            return Err(Error::at(COMMAND_LINE, 0, "--delay", message, remedy));
        }
        self.entry(target).delay = Some(delay(text)?);
        Ok(())
    }

    /// What the column of a target holds: its quantity, or what its sensor gives out.
    pub(super) fn raw(&self, target: Target) -> Quantity {
        let quantity = target.quantity();
        let own = self
            .columns
            .get(&target)
            .and_then(|map| map.sensor.as_ref());
        own.or_else(|| self.sensors.get(&quantity).map(|said| &said.what))
            .map_or(quantity, Sensor::raw)
    }

    /// `--sensor ia=100mV/A`, or `i=100mV/A` for all currents, `v=1000:1` for all voltages.
    ///
    /// # Errors
    /// Text that is not `CHANNEL=SCALE`, an unknown channel, or no scale of such a sensor.
    pub fn set_sensor(&mut self, flag: &str) -> Result<(), Error> {
        let wrong = |message| Error::at(COMMAND_LINE, 0, "--sensor", message, sensor::WAYS);
        let named = flag.split_once('=');
        if let Some((quantity, text)) = named.and_then(|(name, text)| Some((all_of(name)?, text))) {
            let said = Said {
                what: Sensor::parse(quantity, text).map_err(wrong)?,
                origin: Origin::User,
            };
            self.sensors.insert(quantity, said);
            return Ok(());
        }
        let (target, text) = target_of("--sensor", flag)?;
        let sensor = Sensor::parse(target.quantity(), text).map_err(wrong)?;
        self.entry(target).sensor = Some(sensor);
        Ok(())
    }

    /// `--columns t,va,vb,-,ia`: the columns in their order.
    ///
    /// # Errors
    /// A name that is no channel, or one that appears twice.
    pub fn set_columns(&mut self, flag: &str) -> Result<(), Error> {
        let names: Vec<String> = flag.split(',').map(|name| name.trim().to_owned()).collect();
        check_names(&names).map_err(|(message, remedy)| {
            Error::at(COMMAND_LINE, 0, "--columns", message, remedy)
        })?;
        self.names = Some(Said {
            what: names,
            origin: Origin::User,
        });
        Ok(())
    }

    /// `--thousands C`: a point, a comma, an apostrophe, `space`, or `none`.
    ///
    /// # Errors
    /// Anything else.
    pub fn set_thousands(&mut self, text: &str) -> Result<(), Error> {
        self.thousands = Some(thousands(text).ok_or_else(|| {
            let message = format!("`{text}` does not stand between thousands");
            Error::at(COMMAND_LINE, 0, "--thousands", message, THOUSANDS)
        })?);
        Ok(())
    }

    /// `--date-order dmy` or `mdy`.
    ///
    /// # Errors
    /// Anything else.
    pub fn set_date_order(&mut self, text: &str) -> Result<(), Error> {
        self.date_order = Some(date_order(text).ok_or_else(|| {
            let message = format!("`{text}` is no order of day, month and year");
            Error::at(COMMAND_LINE, 0, "--date-order", message, DATE_ORDERS)
        })?);
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
}

pub(super) const COMMAND_LINE: &str = "command line";

/// Why the factor of a target cannot be left open; `None` for the speed.
pub(crate) fn refused_unknown(target: Target) -> Option<String> {
    (target != Target::Channel(Channel::SPEED))
        .then(|| format!("the factor of {target} cannot be unknown"))
}

pub(crate) const THOUSANDS: &str = "use one of `.` `,` `'` `space` `none`";
pub(crate) const DATE_ORDERS: &str = "use `dmy` (31/12/2024) or `mdy` (12/31/2024)";

/// What a flag or sidecar says to stand between thousands.
pub(crate) fn thousands(text: &str) -> Option<Option<char>> {
    match text {
        "none" => Some(None),
        "space" | " " => Some(Some(' ')),
        "." => Some(Some('.')),
        "," => Some(Some(',')),
        "'" => Some(Some('\'')),
        _ => None,
    }
}

/// The order that a flag or sidecar says.
pub(crate) fn date_order(text: &str) -> Option<DateOrder> {
    match text {
        "dmy" => Some(DateOrder::DayFirst),
        "mdy" => Some(DateOrder::MonthFirst),
        _ => None,
    }
}

/// The quantity of all voltages or all currents.
pub(in crate::mapping) fn all_of(name: &str) -> Option<Quantity> {
    match name {
        "v" => Some(Quantity::Voltage),
        "i" => Some(Quantity::Current),
        _ => None,
    }
}

/// Refuses names of columns that are no channels; message and remedy.
pub(in crate::mapping) fn check_names(names: &[String]) -> Result<(), (String, String)> {
    let used = names.iter().filter(|name| *name != "-");
    for (k, name) in names.iter().enumerate().filter(|(_, name)| *name != "-") {
        let Some(slot) = Slot::parse(name) else {
            return Err((
                format!("`{name}` is not a channel"),
                format!("{}, or `-` for a column that is not used", channels(name)),
            ));
        };
        let same =
            |other: &String| Slot::parse(other).is_some_and(|other| other.target == slot.target);
        if names[..k].iter().any(same) {
            let remedy = "name each channel once; a second probe has a 2 behind its name";
            return Err((format!("`{name}` appears twice"), remedy.to_owned()));
        }
    }
    match used.count() {
        0 => Err((
            "names no channel".to_owned(),
            "write for example t,va,vb,vc,ia,ib,ic".to_owned(),
        )),
        _ => Ok(()),
    }
}

pub(crate) const DELIMITERS: &str = "use one of `,` `;` `|` `tab` `space`";

/// The byte that a flag or sidecar calls a delimiter.
pub(crate) fn delimiter(text: &str) -> Option<u8> {
    match text {
        "," => Some(b','),
        ";" => Some(b';'),
        "|" => Some(b'|'),
        "tab" | "\t" => Some(b'\t'),
        "space" | " " => Some(b' '),
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

fn target_of<'f>(flag: &str, text: &'f str) -> Result<(Target, &'f str), Error> {
    split(flag, text).map(|(slot, value)| (slot.target, value))
}

fn split<'f>(flag: &str, text: &'f str) -> Result<(Slot, &'f str), Error> {
    let Some((target, value)) = text.split_once('=').filter(|(_, value)| !value.is_empty()) else {
        let message = format!("`{text}` is not of the form CHANNEL=VALUE");
        let remedy = format!("write for example {flag} speed={}", example(flag));
        return Err(Error::at(COMMAND_LINE, 0, flag, message, remedy));
    };
    match Slot::parse(target) {
        Some(slot) => Ok((slot, value)),
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
        "--sensor" => "60V/1000rpm",
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
