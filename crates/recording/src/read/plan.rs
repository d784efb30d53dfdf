//! Which column of a file becomes which channel.

use super::csv_file::shown;
use crate::channel::{Channel, Signal};
use crate::error::Error;
use crate::mapping::{Mapping, Target};
use crate::suggest::closest;
use std::collections::BTreeMap;

/// The columns of a file by target.
#[derive(Debug)]
pub(crate) struct Plan {
    /// Column index by target.
    pub columns: BTreeMap<Target, usize>,
    /// Whether `va vb vc` hold v_ab, v_bc, v_ca.
    pub line_voltages: bool,
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
    pub fn new(file: &str, line: u64, header: &[String], mapping: &Mapping) -> Result<Plan, Error> {
        let mut plan = Plan {
            columns: BTreeMap::new(),
            line_voltages: mapping.line_voltages.unwrap_or(false),
            notes: Vec::new(),
        };
        plan.assign_mapped(file, line, header, mapping)?;
        plan.assign_named(header);
        plan.assign_line_voltages(header);
        plan.require_mapped(file, line, mapping)?;
        plan.note_conversions(header, mapping);
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
                    "a unit, scale or offset is given for {target}, which the file does not have"
                );
                let remedy = format!("say which column it is: --column {target}=NAME");
                Err(Error::at(file, line, &target.to_string(), message, remedy))
            }
        }
    }

    fn replaced(&self, target: &Target, mapping: &Mapping) -> bool {
        *target == Target::Time && mapping.sample_rate_hz.is_some()
    }

    fn note_conversions(&mut self, header: &[String], mapping: &Mapping) {
        for (target, map) in &mapping.columns {
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
        let mut notes = Vec::new();
        for (_, name) in unused {
            let absent = absent.iter().map(String::as_str);
            match closest(name, absent).filter(|_| Target::parse(name).is_none()) {
                Some(meant) => return Err(misspelt(file, line, name, meant)),
                None => notes.push(format!("column {} is not used", shown(name))),
            }
        }
        self.notes.extend(notes);
        Ok(())
    }

    fn is_taken(&self, column: usize) -> bool {
        self.columns.values().any(|&taken| taken == column)
    }
}

fn misspelt(file: &str, line: u64, name: &str, meant: &str) -> Error {
    let name = shown(name);
    let remedy =
        format!("did you mean `{meant}`? Rename the column, or add --column {meant}={name}");
    Error::at(file, line, &name, "is not a known column", remedy)
}

/// Column names for a message.
pub(crate) fn list(header: &[String]) -> String {
    let names: Vec<String> = header.iter().take(20).map(|name| shown(name)).collect();
    names.join(" ")
}
