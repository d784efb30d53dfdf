//! What goes from links to the writer, and counts of all that happens.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use fleet::{Entry, MotorId};
use serde::Serialize;
use tokio::sync::{mpsc, oneshot};

/// Entries of one motor, in the order in which they are to be stored.
#[derive(Debug)]
pub(crate) struct Post {
    /// Whose they are.
    pub motor: MotorId,
    /// What is to be stored.
    pub entries: Vec<Entry>,
    /// Hears when they are on the disk.
    pub durable: Option<oneshot::Sender<()>>,
}

/// Where posts go. Its bounded length is what holds links back while the disk is slow.
pub(crate) type Posts = mpsc::Sender<Post>;

/// Counts since the start.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub up: AtomicU64,
    pub visits: AtomicU64,
    pub failures: AtomicU64,
    pub seconds: AtomicU64,
    pub events: AtomicU64,
    pub already: AtomicU64,
    pub gaps: AtomicU64,
    pub damaged_frames: AtomicU64,
    pub batches: AtomicU64,
    pub failed_batches: AtomicU64,
}

/// Counts at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Snapshot {
    /// Motors of the configuration.
    pub motors: u64,
    /// Motors that answer.
    pub up: u64,
    /// Visits of boards.
    pub visits: u64,
    /// Visits that failed.
    pub failures: u64,
    /// Seconds that were received.
    pub seconds: u64,
    /// Events that were received.
    pub events: u64,
    /// Entries that the store had already; boards and links that are as they were among them.
    pub already: u64,
    /// Gaps that were told.
    pub gaps: u64,
    /// Frames that came damaged.
    pub damaged_frames: u64,
    /// Batches that are on the disk.
    pub batches: u64,
    /// Batches that could not be written at once, and were kept.
    pub failed_batches: u64,
}

impl Tally {
    /// Adds to a count.
    pub fn add(count: &AtomicU64, more: u64) {
        count.fetch_add(more, Relaxed);
    }

    /// Counts what an entry is.
    pub fn take(&self, entry: &Entry) {
        match entry {
            Entry::Second(_) => Self::add(&self.seconds, 1),
            Entry::Event(_) => Self::add(&self.events, 1),
            Entry::Gap(_) => Self::add(&self.gaps, 1),
            _ => {}
        }
    }

    /// The counts now.
    pub fn snapshot(&self, motors: u64) -> Snapshot {
        let of = |count: &AtomicU64| count.load(Relaxed);
        Snapshot {
            motors,
            up: of(&self.up),
            visits: of(&self.visits),
            failures: of(&self.failures),
            seconds: of(&self.seconds),
            events: of(&self.events),
            already: of(&self.already),
            gaps: of(&self.gaps),
            damaged_frames: of(&self.damaged_frames),
            batches: of(&self.batches),
            failed_batches: of(&self.failed_batches),
        }
    }
}
