//! How the columns are to be read: the layout of the file, and `[columns]`.

use crate::data::channel::Quantity;
use crate::data::units::Unit;
use crate::mapping::flags::{
    DATE_ORDERS, DELIMITERS, LARGEST_DELAY_S, THOUSANDS, check_names, date_order, delimiter,
    refused_unknown, thousands,
};
use crate::mapping::{ColumnMap, Factor, LINE, Mapping, Origin, Said, Slot, Target};
use document::{Bounds, Section, Value};

const DELAY_US: Bounds = Bounds::between(-1e6 * LARGEST_DELAY_S, 1e6 * LARGEST_DELAY_S, "us");
const RATE: Bounds = Bounds::between(0.1, 1e8, "Hz");

pub(super) fn mapping(root: &Section<'_>, scales: Mapping) -> Option<Mapping> {
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
    if matches!(entry.map(|entry| &entry.value), Some(Value::Text(text)) if text == Factor::UNKNOWN)
    {
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
