//! The sidecar of a recording: `x.toml` beside `x.csv.gz`.

use super::flags::{
    DATE_ORDERS, DELIMITERS, LARGEST_DELAY_S, THOUSANDS, UNKNOWN, all_of, check_names, date_order,
    delimiter, refused_unknown, thousands,
};
use super::{ColumnMap, Factor, LINE, Mapping, Origin, Said, Sensor, Slot, Target};
use crate::data::channel::{Channel, Quantity};
use crate::data::metadata::{LoadTorque, Metadata, Sensors, StartsFrom, Supply, VoltageKind};
use crate::data::units::Unit;
use crate::error::{Error, Problem};
use crate::names::sidecar_path;
use motor::document::{Bounds, Document, FileError, Section, Value, read_text};
use std::path::Path;

/// What a sidecar says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sidecar {
    /// What is known beside the samples.
    pub metadata: Metadata,
    /// How the columns are to be read.
    pub mapping: Mapping,
}

impl Sidecar {
    /// Reads the sidecar beside a recording; without one, the defaults.
    ///
    /// # Errors
    /// All problems of the file, each with line, key and remedy.
    pub fn beside(recording: &Path) -> Result<Sidecar, Error> {
        let path = sidecar_path(recording);
        if path.exists() {
            Sidecar::read(&path)
        } else {
            Ok(Sidecar::default())
        }
    }

    /// Reads a sidecar.
    ///
    /// # Errors
    /// All problems of the file, each with line, key and remedy.
    pub fn read(path: &Path) -> Result<Sidecar, Error> {
        let file = path.display().to_string();
        if std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() == 0) {
            let remedy = "remove it, or write for example voltage = \"instantaneous\"";
            return Err(Error::bad(&file, "the sidecar is empty", remedy));
        }
        Sidecar::parse(&read_text(path)?, &file)
    }

    /// Reads the text of a sidecar; `file` is the name that errors print.
    ///
    /// # Errors
    /// All problems of the text, each with line, key and remedy.
    pub fn parse(text: &str, file: &str) -> Result<Sidecar, Error> {
        let document = Document::parse(text, file)?;
        let root = document.root();
        if root.has("nameplate") {
            return Err(motor_file(file, root.line_of("nameplate")));
        }
        let sidecar = sidecar(root);
        Ok(document.finish(sidecar)?)
    }
}

fn motor_file(file: &str, line: usize) -> Error {
    let remedy = "rename one of the two: the sidecar of x.csv is always x.toml beside it";
    let message = "this is a motor file, not the sidecar of the recording of the same name";
    Error::at(file, line as u64, "nameplate", message, remedy)
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Error {
        let problems = error.problems().iter().map(|problem| Problem {
            file: problem.file.clone(),
            line: problem.line as u64,
            field: problem.key.clone(),
            message: problem.message.clone(),
            remedy: String::new(),
        });
        Error::of(problems.collect())
    }
}

const VOLTAGE: [(&str, VoltageKind); 2] = [
    ("instantaneous", VoltageKind::Instantaneous),
    ("hold", VoltageKind::Hold),
];
const SUPPLY: [(&str, Supply); 2] = [("grid", Supply::Grid), ("inverter", Supply::Inverter)];
const LOAD: [(&str, LoadTorque); 3] = [
    ("measured", LoadTorque::Measured),
    ("friction", LoadTorque::Friction),
    ("free", LoadTorque::Free),
];
const STARTS: [(&str, StartsFrom); 5] = [
    ("standstill", StartsFrom::Standstill),
    ("running", StartsFrom::Running),
    ("steady", StartsFrom::Running),
    ("steady-state", StartsFrom::Running),
    ("unknown", StartsFrom::Unknown),
];

fn sidecar(root: Section<'_>) -> Option<Sidecar> {
    let mut scales = Mapping::default();
    let metadata = metadata(&root, &mut scales);
    let mapping = mapping(&root, scales);
    root.finish();
    Some(Sidecar {
        metadata: metadata?,
        mapping: mapping?,
    })
}

