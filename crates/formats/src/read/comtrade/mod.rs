//! COMTRADE, as protection relays and fault recorders write it: `.cfg` with `.dat`, or one `.cff`.
//!
//! IEEE C37.111-1991, -1999 and -2013 (IEC 60255-24). Primary values in the unit that a channel declares.

mod clock;
mod configuration;
mod data;
mod lines;
mod pair;

use super::columns::{Columns, check_size};
use super::header::{Header, Unreadable, shown};
use super::table_file::TableFile;
use configuration::{Analog, Configuration, Side};
use data::Samples;
use recording::Error;
use std::path::Path;

pub(super) use pair::has_configuration;

/// Whether a file begins as `.cff` files do.
pub(super) fn is(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
    let line = head.split(|byte| *byte == b'\n').next().unwrap_or_default();
    pair::section(line).is_some()
}

/// Reads the analogue channels of a `.cfg`, a `.dat` beside its `.cfg`, or a `.cff`.
pub(super) fn open(path: &Path) -> Result<Box<dyn TableFile>, Error> {
    table(&path.display().to_string(), &pair::Pair::open(path)?)
}

/// Reads the analogue channels of a `.cff` that is in memory.
pub(super) fn of_bytes(name: &str, bytes: Vec<u8>) -> Result<Box<dyn TableFile>, Error> {
    table(name, &pair::Pair::of_one(name, &bytes)?)
}

fn table(name: &str, pair: &pair::Pair) -> Result<Box<dyn TableFile>, Error> {
    let configuration = Configuration::parse(&pair.configuration_name, &pair.configuration)?;
    let channels = configuration.analogs.len();
    let rows = pair.data.len() / configuration.fewest_bytes();
    check_size(&pair.data_name, rows as u64, channels + 1)?;
    let samples = data::read(&pair.data_name, &pair.data, &configuration)?;
    let mut notes = samples.notes(&configuration);
    let clock = clock::seconds(
        &pair.configuration_name,
        &configuration,
        &samples,
        &mut notes,
    )?;
    let mut columns = vec![("t".to_owned(), None, clock.seconds)];
    let mut unreadable: Vec<Unreadable> = clock.contradiction.into_iter().collect();
    let channels = configuration.analogs.iter().zip(names(&configuration));
    for ((analog, column), raw) in channels.zip(&samples.values) {
        if let Some(obstacle) = analog.obstacle(&column) {
            unreadable.push(obstacle);
            continue;
        }
        let unit = Some(analog.unit.clone()).filter(|unit| !unit.is_empty());
        columns.push((column, unit, raw.iter().map(|x| analog.value(*x)).collect()));
        notes.extend(analog.note());
    }
    columns.retain(|(column, ..)| !unreadable.iter().any(|one| one.name == *column));
    let names = columns.iter().map(|(column, ..)| column.clone()).collect();
    let mut header = Header::new(name.to_owned(), 0, names)?;
    header.units = columns.iter().map(|(_, unit, _)| unit.clone()).collect();
    header.notes = notes;
    header.unreadable = unreadable;
    let values = columns.into_iter().map(|(.., values)| values).collect();
    Ok(Box::new(Columns::new(header, values, pair.bytes)?))
}

/// The channels' names; one that appears twice, or is the clock's, gets its number.
fn names(configuration: &Configuration) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (k, analog) in configuration.analogs.iter().enumerate() {
        let usable = !analog.name.is_empty() && analog.name.parse::<f64>().is_err();
        let mut name = if usable {
            analog.name.clone()
        } else {
            format!("channel_{}", k + 1)
        };
        while name == "t" || names.contains(&name) {
            name.push_str(&format!("_{}", k + 1));
        }
        names.push(name);
    }
    names
}

impl Samples {
    /// What is odd about the samples, and what is left out.
    fn notes(&self, configuration: &Configuration) -> Vec<String> {
        let mut notes = self.oddities.clone();
        let (declared, held) = (configuration.declared_samples(), self.numbers.len() as u64);
        if declared > 0 && declared != held {
            notes.push(format!(
                "the configuration declares {declared} samples, the data hold {held}"
            ));
        }
        if configuration.digitals > 0 {
            let count = configuration.digitals;
            notes.push(format!("{count} status channels are not used"));
        }
        notes
    }
}

impl Analog {
    fn note(&self) -> Option<String> {
        let name = shown(&self.name);
        match self.side {
            Side::Secondary(ratio) => Some(format!(
                "{name} holds secondary values: times {ratio} to the primary side, as the file declares"
            )),
            _ if self.unit.is_empty() => {
                Some(format!("the file declares no unit for {name}; SI, assumed"))
            }
            _ => None,
        }
    }

    /// Why the values cannot be used.
    fn obstacle(&self, column: &str) -> Option<Unreadable> {
        let Side::Unknown(ratio) = &self.side else {
            return None;
        };
        Some(Unreadable {
            name: column.to_owned(),
            why: format!(
                "its values are secondary (S), but its ratio primary/secondary is {}",
                shown(ratio)
            ),
            remedy: "write the transformer's ratio into the .cfg, or P where the values are primary",
        })
    }
}
