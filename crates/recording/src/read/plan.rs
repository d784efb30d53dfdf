//! Which column of a file becomes which channel.

use super::header::{Header, Unreadable, shown};
use crate::data::channel::{Channel, Signal};
use crate::data::units::Unit;
use crate::error::{Error, Problem};
use crate::mapping::{Mapping, Origin, Target};
use crate::suggest::closest;
use std::collections::BTreeMap;

/// The columns of a file by target.
#[derive(Debug)]
pub(crate) struct Plan {
    /// Column index by target.
    pub columns: BTreeMap<Target, usize>,
    /// Whether `va vb vc` hold v_ab, v_bc, v_ca.
    pub line_voltages: bool,
    /// The user's mapping, completed by the units that the file declares.
    pub mapping: Mapping,
    /// What had to be assumed, one sentence each.
    pub notes: Vec<String>,
}

/// Names that are taken for line voltages without being told.
const LINE: [(&str, Signal); 3] = [
    ("vab", Signal::Va),
    ("vbc", Signal::Vb),
    ("vca", Signal::Vc),
];

impl Plan {
    /// Assigns columns to targets: the mapping first, then the columns of known names.
    pub fn new(header: &Header, mapping: &Mapping) -> Result<Plan, Error> {
        refuse_unreadable(header, mapping)?;
        let (file, line, units) = (&header.file, header.line, &header.units);
        let mut notes = header.notes.clone();
        notes.extend(header.unreadable.iter().map(Unreadable::note));
        let header = &header.names;
        let mut plan = Plan {
            columns: BTreeMap::new(),
            line_voltages: mapping.line_voltages.unwrap_or(false),
            mapping: mapping.clone(),
            notes,
        };
        plan.assign_mapped(file, line, header, mapping)?;
        plan.assign_named(header);
        plan.assign_line_voltages(header);
        plan.require_mapped(file, line, mapping)?;
        plan.adopt_units(file, line, header, units)?;
        plan.note_conversions(header);
        plan.account_for_the_rest(file, line, header)?;
        Ok(plan)
    }

    fn assign_mapped(
        &mut self,
        file: &str,
        line: u64,
        header: &[String],
        mapping: &Mapping,
    ) -> Result<(), Error> {
        for (target, map) in &mapping.columns {
            let Some(name) = &map.name else { continue };
            let Some(column) = header.iter().position(|column| column == name) else {
                let remedy = match closest(name, header.iter().map(String::as_str)) {
                    Some(meant) => format!("did you mean `{}`?", shown(meant)),
                    None => format!("the file has {}", list(header)),
                };
                let message =
                    format!("{target} is mapped to `{name}`, which the file does not have");
                return Err(Error::at(file, line, name, message, remedy));
            };
            if self.columns.values().any(|&taken| taken == column) {
                let message = "is mapped to two channels";
                return Err(Error::at(
                    file,
                    line,
                    name,
                    message,
                    "map it to one of them",
                ));
            }
            self.columns.insert(*target, column);
        }
        Ok(())
    }

    fn assign_named(&mut self, header: &[String]) {
        for (column, name) in header.iter().enumerate() {
            let Some(target) = Target::parse(name) else {
                continue;
            };
            if !self.columns.contains_key(&target) && !self.is_taken(column) {
                self.columns.insert(target, column);
            }
        }
    }

    fn assign_line_voltages(&mut self, header: &[String]) {
        let phase = Channel::VOLTAGES.map(Target::Channel);
        if phase.iter().any(|target| self.columns.contains_key(target)) {
            return;
        }
        let found = LINE.iter().filter_map(|(name, signal)| {
            let column = header.iter().position(|column| column == name)?;
            Some((Target::Channel(Channel::first(*signal)), column))
        });
        let found: Vec<_> = found.collect();
        if found.len() >= 2 {
            self.columns.extend(found);
            self.line_voltages = true;
        }
    }

    /// A unit or scale for a channel that no column feeds is a slip.
    fn require_mapped(&self, file: &str, line: u64, mapping: &Mapping) -> Result<(), Error> {
        let lost = |target: &&Target| {
            !self.columns.contains_key(target) && !self.replaced(target, mapping)
        };
        match mapping.columns.keys().find(lost) {
            None => Ok(()),
            Some(target) => {
                let message = format!(
                    "a unit, scale, offset or delay is given for {target}, which the file does not have"
                );
                let remedy = format!("say which column it is: --column {target}=NAME");
                Err(Error::at(file, line, &target.to_string(), message, remedy))
            }
        }
    }

    fn replaced(&self, target: &Target, mapping: &Mapping) -> bool {
        *target == Target::Time && mapping.sample_rate_hz.is_some()
    }

