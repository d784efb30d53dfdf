//! Stretches of a recording of any length, read twice: once to look at all of it, once to take what was chosen.

use audit::{Audit, Expectation, Merger, audit, with_sound_probes};
use motor::MotorFile;
use motor::effect::{Cut, Rated};
use recording::{LoadTorque, Recording};

use super::Stretch;
use super::cells::Cells;
use super::chosen::{Budget, Role, StretchReport, Wanted, chosen};
use super::cut::cut;
use crate::data::case::Waveform;
use crate::data::unsupported::Unsupported;

/// The first look at a recording: its pieces in the order of time, of which none is kept.
pub struct Survey {
    expectation: Expectation,
    merger: Merger,
    cells: Cells,
    budget: Budget,
    name: String,
    begin_s: f64,
    end_s: f64,
}

/// What is to be read again.
pub struct Choice {
    excerpt: Excerpt,
    wanted: Vec<Wanted>,
}

/// The second look: takes what was chosen.
pub struct Gathering {
    choice: Choice,
    /// Rows so far.
    rows: usize,
    /// What is there of the stretches that are not complete, in the order of `wanted`.
    found: Vec<Vec<Recording>>,
}

/// Stretches of a long recording, with what is known of all of it.
#[derive(Clone, Debug)]
pub struct Excerpt {
    /// The recording.
    pub name: String,
    /// Audit of all of it.
    pub audit: Audit,
    /// Its length, s.
    pub duration_s: f64,
    /// What was taken, in the order of time.
    pub stretches: Vec<StretchReport>,
    begin_s: f64,
    t_sample: f64,
    parts: Vec<Part>,
}

/// A stretch with the samples around it.
#[derive(Clone, Debug)]
struct Part {
    recording: Recording,
    stretch: Stretch,
    theta_mech: f64,
    told: StretchReport,
}

impl Survey {
    /// Before the first piece.
    pub fn new(motor: &MotorFile, budget: Budget) -> Self {
        Self {
            expectation: Expectation::from(motor),
            merger: Merger::default(),
            cells: Cells::new(budget.stretch_s),
            budget,
            name: String::new(),
            begin_s: f64::NAN,
            end_s: f64::NAN,
        }
    }

    /// Takes the next piece.
    pub fn take(&mut self, piece: &Recording) {
        let audit = audit(piece, &self.expectation);
        let is_usable = self.merger.add(piece, &audit);
        self.cells.take(piece, is_usable);
        if self.begin_s.is_nan() {
            piece.name().clone_into(&mut self.name);
            self.begin_s = piece.t()[0];
        }
        self.end_s = piece.t()[piece.len() - 1];
    }

    /// What is taken of the recording.
    pub fn choose(self) -> Choice {
        let wanted = chosen(&self.cells, self.budget);
        let mut audit = self.merger.finish();
        let stretches: Vec<_> = wanted.iter().map(|one| one.told.clone()).collect();
        let duration_s = self.end_s - self.begin_s;
        audit.assumptions.push(told(&stretches, duration_s));
        Choice {
            excerpt: Excerpt {
                name: self.name,
                audit,
                duration_s,
                stretches,
                begin_s: self.begin_s,
                t_sample: self.cells.t_sample,
                parts: Vec::new(),
            },
            wanted,
        }
    }
}

impl Gathering {
    /// Before the first piece of the second reading.
    pub fn new(choice: Choice) -> Self {
        Self {
            found: vec![Vec::new(); choice.wanted.len()],
            rows: 0,
            choice,
        }
    }

    /// Takes what was chosen of the next piece.
    ///
    /// # Errors
    /// Of the recording: none where it is the one that was surveyed.
    pub fn take(&mut self, piece: &Recording) -> Result<(), recording::Error> {
        let rows = self.rows..self.rows + piece.len();
        self.rows = rows.end;
        for (found, wanted) in self.found.iter_mut().zip(&self.choice.wanted) {
            let from = wanted.rows.start.max(rows.start);
            let to = wanted.rows.end.min(rows.end);
            // A single sample beyond the border of two pieces is one of those around a stretch.
            if from + 1 < to {
                found.push(piece.slice(from - rows.start..to - rows.start)?);
            }
            if rows.end >= wanted.rows.end && found.len() > 1 {
                *found = vec![Recording::of_parts(found)?];
            }
        }
        Ok(())
    }

