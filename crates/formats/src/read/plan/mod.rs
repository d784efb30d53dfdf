//! Which column of a file becomes which channel.

mod names;
mod words;

pub(crate) use words::list;
use words::{called, foreign_unit, misspelt};

use crate::read::header::{Header, Unreadable, shown};
use recording::{Channel, Error, Mapping, Origin, Slot, Target, Unit, closest};
use std::collections::BTreeMap;

/// The columns of a file by target.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Column index by target.
    pub columns: BTreeMap<Target, usize>,
    /// Whether `va vb vc` hold v_ab, v_bc, v_ca.
    pub line_voltages: bool,
    /// Whether the file itself says the rate.
    pub rate_is_declared: bool,
    /// The user's mapping, completed by the units that the file declares.
    pub mapping: Mapping,
    /// The same with every column named: what a sidecar would say.
    pub reading: Mapping,
    /// What had to be assumed, one sentence each.
    pub notes: Vec<String>,
}

impl Plan {
    /// Assigns columns to targets: the mapping first, then the columns of known names.
    pub fn new(header: &Header, mapping: &Mapping) -> Result<Plan, Error> {
        refuse_unreadable(header, mapping)?;
        let (file, line, units) = (&header.file, header.line, &header.units);
        let mut notes = header.notes.clone();
        notes.extend(header.unreadable.iter().map(Unreadable::note));
        let whole = header;
        let header = &header.names;
        let mut plan = Plan {
            columns: BTreeMap::new(),
            line_voltages: mapping.line_voltages.unwrap_or(false),
            rate_is_declared: false,
            mapping: mapping.clone(),
            reading: Mapping::default(),
            notes,
        };
        plan.assign_listed(whole, mapping)?;
        plan.assign_mapped(file, line, header, &whole.stems, mapping)?;
        if mapping.names.is_none() {
            plan.assign_named(&whole.stems);
            plan.assign_line_voltages(&whole.stems);
            plan.assign_aliases(whole)?;
        }
        plan.assign_sensors();
        plan.require_mapped(file, line, mapping)?;
        plan.adopt_units(file, line, header, units)?;
        plan.reading = plan.resolved(header);
        plan.note_conversions(header);
        plan.note_remarks(whole);
        plan.account_for_the_rest(file, line, header)?;
        Ok(plan)
    }

    /// Sensors of all voltages or currents, where a column has none of its own.
    fn assign_sensors(&mut self) {
        let channels: Vec<Target> = self.columns.keys().copied().collect();
        for target in channels {
            let Some(said) = self.mapping.sensors.get(&target.quantity()).cloned() else {
                continue;
            };
            let is_new = !self.mapping.columns.contains_key(&target);
            let map = self.mapping.entry(target);
            map.sensor = map.sensor.take().or(Some(said.what));
            if is_new {
                map.origin = said.origin;
            }
        }
    }

    fn resolved(&self, header: &[String]) -> Mapping {
        let mut reading = self.mapping.clone();
        reading.sidecar = None;
        reading.line_voltages = self.line_voltages.then_some(true);
        for (target, column) in &self.columns {
            let name = &header[*column];
            if reading.names.is_none() && *name != target.to_string() {
                reading.entry(*target).name = Some(name.clone());
            }
        }
        reading
    }

    /// What the cells of the used columns take to be read.
    fn note_remarks(&mut self, header: &Header) {
        let time = self.columns.get(&Target::Time);
        let remark = time.and_then(|column| header.remarks[*column].clone());
        self.notes.extend(remark);
    }

    fn assign_mapped(
        &mut self,
        file: &str,
        line: u64,
        header: &[String],
        stems: &[String],
        mapping: &Mapping,
    ) -> Result<(), Error> {
        for (target, map) in &mapping.columns {
            let Some(name) = &map.name else { continue };
            let by_stem = |(column, stem): (usize, &String)| {
                (stem == name && !header.contains(name)).then_some(column)
            };
            let named = header.iter().position(|column| column == name);
            let Some(column) = named.or_else(|| stems.iter().enumerate().find_map(by_stem)) else {
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
            let holds = said.map_or(target.quantity(), |map| map.raw(target.quantity()));
            let unit = Unit::declared(holds, name).map_err(|known| {
                foreign_unit(file, line, *target, &header[column], name, &known)
            })?;
            if unit != Unit::si(holds) {
                let map = self.mapping.entry(*target);
                map.unit = Some(unit);
                if (&map.name, map.scale, map.offset, &map.sensor) == (&None, None, None, &None) {
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
        let is_listed = self.mapping.names.is_some();
        for (_, name) in unused {
            let absent = absent.iter().map(String::as_str).filter(|_| !is_listed);
            match closest(name, absent).filter(|_| Target::parse(name).is_none()) {
                Some(meant) => problems.push(misspelt(file, line, name, meant)),
                None => notes.push(format!("{} is not used", called(name))),
            }
        }
        self.notes.extend(notes);
        match problems.is_empty() {
            true => Ok(()),
            false => Err(Error::of(problems)),
        }
    }

    /// Whether the rows have times: a column of them, or a rate.
    pub fn has_clock(&self) -> bool {
        self.columns.contains_key(&Target::Time) || self.mapping.sample_rate_hz.is_some()
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
            Slot::parse(name).is_some() && !phases.iter().any(phase)
        }
    }
}
