//! Load tables from files, and telling them from recordings.

use super::budget::{most_numbers, too_large};
use super::header::{Header, Unreadable, shown};
use super::plan::list;
use super::table_file::TableFile;
use crate::read::text::source::Progress;
use recording::{Error, LoadTable, Mapping, TableColumn, Target, closest};
use std::collections::BTreeMap;

/// What a file holds, by the names of its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Recording,
    LoadTable,
}

/// Tells a load table from a recording.
pub(super) fn kind(header: &Header, mapping: &Mapping) -> Result<Kind, Error> {
    let of_table = header
        .names
        .iter()
        .find(|name| TableColumn::parse(name).is_some());
    let mapped = |name: &String| {
        mapping
            .columns
            .values()
            .any(|map| map.name.as_ref() == Some(name))
    };
    if mapping.names.is_some() {
        return Ok(Kind::Recording);
    }
    let electrical = |name: &String| matches!(Target::parse(name), Some(Target::Channel(channel)) if channel.is_electrical());
    let of_recording = header
        .names
        .iter()
        .find(|name| electrical(name) || mapped(name));
    match (of_table, of_recording) {
        (Some(table), Some(recording)) => {
            let (table, recording) = (shown(table), shown(recording));
            let message =
                format!("`{table}` belongs to a load table, `{recording}` to a recording in time");
            let remedy = "put the two into two files";
            Err(header.error("", message, remedy))
        }
        (Some(_), None) => Ok(Kind::LoadTable),
        (None, _) => Ok(Kind::Recording),
    }
}

/// Reads a load table of which the header has been read.
pub(super) fn load_table(
    file: &mut dyn TableFile,
    progress: &mut dyn FnMut(Progress),
) -> Result<LoadTable, Error> {
    let (used, notes) = assign(file.header())?;
    let name = file.header().file.clone();
    LoadTable::sufficient(&name, used.iter().map(|(column, _)| *column))?;
    let mut columns: BTreeMap<TableColumn, Vec<f64>> = BTreeMap::new();
    let width = file.header().names.len() as u64;
    let mut rows = 0;
    file.check_size()?;
    file.for_each_row(progress, &mut |cells| {
        rows += 1;
        if rows * width > most_numbers() {
            return Err(too_large(&name));
        }
        for (column, k) in &used {
            let x = cells
                .number(*k, column.name())?
                .ok_or_else(|| cells.missing(column.name()))?;
            if !x.is_finite() {
                return Err(cells.not_finite(*k, column.name(), x));
            }
            if let Some((complaint, remedy)) = column.complaint(x) {
                let message = format!("{x} {complaint}");
                return Err(Error::at(
                    &name,
                    cells.line(),
                    column.name(),
                    message,
                    remedy,
                ));
            }
            columns.entry(*column).or_default().push(x);
        }
        Ok(())
    })?;
    let mut table = LoadTable::new(&name, columns_or_empty(columns, &used))?;
    table.assumptions = notes;
    Ok(table)
}

/// A table without rows still has its columns, so that the error is about the rows.
fn columns_or_empty(
    mut columns: BTreeMap<TableColumn, Vec<f64>>,
    used: &[(TableColumn, usize)],
) -> BTreeMap<TableColumn, Vec<f64>> {
    for (column, _) in used {
        columns.entry(*column).or_default();
    }
    columns
}

type Used = Vec<(TableColumn, usize)>;

fn assign(header: &Header) -> Result<(Used, Vec<String>), Error> {
    let unreadable = header.unreadable.iter();
    if let Some(one) = unreadable
        .clone()
        .find(|one| TableColumn::parse(&one.name).is_some())
    {
        let message = format!("cannot be read: {}", one.why);
        return Err(header.error(&shown(&one.name), message, one.remedy));
    }
    let (mut used, mut notes) = (Vec::new(), header.notes.clone());
    notes.extend(unreadable.map(Unreadable::note));
    for (k, name) in header.names.iter().enumerate() {
        match TableColumn::parse(name) {
            Some(column) => used.push((column, k)),
            None => notes.push(stranger(header, name)?),
        }
    }
    Ok((used, notes))
}

fn stranger(header: &Header, name: &str) -> Result<String, Error> {
    let absent = TableColumn::ALL.iter().map(|column| column.name());
    let absent = absent.filter(|known| !header.names.iter().any(|name| name == known));
    match closest(name, absent) {
        None => Ok(format!("column {} is not used", shown(name))),
        Some(meant) => {
            let message = "is not a known column of a load table";
            let known = list(&header.names);
            let remedy = format!("did you mean `{meant}`? The file has {known}");
            Err(header.error(&shown(name), message, &remedy))
        }
    }
}