    /// What was taken.
    pub fn finish(self) -> Excerpt {
        let Choice { excerpt, wanted } = self.choice;
        let parts = wanted.into_iter().zip(self.found);
        let parts = parts.filter_map(|(wanted, mut found)| {
            let recording = found.pop()?.with_t_sample(excerpt.t_sample);
            // Samples that were left out at a border are missing at the begin or at the end.
            let missing = wanted.rows.len().saturating_sub(recording.len());
            let stretch = Stretch {
                samples: wanted.stretch.start.saturating_sub(missing)
                    ..wanted.stretch.end.min(recording.len()),
                settles: wanted.settles,
            };
            (stretch.samples.len() > stretch.settles).then_some(Part {
                recording,
                stretch,
                theta_mech: wanted.theta_mech,
                told: wanted.told,
            })
        });
        Excerpt {
            parts: parts.collect(),
            ..excerpt
        }
    }
}

impl Excerpt {
    /// Whether stretches of it prove.
    pub fn proves(&self) -> bool {
        self.parts.iter().any(|part| part.told.role == Role::Proves)
    }

    /// Whether the recording holds the torque at the shaft.
    pub fn measures_torque(&self) -> bool {
        self.parts.first().is_some_and(|part| {
            let recording = &part.recording;
            recording.torque().is_some() && recording.metadata.load_torque != LoadTorque::Friction
        })
    }

    /// The stretch at a time, s since the first sample, or the first one, with the samples around it.
    pub fn around(&self, t_s: f64) -> Option<&Recording> {
        let holds = |part: &&Part| (part.told.from_s..part.told.to_s).contains(&t_s);
        let part = self.parts.iter().find(holds).or(self.parts.first());
        part.map(|part| &part.recording)
    }

    /// Its stretches of a role as one case, and which of them that are: one that is not made like the first is left out.
    ///
    /// # Errors
    /// No stretch that can be judged, and what [`Waveform::new`] refuses.
    pub fn case(
        &self,
        role: Role,
        rated: &Rated<f64>,
    ) -> Result<(Waveform, Vec<StretchReport>), Unsupported> {
        let mut used: Vec<StretchReport> = Vec::new();
        let mut all: Option<Waveform> = None;
        let mut refused = None;
        for part in self.parts.iter().filter(|part| part.told.role == role) {
            let joined = match (part.case(&self.audit, self.begin_s, rated), all.take()) {
                (Ok((case, at)), None) => Ok(case.beginning(at)),
                (Ok((case, at)), Some(before)) => before.joined_at(case, at),
                (Err(why), before) => {
                    refused = refused.or(Some(why));
                    all = before;
                    continue;
                }
            };
            if joined.is_ok() {
                used.push(part.told.clone());
            }
            all = Some(joined.unwrap_or_else(|apart| apart.0));
        }
        let none = || {
            Unsupported::new(
                "no two seconds of the recording are sampled evenly and can be judged",
                "see the audit; cut the recording where it is sound",
            )
        };
        let all = all.ok_or_else(|| refused.unwrap_or_else(none))?;
        Ok((all, used))
    }
}

impl Part {
    /// The stretch as a case, and where it begins in the recording.
    fn case(
        &self,
        audit: &Audit,
        begin_s: f64,
        rated: &Rated<f64>,
    ) -> Result<(Waveform, Cut), Unsupported> {
        let recording = with_sound_probes(&self.recording, audit);
        let t = recording.t()[self.stretch.samples.start];
        let whole = Waveform::new(&recording, rated)?;
        let mut case = cut(&whole, rated, std::slice::from_ref(&self.stretch));
        if case.measured.is_empty() {
            return Err(Unsupported::new(
                "a stretch holds no whole block",
                "record more of it",
            ));
        }
        self.turn(&mut case);
        let at = Cut {
            sample: 0,
            t: t - begin_s,
            is_new: false,
        };
        Ok((case, at))
    }

    /// Gives the shaft the angle that it has in the recording.
    fn turn(&self, case: &mut Waveform) {
        let timeline = std::sync::Arc::make_mut(&mut case.timeline);
        let judged = self.stretch.settles * case.finer;
        let Some(there) = timeline.theta_mech.get(judged).copied() else {
            return;
        };
        let ahead = self.theta_mech - there;
        timeline
            .theta_mech
            .iter_mut()
            .for_each(|theta| *theta += ahead);
    }
}

/// Which stretches are used, in words.
fn told(stretches: &[StretchReport], duration_s: f64) -> String {
    let seconds = |role: Role| -> f64 {
        let of = stretches.iter().filter(|one| one.role == role);
        of.map(|one| one.to_s - one.from_s).sum()
    };
    let proving = match seconds(Role::Proves) {
        0.0 => String::new(),
        seconds => format!(" and {seconds:.0} s that were not fitted prove"),
    };
    format!(
        "of the {duration_s:.0} s {:.0} s are fitted or compared{proving}: stretches that differ in load, speed, voltage and time",
        seconds(Role::Fitted)
    )
}

#[cfg(test)]
mod tests;