fn metadata(root: &Section<'_>, scales: &mut Mapping) -> Option<Metadata> {
    let voltage = root.choice_or("voltage", &VOLTAGE, VoltageKind::default());
    let supply = root.choice_or("supply", &SUPPLY, Supply::default());
    let belief = root.optional_text("supply_belief");
    let load_torque = root.choice_or("load_torque", &LOAD, LoadTorque::default());
    let starts_from = root.choice_or("starts_from", &STARTS, StartsFrom::default());
    let sensors = match root.optional_section("sensors")? {
        Some(section) => sensors(section, scales)?,
        None => Sensors::default(),
    };
    Some(Metadata {
        voltage: voltage?,
        supply: supply?,
        supply_belief: belief?.unwrap_or_default(),
        load_torque: load_torque?,
        starts_from: starts_from?,
        sensors,
    })
}

const VOLT: Bounds = Bounds::above(0.0, 1e6, "V");
const AMP: Bounds = Bounds::above(0.0, 1e6, "A");
const RAD_S: Bounds = Bounds::above(0.0, 1e5, "rad/s");
const NM: Bounds = Bounds::above(0.0, 1e7, "N m");
const NOISE: Bounds = Bounds::between(0.0, 0.5, "of full scale").hint("0.2 % is 0.002");
const BITS: Bounds = Bounds::between(4.0, 32.0, "bits");
const PULSES: Bounds = Bounds::between(1.0, 1e6, "per revolution");
const DELAY_US: Bounds = Bounds::between(-1e6 * LARGEST_DELAY_S, 1e6 * LARGEST_DELAY_S, "us");
const EDGES: [(f64, u32); 3] = [(1.0, 1), (2.0, 2), (4.0, 4)];
const RATE: Bounds = Bounds::between(0.1, 1e8, "Hz");

/// `ia = "100 mV/A"` in `[sensors]`; `i` and `v` mean all currents and all voltages.
fn scales(section: &Section<'_>, mapping: &mut Mapping) -> Option<()> {
    let groups = ["v", "i"]
        .into_iter()
        .filter_map(|name| Some((name, all_of(name)?)));
    for (name, quantity) in groups {
        if let Some(sensor) = sensor(section, name, quantity)? {
            let origin = Origin::Sidecar;
            mapping.sensors.insert(
                quantity,
                Said {
                    what: sensor,
                    origin,
                },
            );
        }
    }
    for channel in Channel::all() {
        if let Some(sensor) = sensor(section, &channel.to_string(), channel.quantity())? {
            let map = mapping.entry(Target::Channel(channel));
            map.sensor = Some(sensor);
            map.origin = Origin::Sidecar;
        }
    }
    Some(())
}

fn sensor(section: &Section<'_>, key: &str, quantity: Quantity) -> Option<Option<Sensor>> {
    let Some(text) = section.optional_text(key)? else {
        return Some(None);
    };
    let sensor = Sensor::parse(quantity, &text);
    if let Err(why) = &sensor {
        section.report(key, format!("{why}: {}", super::sensor::WAYS));
    }
    sensor.ok().map(Some)
}

fn sensors(section: Section<'_>, mapping: &mut Mapping) -> Option<Sensors> {
    let scales = scales(&section, mapping);
    let number = |key, bounds| section.optional_number(key, bounds);
    let voltage = number("voltage_full_scale_volt", &VOLT);
    let current = number("current_full_scale_amp", &AMP);
    let speed = number("speed_full_scale_rad_s", &RAD_S);
    let torque = number("torque_full_scale_nm", &NM);
    let noise = number("noise_sigma_fraction_of_full_scale", &NOISE);
    let adc_bits = whole(&section, "adc_bits", &BITS);
    let pulses = whole(&section, "encoder_pulses_per_revolution", &PULSES);
    let counter_bits = whole(&section, "encoder_counter_bits", &BITS);
    let edges = edges(&section);
    section.finish();
    scales?;
    Some(Sensors {
        voltage_full_scale_volt: voltage?,
        current_full_scale_amp: current?,
        speed_full_scale_rad_s: speed?,
        torque_full_scale_nm: torque?,
        noise_sigma_fraction_of_full_scale: noise?,
        adc_bits: adc_bits?,
        encoder_pulses_per_revolution: pulses?,
        encoder_counter_bits: counter_bits?,
        encoder_edges_per_pulse: edges?,
    })
}

fn whole(section: &Section<'_>, key: &str, bounds: &Bounds) -> Option<Option<u32>> {
    if !section.has(key) {
        // Asking makes the key known, so that a misspelt one finds it.
        return section.optional_number(key, bounds).map(|_| None);
    }
    section.integer(key, bounds, "").map(Some)
}