    /// A unit that the file declares holds where the user says nothing.
    fn adopt_units(
        &mut self,
        file: &str,
        line: u64,
        header: &[String],
        units: &[Option<String>],
    ) -> Result<(), Error> {
        for (target, &column) in &self.columns {
            let Some(name) = units.get(column).and_then(Option::as_ref) else {
                continue;
            };
            let said = self.mapping.columns.get(target);
            if said.is_some_and(|map| map.unit.is_some()) {
                continue;
            }
            let unit = Unit::declared(target.quantity(), name).map_err(|known| {
                foreign_unit(file, line, *target, &header[column], name, &known)
            })?;
            if unit != Unit::si(target.quantity()) {
                let map = self.mapping.entry(*target);
                map.unit = Some(unit);
                if (&map.name, map.scale, map.offset) == (&None, None, None) {
                    map.origin = Origin::File;
                }
            }
        }
        Ok(())
    }

    fn note_conversions(&mut self, header: &[String]) {
        for (target, map) in &self.mapping.columns {
            let Some(&column) = self.columns.get(target) else {
                continue;
            };
            self.notes
                .extend(map.sentence(*target, &shown(&header[column])));
        }
        if self.line_voltages {
            self.notes.push(
                "va vb vc are computed from line voltages, without a zero sequence, user's assumption"
                    .to_owned(),
            );
        }
    }

    /// Columns that feed nothing are named; one that looks misspelt is an error.
    fn account_for_the_rest(
        &mut self,
        file: &str,
        line: u64,
        header: &[String],
    ) -> Result<(), Error> {
        let absent: Vec<String> = Target::all()
            .filter(|target| !self.columns.contains_key(target))
            .map(|target| target.to_string())
            .collect();
        let unused = header
            .iter()
            .enumerate()
            .filter(|(column, _)| !self.is_taken(*column));
        let (mut notes, mut problems) = (Vec::new(), Vec::new());
        for (_, name) in unused {
            let absent = absent.iter().map(String::as_str);
            match closest(name, absent).filter(|_| Target::parse(name).is_none()) {
                Some(meant) => problems.push(misspelt(file, line, name, meant)),
                None => notes.push(format!("column {} is not used", shown(name))),
            }
        }
        self.notes.extend(notes);
        match problems.is_empty() {
            true => Ok(()),
            false => Err(Error::of(problems)),
        }
    }

    fn is_taken(&self, column: usize) -> bool {
        self.columns.values().any(|&taken| taken == column)
    }
}

/// A channel whose column is there and cannot be read is not an absent one.
fn refuse_unreadable(header: &Header, mapping: &Mapping) -> Result<(), Error> {
    let wanted = |one: &&Unreadable| is_wanted(&one.name, header, mapping);
    match header.unreadable.iter().find(wanted) {
        None => Ok(()),
        Some(one) => {
            let message = format!("cannot be read: {}", one.why);
            Err(header.error(&shown(&one.name), message, one.remedy))
        }
    }
}

/// Whether a channel, the clock or a line voltage is to be read from the column of this name.
fn is_wanted(name: &str, header: &Header, mapping: &Mapping) -> bool {
    let has = |name: &str| header.names.iter().any(|other| other == name);
    let named = |target: &Target| {
        mapping
            .columns
            .get(target)
            .and_then(|map| map.name.as_ref())
    };
    if mapping
        .columns
        .values()
        .any(|map| map.name.as_deref() == Some(name))
    {
        return true;
    }
    match Target::parse(name) {
        Some(Target::Time) if mapping.sample_rate_hz.is_some() => false,
        Some(target) => named(&target).is_none(),
        None => {
            let phases = Channel::VOLTAGES.map(Target::Channel);
            let phase = |target: &Target| has(&target.to_string()) || named(target).is_some();
            LINE.iter().any(|(line, _)| *line == name) && !phases.iter().any(phase)
        }
    }
}

fn foreign_unit(
    file: &str,
    line: u64,
    target: Target,
    column: &str,
    unit: &str,
    known: &str,
) -> Error {
    let message = format!(
        "the file declares `{}`, which is not a unit of {target}",
        shown(unit)
    );
    let remedy = format!("say what the numbers are: --unit {target}=UNIT, one of {known}");
    Error::at(file, line, &shown(column), message, remedy)
}

fn misspelt(file: &str, line: u64, name: &str, meant: &str) -> Problem {
    let name = shown(name);
    let remedy =
        format!("did you mean `{meant}`? Rename the column, or add --column {meant}={name}");
    Problem {
        file: file.to_owned(),
        line,
        field: name,
        message: "is not a known column".to_owned(),
        remedy,
    }
}

/// Column names for a message.
pub(crate) fn list(header: &[String]) -> String {
    let names: Vec<String> = header.iter().take(20).map(|name| shown(name)).collect();
    names.join(" ")
}
