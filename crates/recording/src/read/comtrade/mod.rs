//! COMTRADE, as protection relays and fault recorders write it: `.cfg` with `.dat`, or one `.cff`.
//!
//! IEEE C37.111-1991, -1999 and -2013 (IEC 60255-24). Primary values in the unit that a channel declares.

mod clock;
mod configuration;
mod data;
mod lines;
mod pair;

use super::columns::{Columns, check_size};
use super::header::{Header, shown};
use super::table_file::TableFile;
use crate::error::Error;
use configuration::{Analog, Configuration};
use data::Samples;
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
    let pair = pair::Pair::open(path)?;
    let configuration = Configuration::parse(&pair.configuration_name, &pair.configuration)?;
    let channels = configuration.analogs.len();
    let rows = pair.data.len() / configuration.fewest_bytes();
    check_size(&pair.data_name, rows as u64, channels + 1)?;
    let samples = data::read(&pair.data_name, &pair.data, &configuration)?;
    let mut notes = samples.notes(&configuration);
    let t = clock::seconds(
        &pair.configuration_name,
        &configuration,
        &samples,
        &mut notes,
    )?;
    let mut values = vec![t];
    for (analog, raw) in configuration.analogs.iter().zip(&samples.values) {
        values.push(raw.iter().map(|x| analog.value(*x)).collect());
        notes.extend(analog.note());
    }
    let mut header = Header::new(path.display().to_string(), 0, names(&configuration))?;
    header.units = units(&configuration);
    header.notes = notes;
    Ok(Box::new(Columns::new(header, values, pair.bytes)?))
}

/// `t` and the channels' names; one that stands there twice gets its number.
fn names(configuration: &Configuration) -> Vec<String> {
    let mut names = vec!["t".to_owned()];
    for (k, analog) in configuration.analogs.iter().enumerate() {
        let usable = !analog.name.is_empty() && analog.name.parse::<f64>().is_err();
        let mut name = if usable {
            analog.name.clone()
        } else {
            format!("channel_{}", k + 1)
        };
        while names.contains(&name) {
            name.push_str(&format!("_{}", k + 1));
        }
        names.push(name);
    }
    names
}

fn units(configuration: &Configuration) -> Vec<Option<String>> {
    let declared = |analog: &Analog| Some(analog.unit.clone()).filter(|unit| !unit.is_empty());
    let channels = configuration.analogs.iter().map(declared);
    std::iter::once(None).chain(channels).collect()
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
        match self.ratio {
            Some(ratio) => Some(format!(
                "{name} holds secondary values: times {ratio} to the primary side, as the file declares"
            )),
            None if self.unit.is_empty() => {
                Some(format!("the file declares no unit for {name}; SI, assumed"))
            }
            None => None,
        }
    }
}
