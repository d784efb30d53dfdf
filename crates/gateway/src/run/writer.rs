//! The one that writes: it collects posts and stores them, batch after batch.

use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fleet::{Entry, MotorId, Store, StoreError};
use tokio::sync::{mpsc, oneshot, watch};

use crate::poll::{Post, Tally};

/// A batch is written after this time, or when it has so many entries.
const COLLECT: Duration = Duration::from_millis(200);
const MOST: usize = 5_000;
/// Between two attempts to write a batch that failed.
const PAUSE: Duration = Duration::from_secs(1);
/// Attempts once the gateway ends: a disk that is full stays full.
const LAST_ATTEMPTS: u32 = 3;

/// Why nothing more is written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Another gateway took the store over.
    #[error("{0}")]
    Taken(StoreError),
    /// The gateway ended while writing failed.
    #[error(
        "{entries} entries could not be written: {error}; boards are asked for them again after the next start, as long as they keep them"
    )]
    Left {
        /// Entries that are not stored.
        entries: usize,
        /// What the store says.
        error: StoreError,
    },
}

/// What the writer works with.
pub(super) struct Writer {
    pub store: Arc<Store>,
    pub posts: mpsc::Receiver<Post>,
    pub tally: Arc<Tally>,
    /// Counts batches that are on the disk.
    pub stored: watch::Sender<u64>,
    pub say: Arc<dyn Fn(String) + Send + Sync>,
    pub ended: watch::Receiver<bool>,
}

/// Posts that are stored together.
#[derive(Default)]
struct Batch {
    entries: Vec<(MotorId, Entry)>,
    waiting: Vec<oneshot::Sender<()>>,
}

impl Batch {
    fn take(&mut self, post: Post) {
        let motor = post.motor;
        self.entries
            .extend(post.entries.into_iter().map(|entry| (motor.clone(), entry)));
        self.waiting.extend(post.durable);
    }
}

impl Writer {
    /// Writes until nobody posts any more.
    pub fn run(mut self) -> Result<(), WriteError> {
        while let Some(first) = self.posts.blocking_recv() {
            let batch = self.collect(first);
            self.write(&batch.entries)?;
            self.stored.send_modify(|count| *count += 1);
            // Who asked may have gone.
            for waiting in batch.waiting {
                let _ = waiting.send(());
            }
        }
        Ok(())
    }

    /// What comes within the time of a batch. A post that somebody waits for is not held up.
    fn collect(&mut self, first: Post) -> Batch {
        let end = Instant::now() + COLLECT;
        let mut batch = Batch::default();
        batch.take(first);
        while batch.entries.len() < MOST {
            match self.posts.try_recv() {
                Ok(post) => batch.take(post),
                Err(mpsc::error::TryRecvError::Disconnected) => break,
                Err(mpsc::error::TryRecvError::Empty) => {
                    if Instant::now() >= end || !batch.waiting.is_empty() {
                        break;
                    }
                    sleep(COLLECT / 20);
                }
            }
        }
        batch
    }

    /// Writes a batch, however long that takes. Meanwhile links wait, and boards keep what they have.
    fn write(&self, entries: &[(MotorId, Entry)]) -> Result<(), WriteError> {
        let mut attempts = 0;
        loop {
            let error = match self.store.append(entries) {
                Ok(done) => {
                    self.count(entries, done.already, done.gaps);
                    return Ok(());
                }
                Err(error @ StoreError::OtherWriter) => return Err(WriteError::Taken(error)),
                Err(error) => error,
            };
            if attempts == 0 {
                Tally::add(&self.tally.failed_batches, 1);
                (self.say)(format!(
                    "store: {error}; it is tried again every second, and boards keep two minutes"
                ));
            }
            attempts += 1;
            if *self.ended.borrow() && attempts >= LAST_ATTEMPTS {
                let entries = entries.len();
                return Err(WriteError::Left { entries, error });
            }
            sleep(PAUSE);
        }
    }

    fn count(&self, entries: &[(MotorId, Entry)], already: u64, gaps: u64) {
        entries.iter().for_each(|(_, entry)| self.tally.take(entry));
        Tally::add(&self.tally.already, already);
        Tally::add(&self.tally.gaps, gaps);
        Tally::add(&self.tally.batches, 1);
    }
}