fn edges(section: &Section<'_>) -> Option<Option<u32>> {
    let key = "encoder_edges_per_pulse";
    let Some(number) = section.optional_number(key, &Bounds::between(1.0, 4.0, ""))? else {
        return Some(None);
    };
    let found = EDGES.iter().find(|(edges, _)| *edges == number);
    if found.is_none() {
        section.report(key, format!("{number} edges per pulse: write 1, 2 or 4"));
    }
    found.map(|(_, edges)| Some(*edges))
}

fn mapping(root: &Section<'_>, scales: Mapping) -> Option<Mapping> {
    let line_voltages = flag(root, "line_voltages");
    let skip_missing = flag(root, "skip_missing");
    let decimal_comma = flag(root, "decimal_comma");
    let sample_rate_hz = root.optional_number("sample_rate_hz", &RATE);
    let delimiter = word(root, "delimiter", delimiter, DELIMITERS);
    let thousands = word(root, "thousands", thousands, THOUSANDS);
    let date_order = word(root, "date_order", date_order, DATE_ORDERS);
    let names = names(root);
    let mut mapping = Mapping {
        line_voltages: line_voltages?,
        skip_missing: skip_missing?,
        decimal_comma: decimal_comma?,
        sample_rate_hz: sample_rate_hz?,
        delimiter: delimiter?,
        thousands: thousands?,
        date_order: date_order?,
        names: names?.map(|what| Said {
            what,
            origin: Origin::Sidecar,
        }),
        ..scales
    };
    if let Some(section) = root.optional_section("columns")? {
        columns(section, &mut mapping)?;
    }
    Some(mapping)
}

fn flag(section: &Section<'_>, key: &str) -> Option<Option<bool>> {
    let value = section.flag_or(key, false)?;
    Some(section.has(key).then_some(value))
}

/// A key that takes one of a few words.
fn word<T>(
    root: &Section<'_>,
    key: &str,
    parse: fn(&str) -> Option<T>,
    words: &str,
) -> Option<Option<T>> {
    let Some(text) = root.optional_text(key)? else {
        return Some(None);
    };
    let found = parse(&text);
    if found.is_none() {
        root.report(key, format!("\"{text}\" is not known: {words}"));
    }
    found.map(Some)
}

/// `column_order = "t,va,vb,-,ia"`.
fn names(root: &Section<'_>) -> Option<Option<Vec<String>>> {
    let key = "column_order";
    let Some(text) = root.optional_text(key)? else {
        return Some(None);
    };
    let names: Vec<String> = text.split(',').map(|name| name.trim().to_owned()).collect();
    match check_names(&names) {
        Ok(()) => Some(Some(names)),
        Err((message, remedy)) => {
            root.report(key, format!("{message}: {remedy}"));
            None
        }
    }
}

/// `[columns]`: `ic = "ic2"`, or `speed = { name = "n", unit = "rpm", scale = 1.02, offset = -2.1 }`.
fn columns(section: Section<'_>, mapping: &mut Mapping) -> Option<()> {
    let mut sound = Some(());
    let names = Target::all().map(|target| target.to_string());
    let lines = LINE.iter().map(|(name, ..)| (*name).to_owned());
    for key in names.chain(lines) {
        let Some(slot) = Slot::parse(&key) else {
            continue;
        };
        match column(&section, &key, slot.target, mapping.raw(slot.target)) {
            Some(Some(map)) => {
                let sensor = mapping.entry(slot.target).sensor.take();
                *mapping.entry(slot.target) = ColumnMap { sensor, ..map };
                mapping.note_line(slot);
            }
            Some(None) => {}
            None => sound = None,
        }
    }
    section.finish();
    sound
}

fn column(
    section: &Section<'_>,
    key: &str,
    target: Target,
    holds: Quantity,
) -> Option<Option<ColumnMap>> {
    let entry = section.entries().iter().find(|entry| entry.key == key);
    if !matches!(entry.map(|entry| &entry.value), Some(Value::Table(_))) {
        let name = section.optional_text(key)?;
        return Some(name.map(|name| ColumnMap {
            name: Some(name),
            origin: Origin::Sidecar,
            ..ColumnMap::default()
        }));
    }
    let table = section.optional_section(key)??;
    let name = table.optional_text("name");
    let unit = unit(&table, target, holds);
    let scale = scale(&table, target);
    let offset = table.optional_number("offset", &Bounds::between(-1e12, 1e12, ""));
    // The clock cannot be late against itself: there the key is an unknown one.
    let delay_us = match target {
        Target::Time => Some(None),
        Target::Channel(_) => table.optional_number("delay_us", &DELAY_US),
    };
    table.finish();
    Some(Some(ColumnMap {
        origin: Origin::Sidecar,
        name: name?,
        unit: unit?,
        sensor: None,
        scale: scale?,
        offset: offset?,
        delay: delay_us?.map(|delay_us| 1e-6 * delay_us),
    }))
}

