//! What lies on the workbench.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard};

use audit::{Audit, Expectation, audit};
use recording::Source;
use replay::check::{BlindSpot, channels_missing};
use serde::{Deserialize, Serialize};
use tempfile::TempDir;

use super::known::{CheckView, Checked};
use super::motors::{self, Motor, MotorView};
use super::slot::{Slot, SlotView};
use super::upload::Budget;
use crate::running::session::Session;
use crate::running::shared::{Refusal, locked};

/// The recording that is fitted, and the one that proves.
pub(super) const SLOTS: usize = 2;

/// Numbers of all recordings on the desk: twelve minutes of six channels at 10 kHz.
const MOST_NUMBERS: u64 = 50_000_000;

/// A question that can be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    /// Where the model fails.
    Compare,
    /// Which physics it misses.
    Explain,
    /// Add an effect.
    Adopt,
    /// Whether the motor is in good order.
    Check,
}

/// How far the question is.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Job {
    /// Counts up with every question.
    pub id: u64,
    /// What was asked last.
    pub kind: Option<Kind>,
    /// Whether it is being worked on.
    pub running: bool,
    /// What is being done.
    pub what: String,
    /// How far it is, 0 to 1.
    pub share: f64,
    /// Whether somebody asked to stop it; still set once it has stopped.
    pub stopping: bool,
    /// Why there is no answer.
    pub problem: Option<String>,
}

/// Everything that the requests change.
#[derive(Debug, Default)]
pub(super) struct Desk {
    /// Where uploaded files lie; removed with the desk.
    pub folder: Option<TempDir>,
    /// Files that were put on the desk since the panel began.
    pub files: u64,
    /// The recordings.
    pub slots: [Option<Slot>; SLOTS],
    /// The motor file; the panel's own when absent.
    pub motor: Option<Motor>,
    /// The motor of the first check, before recordings taught anything of it.
    pub check: Option<Checked>,
    /// What was believed before each adoption, the latest last.
    pub before: Vec<Motor>,
    /// The question.
    pub job: Job,
    /// The last answer of each kind, as JSON.
    pub results: BTreeMap<Kind, Arc<str>>,
}

/// The desk and the panel that it stands in.
#[derive(Debug)]
pub struct Bench {
    session: Arc<Session>,
    desk: Mutex<Desk>,
    /// What uploads take on the disk.
    pub(super) budget: Arc<Budget>,
    /// One file is read at a time: what reading takes in memory is then bounded too.
    pub(super) reading: tokio::sync::Mutex<()>,
    /// One plate becomes a circuit at a time.
    pub(super) estimating: tokio::sync::Mutex<()>,
}

/// What the page shows of the desk.
#[derive(Debug, Serialize)]
pub(super) struct View {
    recordings: [Option<SlotView>; SLOTS],
    motor: Option<MotorView>,
    check: Option<CheckView>,
    shipped: Vec<&'static str>,
    job: Job,
    /// Which answers there are.
    results: Vec<Kind>,
    most_bytes: u64,
}

impl Bench {
    /// An empty desk.
    pub(super) fn new(session: Arc<Session>) -> Arc<Bench> {
        Arc::new(Bench {
            session,
            desk: Mutex::default(),
            budget: Arc::default(),
            reading: tokio::sync::Mutex::default(),
            estimating: tokio::sync::Mutex::default(),
        })
    }

    /// Removes what was uploaded: the panel ends.
    pub fn clear(&self) {
        let mut desk = self.desk();
        desk.slots = Default::default();
        desk.folder = None;
    }

