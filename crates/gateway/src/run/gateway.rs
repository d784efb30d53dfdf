//! Start, state and end.

use std::sync::Arc;
use std::time::Duration;

use fleet::alarm::Watch;
use fleet::people::{People, PeopleError};
use fleet::{Claim, MotorInfo, Store, StoreError};
use tokio::sync::{mpsc, oneshot, watch};
use tokio::task::JoinSet;

use super::alarms::Alarms;
use super::keeper::Keeper;
use super::requests::Requests;
use super::writer::{WriteError, Writer};
use crate::bus::Bus;
use crate::config::{Config, MotorConfig};
use crate::poll::{Context, Snapshot, Tally, follow, knock};

/// Posts that may wait for the writer; a link waits when there are more.
const POSTS: usize = 512;
/// How long links have to end; what they hold then is asked for again after the next start.
const LINKS_END: Duration = Duration::from_secs(2);

/// Why a gateway does not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The store.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Users, and what they ask for.
    #[error(transparent)]
    People(#[from] PeopleError),
    /// The system gives no thread.
    #[error("no thread for the writer: {0}")]
    Thread(#[from] std::io::Error),
}

/// A running gateway.
pub struct Gateway {
    /// A second gateway is refused, and does not take the store from this one.
    _claim: Claim,
    store: Arc<Store>,
    watch: Arc<Watch>,
    stored: watch::Receiver<u64>,
    end: watch::Sender<bool>,
    tally: Arc<Tally>,
    motors: u64,
    links: JoinSet<()>,
    /// `None` once it has told its end.
    writer: Option<oneshot::Receiver<Result<(), WriteError>>>,
}

impl Gateway {
    /// Opens the store, declares the motors, and follows every link. `outputs` are the names of those to whom the store is handed
    /// on: it keeps for them what they have not taken. `say` hears what a person at the terminal should know.
    ///
    /// # Errors
    /// The store cannot be opened or written.
    pub fn start(
        config: &Config,
        outputs: &[&str],
        say: impl Fn(String) + Send + Sync + 'static,
    ) -> Result<Self, StartError> {
        let claim = Claim::take(&config.store)?;
        let store = Arc::new(Store::open(&config.store, &config.limits)?);
        let infos: Vec<MotorInfo> = config.motors.iter().map(|m| m.info.clone()).collect();
        store.declare(&infos)?;
        store.declare_sinks(outputs)?;
        let last = store.motors()?.into_iter();
        let last = last.filter_map(|state| Some((state.info.id, state.last?)));
        let (posts, queue) = mpsc::channel(POSTS);
        let (end, ended) = watch::channel(false);
        let (told, stored) = watch::channel(0);
        let tally = Arc::new(Tally::default());
        let context = Context {
            store: store.clone(),
            last: Arc::new(last.collect()),
            posts,
            tally: tally.clone(),
            patience: config.patience,
            say: Arc::new(say),
            ended: ended.clone(),
        };
        let writer = Writer {
            store: store.clone(),
            posts: queue,
            tally: tally.clone(),
            stored: told,
            say: context.say.clone(),
            ended: ended.clone(),
        };
        let keeper = Keeper {
            store: store.clone(),
            say: context.say.clone(),
            ended: ended.clone(),
        };
        let alarms = Alarms {
            store: store.clone(),
            watch: Arc::new(Watch::new(config.alarms.clone())),
            stored: stored.clone(),
            say: context.say.clone(),
            ended: ended.clone(),
        };
        let watch = alarms.watch.clone();
        let requests = Requests {
            store: store.clone(),
            watch: watch.clone(),
            people: People::open(&config.store)?,
            say: context.say.clone(),
            ended,
        };
        let (done, writer_done) = oneshot::channel();
        let thread = std::thread::Builder::new().name("writer".into());
        thread.spawn(move || drop(done.send(writer.run())))?;
        std::thread::Builder::new()
            .name("keeper".into())
            .spawn(move || keeper.run())?;
        std::thread::Builder::new()
            .name("alarms".into())
            .spawn(move || alarms.run())?;
        std::thread::Builder::new()
            .name("requests".into())
            .spawn(move || requests.run())?;
        let mut links = JoinSet::new();
        for (k, link) in config.links.iter().enumerate() {
            let motors: Vec<MotorConfig> = config.motors_of(k).cloned().collect();
            links.spawn(follow(link.clone(), motors, context.clone()));
        }
        Ok(Gateway {
            _claim: claim,
            store,
            watch,
            stored,
            end,
            tally,
            motors: infos.len() as u64,
            links,
            writer: Some(writer_done),
        })
    }

    /// The store, for those who hand on what it keeps.
    pub fn store(&self) -> Arc<Store> {
        self.store.clone()
    }

    /// The alarms, for those who show them and act on them.
    pub fn alarms(&self) -> Arc<Watch> {
        self.watch.clone()
    }

    /// Changes whenever something new is on the disk.
    pub fn stored(&self) -> watch::Receiver<u64> {
        self.stored.clone()
    }

    /// `true` once the gateway ends.
    pub fn ended(&self) -> watch::Receiver<bool> {
        self.end.subscribe()
    }

    /// Counts since the start.
    pub fn snapshot(&self) -> Snapshot {
        self.tally.snapshot(self.motors)
    }

    /// Waits until nothing can be written any more; why.
    pub async fn failed(&mut self) -> WriteError {
        let outcome = match &mut self.writer {
            Some(writer) => writer.await,
            None => return std::future::pending().await,
        };
        self.writer = None;
        match outcome {
            Ok(Err(error)) => error,
            // The writer ends only when every link has.
            _ => std::future::pending().await,
        }
    }

    /// Tells everybody that the gateway ends.
    pub fn begin_end(&self) {
        let _ = self.end.send(true);
    }

    /// Ends: links stop, and everything that was received is written.
    ///
    /// # Errors
    /// What was received could not be written.
    pub async fn end(mut self) -> Result<Snapshot, WriteError> {
        self.begin_end();
        let links = async { while self.links.join_next().await.is_some() {} };
        if tokio::time::timeout(LINKS_END, links).await.is_err() {
            self.links.shutdown().await;
        }
        if let Some(writer) = self.writer
            && let Ok(outcome) = writer.await
        {
            outcome?;
        }
        Ok(self.tally.snapshot(self.motors))
    }
}

/// What a motor answered to an attempt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Connected {
    /// Name of the motor.
    pub motor: String,
    /// Who answered and what is new, or why nobody did; `None` on a link for frames, which nobody asks.
    pub answer: Option<Result<String, String>>,
}

/// Asks every motor of a link once.
pub async fn connect(config: &Config, link: usize) -> Vec<Connected> {
    let Some(to) = config.links.get(link) else {
        return Vec::new();
    };
    let mut bus = Bus::new(to);
    let mut answers = Vec::new();
    for motor in config.motors_of(link) {
        let answer = match &mut bus {
            Some(bus) => Some(ask(bus, motor).await),
            None => None,
        };
        answers.push(Connected {
            motor: motor.info.id.to_string(),
            answer,
        });
    }
    answers
}

async fn ask(bus: &mut Bus, motor: &MotorConfig) -> Result<String, String> {
    let head = knock(bus, motor.unit)
        .await
        .map_err(|error| error.to_string())?;
    let [a, b, c] = head.serial;
    let serial = format!("{a:08x}{b:08x}{c:08x}");
    if let Some(expected) = motor.serial.as_ref().filter(|other| **other != serial) {
        return Err(format!(
            "another board answers: serial number {serial}, the configuration says {expected}"
        ));
    }
    Ok(format!(
        "board {serial}, {} events, {} s since its start",
        head.last_event, head.last_second
    ))
}
