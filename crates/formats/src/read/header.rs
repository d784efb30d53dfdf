//! The names of a file's columns.

use crate::read::aliases;
use recording::{Error, TableColumn, Target, is_unit};
use std::collections::HashSet;

/// What a file says about its columns before the first sample.
pub(super) struct Header {
    /// The file as the user named it.
    pub file: String,
    /// Line of the header, counted from 1; 0 in a binary file.
    pub line: u64,
    /// The column names, trimmed and without quotes; none is empty or appears twice.
    pub names: Vec<String>,
    /// The names without the units that stand in them: `Ua` of `Ua [V]`.
    pub stems: Vec<String>,
    /// The unit that the file declares for each column; empty when it declares none at all.
    pub units: Vec<Option<String>>,
    /// What is to be said of a column that is used: how its cells are read.
    pub remarks: Vec<Option<String>>,
    /// Samples per second, where the file declares them beside its columns.
    pub rate: Option<DeclaredRate>,
    /// What had to be assumed to read the file, one sentence each.
    pub notes: Vec<String>,
    /// Columns that cannot be used: refused where they are asked for, named where they are not.
    pub unreadable: Vec<Unreadable>,
}

/// A rate that a file declares, for a file without a clock.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DeclaredRate {
    /// Samples per second.
    pub hz: f64,
    /// The sentence that says where it stands.
    pub note: String,
}

/// A column that is there and cannot be read.
pub(super) struct Unreadable {
    /// Its name.
    pub name: String,
    /// Why, as a sentence about it.
    pub why: String,
    /// What the user can do about it.
    pub remedy: &'static str,
}

impl Unreadable {
    /// A column of something else than numbers: `what` says of what.
    pub fn holds(name: &str, what: &str) -> Unreadable {
        Unreadable {
            name: name.to_owned(),
            why: format!("it holds {what}"),
            remedy: "export it as a column of real numbers, one per sample, or map another column with --column",
        }
    }

    /// The sentence for a column that was not asked for.
    pub fn note(&self) -> String {
        format!("column {} is not used: {}", shown(&self.name), self.why)
    }
}

impl Header {
    /// A header without units.
    ///
    /// # Errors
    /// Names that are empty, stand there twice, or are numbers.
    pub fn new(file: String, line: u64, names: Vec<String>) -> Result<Header, Error> {
        let mut names = names;
        let notes = name_all(&file, line, &mut names)?;
        let parts = names.iter().map(|name| name_and_unit(name));
        let (stems, units): (Vec<String>, Vec<_>) =
            parts.map(|(stem, unit)| (stem.to_owned(), unit)).unzip();
        Ok(Header {
            file,
            line,
            remarks: vec![None; names.len()],
            names,
            stems,
            units,
            rate: None,
            notes,
            unreadable: Vec::new(),
        })
    }

    /// An error about the header, at its line.
    pub fn error(&self, field: &str, message: impl Into<String>, remedy: &str) -> Error {
        Error::at(&self.file, self.line, field, message, remedy)
    }
}

/// The name of a column without one, counted from 0.
pub(super) fn column_name(k: usize) -> String {
    format!("column {}", k + 1)
}

/// Gives every column a name of its own; says what was given.
fn name_all(file: &str, line: u64, names: &mut [String]) -> Result<Vec<String>, Error> {
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        let message = "the first line holds numbers, not column names";
        let remedy = "put a line such as t,va,vb,vc,ia,ib,ic,speed before it, or name the columns in their order: --columns t,va,vb,vc,ia,ib,ic";
        return Err(Error::at(file, line, "", message, remedy));
    }
    let mut notes = Vec::new();
    let mut known = HashSet::new();
    for (k, name) in names.iter_mut().enumerate() {
        if name.is_empty() {
            *name = column_name(k);
            notes.push(format!("column {} has no name", k + 1));
        }
        if known.insert(name.clone()) {
            continue;
        }
        let twice = shown(name);
        if aliases::is_known(name_and_unit(name).0) {
            let message = format!("column `{twice}` appears twice");
            let remedy = "rename or remove one of the two, or name the columns in their order with --columns";
            return Err(Error::at(file, line, "", message, remedy));
        }
        *name = format!("{name} #{}", k + 1);
        notes.push(format!(
            "column `{twice}` appears twice: the second is called {}",
            shown(name)
        ));
    }
    Ok(notes)
}

/// Ends of a name that are units: `speed_rpm`.
const SUFFIXES: [&str; 14] = [
    "_rpm", "_V", "_mV", "_kV", "_A", "_mA", "_kA", "_s", "_ms", "_us", "_ns", "_Nm", "_degC",
    "_rad_s",
];

/// The name of a column and the unit that stands in it: `Ua [V]`, `I1 (A)`, `n in 1/min`, `U1/V`, `speed_rpm`.
pub(super) fn name_and_unit<'n>(name: &'n str) -> (&'n str, Option<String>) {
    let name = name.trim();
    if Target::parse(name).is_some() || TableColumn::parse(name).is_some() {
        return (name, None);
    }
    let bracketed = [('[', ']'), ('(', ')')].iter().find_map(|(open, close)| {
        let (stem, rest) = name.split_once(*open)?;
        let (unit, _) = rest.split_once(*close)?;
        Some((stem, unit)).filter(|(_, unit)| is_unit(unit))
    });
    // `Current A` and `I_V` are phases, not units.
    let is_whole = bracketed.is_none() && aliases::is_known(name);
    let split =
        |(stem, unit): (&'n str, &'n str)| (!is_whole && is_unit(unit)).then_some((stem, unit));
    let named = bracketed
        .or_else(|| name.split_once(" in ").and_then(split))
        .or_else(|| name.split_once('/').and_then(split))
        .or_else(|| name.rsplit_once(", ").and_then(split))
        .or_else(|| name.rsplit_once(' ').and_then(split))
        .or_else(|| {
            let ends = SUFFIXES.iter();
            let of = |end: &&'static str| Some((name.strip_suffix(*end)?, &end[1..]));
            ends.filter(|_| !is_whole).find_map(of)
        });
    match named {
        Some((stem, unit)) if !stem.trim().is_empty() => {
            let unit = if unit == "rad_s" { "rad/s" } else { unit };
            (stem.trim(), Some(unit.trim().to_owned()))
        }
        _ => (name, None),
    }
}

/// A name from a file, cut to what fits a message.
pub(super) fn shown(name: &str) -> String {
    name.chars().take(40).filter(|c| !c.is_control()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_may_stand_in_the_name() {
        for (name, stem, unit) in [
            ("Ua [V]", "Ua", Some("V")),
            ("I1 (mA)", "I1", Some("mA")),
            ("Time(s)", "Time", Some("s")),
            ("n [1/min]", "n", Some("1/min")),
            ("Drehzahl in U/min", "Drehzahl", Some("U/min")),
            ("U1/V", "U1", Some("V")),
            ("speed_rpm", "speed_rpm", None),
            ("motor_speed_rpm", "motor_speed", Some("rpm")),
            ("speed (probe 2)", "speed (probe 2)", None),
            ("ia", "ia", None),
            ("Current A", "Current A", None),
            ("I_A", "I_A", None),
            ("U_V", "U_V", None),
            ("I1 A", "I1", Some("A")),
            ("I_u_A", "I_u", Some("A")),
            ("Time / s", "Time", Some("s")),
            ("[V]", "[V]", None),
        ] {
            assert_eq!(
                name_and_unit(name),
                (stem, unit.map(str::to_owned)),
                "{name}"
            );
        }
    }
}
