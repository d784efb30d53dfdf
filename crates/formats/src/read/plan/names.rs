//! Columns that are found by their order or by their names.

use super::Plan;
use super::words::could_both;
use crate::read::aliases::{self, Three};
use crate::read::header::{Header, shown};
use recording::{Channel, Error, Factor, Mapping, Origin, Said, Signal, Slot, Target, Unit};

impl Plan {
    /// The columns in the order that the user says.
    pub(super) fn assign_listed(
        &mut self,
        header: &Header,
        mapping: &Mapping,
    ) -> Result<(), Error> {
        let Some(Said {
            what: names,
            origin,
        }) = &mapping.names
        else {
            return Ok(());
        };
        if names.len() > header.names.len() {
            let (said, has) = (names.len(), header.names.len());
            let message = format!("--columns names {said} columns, the file has {has}");
            let remedy = "name them in their order, with `-` for one that is not used";
            return Err(header.error("", message, remedy));
        }
        let slots = names.iter().enumerate();
        for (column, slot) in slots.filter_map(|(k, name)| Some((k, Slot::parse(name)?))) {
            self.assign(slot.target, column, slot.line);
            self.notes.push(format!(
                "{} is {}, {}",
                shown(&header.names[column]),
                names[column],
                origin.words()
            ));
        }
        Ok(())
    }

    fn assign(&mut self, target: Target, column: usize, line: Option<bool>) {
        self.columns.insert(target, column);
        self.line_voltages |= line.is_some();
        if line == Some(true) {
            let map = self.mapping.entry(target);
            let factor = match map.scale {
                Some(Factor::Known(factor)) => factor,
                _ => 1.0,
            };
            map.scale = Some(Factor::Known(-factor));
        }
    }

    /// Columns that have another recorder's names, where no column has ours.
    pub(super) fn assign_aliases(&mut self, header: &Header) -> Result<(), Error> {
        for signals in [Channel::VOLTAGES, Channel::CURRENTS] {
            let taken = |channel: &Channel| self.columns.contains_key(&Target::Channel(*channel));
            if !signals.iter().any(taken) {
                self.assign_three(header, signals)?;
            }
        }
        let singles: Vec<(usize, Target)> = (0..header.names.len())
            .filter(|column| !self.is_taken(*column))
            .filter_map(|column| Some((column, single(header, column)?)))
            .filter(|(_, target)| {
                !self.columns.contains_key(target) && !self.replaced(target, &self.mapping)
            })
            .collect();
        for (k, (column, target)) in singles.iter().enumerate() {
            if let Some((other, _)) = singles[..k].iter().find(|(_, same)| same == target) {
                return Err(could_both(header, &[*other, *column], &target.to_string()));
            }
            self.assign(*target, *column, None);
            self.note_alias(header, *column, &target.to_string());
            if let Some(unit) = aliases::unit_in(&header.stems[*column]) {
                let map = self.mapping.entry(*target);
                map.origin = Origin::File;
                map.unit = map.unit.or(Unit::declared(target.quantity(), unit).ok());
            }
        }
        Ok(())
    }

    fn assign_three(&mut self, header: &Header, channels: [Channel; 3]) -> Result<(), Error> {
        let sets: Vec<Three> = aliases::threes(&header.stems)
            .into_iter()
            .filter(|three| three.signals == channels.map(|channel| channel.signal))
            .collect();
        let phases = sets.iter().filter(|three| !three.is_line);
        let phases: Vec<&Three> = phases.collect();
        let candidates = if phases.is_empty() {
            sets.iter().collect()
        } else {
            phases
        };
        let Some(first) = candidates.first() else {
            return Ok(());
        };
        if let Some(other) = candidates.get(1) {
            let both = [first, other].map(|three| three.columns.iter().flatten().map(|(k, _)| *k));
            let both: Vec<usize> = both.into_iter().flatten().collect();
            return Err(could_both(header, &both, &channels[0].to_string()));
        }
        for (channel, column) in channels.into_iter().zip(first.columns) {
            let Some((column, is_reversed)) = column.filter(|(column, _)| !self.is_taken(*column))
            else {
                continue;
            };
            self.assign(
                Target::Channel(channel),
                column,
                first.is_line.then_some(is_reversed),
            );
            let name = match (first.is_line, is_reversed) {
                (true, _) => line_name(channel, is_reversed),
                (false, _) => channel.to_string(),
            };
            self.note_alias(header, column, &name);
        }
        Ok(())
    }

    fn note_alias(&mut self, header: &Header, column: usize, name: &str) {
        let note = format!(
            "column {} is {name}, by its name",
            shown(&header.names[column])
        );
        self.notes.push(note);
    }

    pub(super) fn assign_named(&mut self, header: &[String]) {
        for (column, name) in header.iter().enumerate() {
            let Some(target) = Target::parse(name) else {
                continue;
            };
            if !self.columns.contains_key(&target) && !self.is_taken(column) {
                self.columns.insert(target, column);
            }
        }
    }

    pub(super) fn assign_line_voltages(&mut self, stems: &[String]) {
        let phase = Channel::VOLTAGES.map(Target::Channel);
        if phase.iter().any(|target| self.columns.contains_key(target)) {
            return;
        }
        let slots = stems.iter().enumerate().filter_map(|(column, stem)| {
            let slot = Slot::parse(stem)?;
            slot.line
                .map(|is_reversed| (slot.target, column, is_reversed))
        });
        let found: Vec<_> = slots.collect();
        if found.len() >= 2 {
            for (target, column, is_reversed) in found {
                self.assign(target, column, Some(is_reversed));
            }
        }
    }
}

/// The single channel that a column means by its name and unit.
fn single(header: &Header, column: usize) -> Option<Target> {
    let unit = header.units.get(column).and_then(Option::as_deref);
    let has_unit_of =
        |target: Target| unit.is_some_and(|unit| Unit::declared(target.quantity(), unit).is_ok());
    aliases::single(&header.stems[column], has_unit_of)
}

/// The name of the line voltage that is kept where a phase voltage is.
fn line_name(channel: Channel, is_reversed: bool) -> String {
    let [first, second] = match channel.signal {
        Signal::Va => ["a", "b"],
        Signal::Vb => ["b", "c"],
        _ => ["c", "a"],
    };
    if is_reversed {
        format!("v{second}{first}")
    } else {
        format!("v{first}{second}")
    }
}