    /// The desk, for a few lines.
    pub(super) fn desk(&self) -> MutexGuard<'_, Desk> {
        locked(&self.desk)
    }

    /// The desk, unless a question is being worked on that its change would spoil.
    pub(super) fn free_desk(&self) -> Result<MutexGuard<'_, Desk>, Refusal> {
        let desk = self.desk();
        match desk.job.running {
            false => Ok(desk),
            true => Err(Refusal {
                status: 409,
                ..Refusal::of("a question is being worked on: wait for its answer, or stop it")
            }),
        }
    }

    /// The motor file on the desk: the chosen one, or the panel's present one.
    pub(super) fn motor(&self) -> Option<Motor> {
        let chosen = self.desk().motor.clone();
        chosen.or_else(|| self.session.motor().map(Motor::of_panel))
    }

    /// What a person should know of a recording before anything is asked of it.
    fn looked_at(&self, source: &Source) -> Option<(Audit, Vec<BlindSpot>)> {
        let Source::Recording(recording) = source else {
            return None;
        };
        let motor = self.motor();
        let expectation = motor.as_ref().map_or_else(Expectation::default, |motor| {
            Expectation::from(&motor.motor)
        });
        let blind = motor.map(|motor| channels_missing(recording, &motor.motor));
        Some((audit(recording, &expectation), blind.unwrap_or_default()))
    }

    /// Audits every recording that is not audited yet, with the motor file as it now is.
    pub(super) fn audit_missing(&self) {
        for slot in 0..SLOTS {
            let unaudited = |slot: &&Slot| slot.view.audit.is_none();
            let source = self.desk().slots[slot]
                .as_ref()
                .filter(unaudited)
                .and_then(|slot| slot.source.clone());
            let Some(source) = source else { continue };
            let looked_at = self.looked_at(&source);
            // It may have been replaced meanwhile.
            let same = |slot: &&mut Slot| {
                let now = slot.source.as_ref();
                now.is_some_and(|now| Arc::ptr_eq(now, &source))
            };
            if let Some(slot) = self.desk().slots[slot].as_mut().filter(same) {
                (slot.view.audit, slot.view.blind) = looked_at.unzip();
            }
        }
    }

    /// What the page shows.
    pub(super) fn state(&self) -> View {
        let motor = self.motor();
        let desk = self.desk();
        let view = |slot: &Option<Slot>| slot.as_ref().map(|slot| slot.view.clone());
        View {
            recordings: [view(&desk.slots[0]), view(&desk.slots[1])],
            motor: motor.map(|motor| motor.view(&desk.before)),
            check: desk.check.as_ref().map(Checked::view),
            shipped: motors::shipped_names(),
            job: desk.job.clone(),
            results: desk.results.keys().copied().collect(),
            most_bytes: super::upload::MOST_BYTES,
        }
    }
}

impl Desk {
    /// Takes another motor file; answers about the one before are gone.
    pub fn take_motor(&mut self, motor: Option<Motor>) {
        self.motor = motor;
        self.check = None;
        self.before.clear();
        self.results.clear();
        // What the audit expects changes with the nameplate.
        for slot in self.slots.iter_mut().flatten() {
            slot.view.audit = None;
        }
    }

    /// Believes another motor file of the same motor; the next check begins with it.
    pub fn believe(&mut self, motor: Motor) {
        if let Some(checked) = &mut self.check {
            checked.known.motor = motor.motor.clone();
            checked.known.text.clone_from(&motor.text);
        }
        self.motor = Some(motor);
    }

    /// Numbers that a file which is read now into a slot may hold, beside the other slots.
    pub fn numbers_left(&self, slot: usize) -> u64 {
        let others = self.slots.iter().enumerate().filter(|(k, _)| *k != slot);
        let held: u64 = others
            .filter_map(|(_, there)| there.as_ref().map(Slot::numbers))
            .sum();
        MOST_NUMBERS.saturating_sub(held)
    }

    /// The recordings that can be asked about, with their names.
    pub fn sources(&self) -> (Vec<String>, Vec<Arc<Source>>) {
        let loaded = self.slots.iter().flatten();
        let pair = |slot: &Slot| Some((slot.view.name.clone(), slot.source.clone()?));
        loaded.filter_map(pair).unzip()
    }
}
