//! A file of which header, sidecar and flags were read, and not yet its samples.

use super::convert::finish;
use super::header::Header;
use super::plan::{self, Plan};
use super::samples::{Extent, Piece, gather};
use super::table::{self, Kind};
use super::table_file::TableFile;
use super::text::source::Progress;
use recording::{Error, Follows, Mapping, Metadata, Recording, Sidecar, Source, Target};

/// An open file.
pub(super) struct Opened {
    file: Box<dyn TableFile>,
    metadata: Metadata,
    mapping: Mapping,
}

impl Opened {
    /// `flags` win over the sidecar; `open` gets both.
    pub fn new(
        sidecar: Sidecar,
        flags: &Mapping,
        open: impl FnOnce(&Mapping) -> Result<Box<dyn TableFile>, Error>,
    ) -> Result<Opened, Error> {
        let mapping = flags.clone().over(sidecar.mapping);
        Ok(Opened {
            file: open(&mapping)?,
            metadata: sidecar.metadata,
            mapping,
        })
    }

    /// All that the file holds.
    pub fn whole(mut self, progress: &mut dyn FnMut(Progress)) -> Result<Source, Error> {
        let file = &mut *self.file;
        if table::kind(file.header(), &self.mapping)? == Kind::LoadTable {
            return table::load_table(file, progress).map(Source::LoadTable);
        }
        let mut plan = planned(file, &self.mapping)?;
        let all = gather(
            file,
            &plan,
            Extent::Whole,
            progress,
            &mut |_| Ok(Vec::new()),
        )?;
        plan.notes.extend(file.notes());
        finish::piece(&file.header().file, all, plan, self.metadata).map(Source::Recording)
    }

    /// A recording in pieces, of which the last one comes back; a load table as a whole.
    pub fn in_pieces<E: From<Error>>(
        mut self,
        rows: usize,
        progress: &mut dyn FnMut(Progress),
        take: &mut dyn FnMut(&Recording, Follows) -> Result<(), E>,
    ) -> Result<Source, E> {
        let file = &mut *self.file;
        if table::kind(file.header(), &self.mapping)? == Kind::LoadTable {
            return Ok(Source::LoadTable(table::load_table(file, progress)?));
        }
        let mut plan = planned(file, &self.mapping)?;
        let name = file.header().file.clone();
        let mut failed = None;
        let mut give = |piece: Piece| {
            let piece = finish::piece(&name, piece, plan.clone(), self.metadata.clone())?;
            take(&piece, Follows::Piece).map_err(|error| {
                failed = Some(error);
                // Ends the reading; `failed` is what is told.
                Error::bad(&name, "a piece was refused", "see above")
            })?;
            Ok(piece.into_buffers().collect())
        };
        let last = gather(file, &plan, Extent::Rows(rows), progress, &mut give);
        let last = match (failed, last) {
            (Some(error), _) => return Err(error),
            (None, last) => last?,
        };
        plan.notes.extend(file.notes());
        let last = finish::piece(&name, last, plan, self.metadata)?;
        take(&last, Follows::Nothing)?;
        Ok(Source::Recording(last))
    }
}

fn planned(file: &dyn TableFile, mapping: &Mapping) -> Result<Plan, Error> {
    let mut plan = Plan::new(file.header(), mapping)?;
    let rate = file.header().rate.as_ref().filter(|_| !plan.has_clock());
    if let Some(rate) = rate {
        plan.mapping.sample_rate_hz = Some(rate.hz);
        plan.rate_is_declared = true;
        plan.notes.push(rate.note.clone());
    }
    plan_is_sufficient(file.header(), &plan)?;
    plan.reading.sample_rate_hz = plan.mapping.sample_rate_hz;
    plan.reading = plan.reading.over(file.layout());
    Ok(plan)
}

pub(super) fn plan_is_sufficient(header: &Header, plan: &Plan) -> Result<(), Error> {
    let electrical = |target: &Target| matches!(target, Target::Channel(c) if c.is_electrical());
    if !plan.columns.keys().any(electrical) {
        let names = plan::list(&header.names);
        let message = format!("has neither currents nor voltages among {names}");
        let remedy = "name the columns ia ib ic, va vb vc, or map them: --column ia=NAME, or all in their order: --columns t,va,vb,-,ia";
        return Err(header.error("", message, remedy));
    }
    if !plan.has_clock() {
        let message = "the file has no clock";
        let remedy =
            "name the time column t, map it with --column t=NAME, or declare --sample-rate HZ";
        return Err(header.error("t", message, remedy));
    }
    Ok(())
}