/// A factor, or `"unknown"`.
fn scale(table: &Section<'_>, target: Target) -> Option<Option<Factor>> {
    let entry = table.entries().iter().find(|entry| entry.key == "scale");
    if matches!(entry.map(|entry| &entry.value), Some(Value::Text(text)) if text == UNKNOWN) {
        // Asking makes the key known.
        table.optional_text("scale")?;
        if let Some(message) = refused_unknown(target) {
            table.report("scale", format!("{message}: write a number"));
        }
        return Some(Some(Factor::Unknown));
    }
    let factor = table.optional_number("scale", &Bounds::between(-1e12, 1e12, ""))?;
    if factor == Some(0.0) {
        table.report(
            "scale",
            "0 would erase the column: write a factor other than 0",
        );
    }
    Some(factor.map(Factor::Known))
}

fn unit(table: &Section<'_>, target: Target, holds: Quantity) -> Option<Option<Unit>> {
    let Some(name) = table.optional_text("unit")? else {
        return Some(None);
    };
    match Unit::parse(holds, &name) {
        Ok(unit) => Some(Some(unit)),
        Err(known) => {
            table.report(
                "unit",
                format!("\"{name}\" is not a unit of {target}: use one of {known}"),
            );
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_read() {
        let text = r#"
            voltage = "hold"
            supply = "inverter"
            supply_belief = "ideal"
            load_torque = "friction"
            starts_from = "standstill"
            line_voltages = true
            sample_rate_hz = 5000
            skip_missing = true
            decimal_comma = true
            delimiter = "tab"
            [sensors]
            voltage_full_scale_volt = 600.0
            adc_bits = 12
            encoder_pulses_per_revolution = 1024
            encoder_edges_per_pulse = 2
            encoder_counter_bits = 16
            [columns]
            ic = "ic2"
            ia = { delay_us = 11.55 }
            speed = { name = "n", unit = "rpm", scale = 1.02, offset = -2.1 }
        "#;
        let Sidecar { metadata, mapping } = Sidecar::parse(text, "x.toml").unwrap();
        assert_eq!(metadata.voltage, VoltageKind::Hold);
        assert_eq!(metadata.supply, Supply::Inverter);
        assert_eq!(metadata.load_torque, LoadTorque::Friction);
        assert_eq!(metadata.starts_from, StartsFrom::Standstill);
        assert_eq!(metadata.sensors.adc_bits, Some(12));
        assert_eq!(metadata.sensors.encoder_edges_per_pulse, Some(2));
        assert_eq!(
            (mapping.line_voltages, mapping.delimiter),
            (Some(true), Some(b'\t'))
        );
        let speed = &mapping.columns[&Target::Channel(Channel::SPEED)];
        assert_eq!(
            (speed.scale, speed.offset),
            (Some(Factor::Known(1.02)), Some(-2.1))
        );
        let ic = &mapping.columns[&Target::Channel(Channel::CURRENTS[2])];
        assert_eq!(ic.name.as_deref(), Some("ic2"));
        let ia = &mapping.columns[&Target::Channel(Channel::CURRENTS[0])];
        assert!((ia.delay.unwrap() - 11.55e-6).abs() < 1e-18);
    }

    #[test]
    fn only_the_factor_of_the_speed_may_be_unknown() {
        let text = "[columns.speed]\nscale = \"unknown\"";
        let mapping = Sidecar::parse(text, "x.toml").unwrap().mapping;
        let speed = &mapping.columns[&Target::Channel(Channel::SPEED)];
        assert_eq!(speed.scale, Some(Factor::Unknown));
        for (text, expected) in [
            ("[columns.ia]\nscale = \"unknown\"", "ia cannot be unknown"),
            ("[columns.speed]\nscale = \"unknwon\"", "scale"),
        ] {
            let error = Sidecar::parse(text, "x.toml").unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn what_is_not_said_stays_open() {
        let sidecar = Sidecar::parse("voltage = \"instantaneous\"", "x.toml").unwrap();
        assert_eq!(sidecar, Sidecar::default());
    }
}
