//! What the page is about: the store of a plant, its people, and the wall, kept up to date by a thread of its own.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fleet::people::{People, PeopleError, Role, User};
use fleet::{Reader, StoreError, now_ms};
use serde::Serialize;
use tokio::sync::broadcast;

use super::answers::{Counts, Refused, Tile, Wall};
use super::wall::{differs, wall};

/// Between two looks at the store.
const PAUSE: Duration = Duration::from_millis(50);
/// What grows old does so although nothing is written.
const AT_LEAST_EVERY: Duration = Duration::from_millis(500);
/// A large plant is looked at less often: this many times as long as a look takes nothing is done.
const REST: u32 = 4;
/// Messages that a slow page may be behind.
const BEHIND: usize = 64;

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum PlantError {
    /// The store.
    #[error("{0}; the store is made by `drivemon gateway`")]
    Store(#[from] StoreError),
    /// The people.
    #[error(transparent)]
    People(#[from] PeopleError),
}

/// When a calibration is due.
#[derive(Clone, Copy, Debug)]
pub struct DueRule {
    /// Older than so many days.
    pub after_days: u32,
    /// r1 or r4 has moved by more than so much since the calibration, percent of its scale.
    pub drift_percent: f32,
}

impl Default for DueRule {
    /// A year, and one percent.
    fn default() -> Self {
        DueRule {
            after_days: 365,
            drift_percent: 1.0,
        }
    }
}

/// Settings of the page.
#[derive(Clone, Debug)]
pub struct Settings {
    /// A motor without data for so long is grey, ms.
    pub stale_ms: i64,
    /// Whether who has no token may see: on a computer that nobody else reaches.
    pub open: bool,
    /// When a calibration is due.
    pub due: DueRule,
}

/// What changed on the wall.
#[derive(Clone, Debug, Serialize)]
pub(super) struct News {
    /// When, Unix ms.
    now_ms: i64,
    counts: Counts,
    /// Motors that look different now.
    motors: Vec<Tile>,
    /// Motors that left the configuration.
    gone: Vec<String>,
}

/// A plant.
pub struct Plant {
    pub(super) reader: Reader,
    pub(super) people: People,
    pub(super) settings: Settings,
    pub(super) refused: Counters,
    pub(super) slow: Slow,
    wall: Mutex<Arc<Wall>>,
    /// Why the store cannot be read now; empty: it can.
    trouble: Mutex<String>,
    news: broadcast::Sender<Arc<String>>,
    ended: AtomicBool,
}

/// Counters of refused requests.
#[derive(Debug, Default)]
pub(super) struct Counters {
    pub no_token: AtomicU64,
    pub wrong_role: AtomicU64,
    pub foreign: AtomicU64,
}

/// Counters of pages that do not read what they are sent.
#[derive(Debug, Default)]
pub(super) struct Slow {
    /// Times that a page which had fallen behind got the whole wall in the place of what it missed.
    pub behind: AtomicU64,
    /// Changes that it was not sent because of that.
    pub skipped: AtomicU64,
    /// Streams that ended while their page had not read for some seconds.
    pub cut: AtomicU64,
}

impl Counters {
    pub fn now(&self) -> Refused {
        Refused {
            no_token: self.no_token.load(Relaxed),
            wrong_role: self.wrong_role.load(Relaxed),
            foreign: self.foreign.load(Relaxed),
        }
    }
}

impl Plant {
    /// Opens the store of a plant and looks at it from now on.
    ///
    /// # Errors
    /// There is no store, or its people cannot be read.
    pub fn open(store: &Path, settings: Settings) -> Result<Arc<Self>, PlantError> {
        let reader = Reader::open(store)?;
        let people = People::open(store)?;
        let plant = Arc::new(Plant {
            reader,
            people,
            settings,
            refused: Counters::default(),
            slow: Slow::default(),
            wall: Mutex::default(),
            trouble: Mutex::default(),
            news: broadcast::Sender::new(BEHIND),
            ended: AtomicBool::new(false),
        });
        plant.look()?;
        let looking = Arc::downgrade(&plant);
        // It ends with the last who holds the plant.
        std::thread::spawn(move || {
            let (mut version, mut looked) = (None, Instant::now());
            while let Some(plant) = looking.upgrade() {
                if plant.ended.load(Relaxed) {
                    return;
                }
                let pause = plant.turn(&mut version, &mut looked);
                drop(plant);
                sleep(pause);
            }
        });
        Ok(plant)
    }

    /// No more looks.
    pub(super) fn end(&self) {
        self.ended.store(true, Relaxed);
    }

    /// The wall as it was seen last.
    pub(super) fn wall(&self) -> Arc<Wall> {
        held(&self.wall).clone()
    }

    /// Why the store cannot be read now; empty: it can.
    pub(super) fn trouble(&self) -> String {
        held(&self.trouble).clone()
    }

    /// What changes from now on, as JSON.
    pub(super) fn subscribe(&self) -> broadcast::Receiver<Arc<String>> {
        self.news.subscribe()
    }

    /// Whose token this is; who has none may see where that is open.
    pub(super) fn visitor(&self, token: Option<&str>) -> Result<Option<User>, PeopleError> {
        token.map_or(Ok(None), |token| self.people.user_of_token(token))
    }

    /// Whether somebody may do what needs a role.
    pub(super) fn allows(&self, user: Option<&User>, role: Role) -> bool {
        let open = self.settings.open && role == Role::See;
        open || user.is_some_and(|user| user.role >= role)
    }

    /// Looks where something was written, or time has passed; how long to rest.
    fn turn(&self, version: &mut Option<i64>, looked: &mut Instant) -> Duration {
        let now = self.reader.version().ok();
        if now.is_some() && now == *version && looked.elapsed() < AT_LEAST_EVERY {
            return PAUSE;
        }
        let begin = Instant::now();
        let done = self.look();
        (*version, *looked) = (now, begin);
        *held(&self.trouble) = done.err().map_or(String::new(), |error| error.to_string());
        PAUSE.max(REST * begin.elapsed())
    }

    /// Reads the store, keeps the wall and tells what is different.
    pub(super) fn look(&self) -> Result<(), StoreError> {
        let motors = self.reader.motors()?;
        let alarms = self.reader.alarms_not_normal()?;
        let now = wall(&motors, &alarms, now_ms(), self.settings.stale_ms);
        let before = std::mem::replace(&mut *held(&self.wall), Arc::new(now));
        let now = self.wall();
        if let Some(news) = news(&before, &now) {
            // Without a page nobody listens.
            let _ = self.news.send(Arc::new(json(&news)));
        }
        Ok(())
    }
}

/// As text of JSON; what the API answers always can be.
pub(super) fn json<T: Serialize>(message: &T) -> String {
    serde_json::to_string(message).unwrap_or_default()
}

/// A lock whose holder panicked is as good as any: what it guards is replaced whole.
fn held<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn news(before: &Wall, now: &Wall) -> Option<News> {
    let old: std::collections::HashMap<_, _> =
        before.motors.iter().map(|tile| (&tile.id, tile)).collect();
    let is_new = |tile: &&Tile| old.get(&tile.id).is_none_or(|old| differs(old, tile));
    let motors: Vec<_> = now.motors.iter().filter(is_new).cloned().collect();
    let present: std::collections::HashSet<_> = now.motors.iter().map(|tile| &tile.id).collect();
    let gone = before.motors.iter().map(|tile| &tile.id);
    let gone: Vec<_> = gone.filter(|id| !present.contains(id)).cloned().collect();
    let same = motors.is_empty() && gone.is_empty() && before.counts == now.counts;
    (!same).then_some(News {
        now_ms: now.now_ms,
        counts: now.counts,
        motors,
        gone,
    })
}
