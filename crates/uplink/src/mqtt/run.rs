//! From the store to a broker, as long as the program runs.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use fleet::{Numbered, Store, StoreError, now_ms};
use thiserror::Error;
use tokio::sync::watch;
use tokio::time::{Instant, sleep, sleep_until};

use super::error::LineError;
use super::line::{Arrived, Line};
use super::present::present;
use super::status::MqttStatus;
use super::{MqttConfig, session_file};
use crate::sparkplug::{Message, Node, Phase, Reaction, Update, of_entry};

/// Shortest and longest pause before the next attempt.
const PAUSES: (Duration, Duration) = (Duration::from_secs(1), Duration::from_secs(30));
/// Batches that may be on their way: the store is read while the broker answers.
const ON_THEIR_WAY: usize = 4;
/// How long the broker may take to answer a ping.
const PATIENCE: Duration = Duration::from_secs(20);

/// Why an output ended.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The store cannot be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// Work on the store was broken off.
    #[error("work on the store was broken off: {0}")]
    BrokenOff(#[from] tokio::task::JoinError),
}

/// Why a session ended.
#[derive(Debug, Error)]
enum Ended {
    #[error(transparent)]
    Line(#[from] LineError),
    #[error("the primary host went away")]
    HostWent,
    #[error("stopped")]
    Stopped,
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Tells a broker everything that the store takes in, until `stop` is true or its sender is gone. What was not delivered before
/// comes first. A broker that is away is waited for.
///
/// `wake` changes after each commit to the store.
///
/// # Errors
/// The store cannot be read or written.
pub async fn run(
    config: MqttConfig,
    store: Arc<Store>,
    status: MqttStatus,
    wake: watch::Receiver<u64>,
    stop: watch::Receiver<bool>,
) -> Result<(), OutputError> {
    let bd_seq = session_file::next(config.session_file.as_deref());
    let version = env!("CARGO_PKG_VERSION");
    let node = Node::new(
        config.names.clone(),
        config.primary_host.clone(),
        bd_seq,
        version,
    );
    let mut output = Output {
        config,
        store,
        status,
        wake,
        stop,
        node,
        pings: VecDeque::new(),
        read: 0,
        turn: 0,
    };
    // From now on the store keeps what this output has not taken.
    let cursor = output.cursor().await?;
    output.delivered(cursor).await?;
    output.sessions().await
}

struct Output {
    config: MqttConfig,
    store: Arc<Store>,
    status: MqttStatus,
    wake: watch::Receiver<u64>,
    stop: watch::Receiver<bool>,
    node: Node,
    /// Pings on their way, each with the entry before it.
    pings: VecDeque<Option<u64>>,
    /// Newest entry that was read from the store.
    read: u64,
    /// Counts sessions that ended: each next one is at the next broker.
    turn: usize,
}

impl Output {
    async fn sessions(&mut self) -> Result<(), OutputError> {
        let mut pause = PAUSES.0;
        loop {
            let births = self.status.get().births;
            let ended = self.session().await;
            self.node.end();
            self.status.change(|state| {
                (state.connected, state.online) = (false, false);
                state.last_error = ended.to_string();
            });
            match ended {
                Ended::Stopped => return Ok(()),
                Ended::Output(error) => return Err(error),
                Ended::Line(_) | Ended::HostWent => self.turn += 1,
            }
            if self.status.get().births > births {
                pause = PAUSES.0;
            }
            tokio::select! {
                () = sleep(pause) => pause = (pause * 2).min(PAUSES.1),
                () = stopped(&mut self.stop) => return Ok(()),
            }
        }
    }

    async fn session(&mut self) -> Ended {
        let opened = self.open().await;
        let mut line = match opened {
            Ok(line) => line,
            Err(ended) => return ended,
        };
        let ended = match self.talk(&mut line).await {
            Ok(never) => match never {},
            Err(ended) => ended,
        };
        if matches!(ended, Ended::HostWent | Ended::Stopped) {
            // A line that breaks now ends as the session would: the broker tells the will.
            let death = self.node.death(now_ms());
            if line.publish(&[death]).await.is_ok() {
                let _ = line.disconnect().await;
            }
        }
        ended
    }

    async fn open(&mut self) -> Result<Line, Ended> {
        let will = self.node.connect(now_ms());
        let file = self.config.session_file.as_deref();
        session_file::keep(file, self.node.bd_seq()).map_err(LineError::Io)?;
        self.pings.clear();
        self.read = self.cursor().await?;
        let topics = self.node.subscriptions();
        let broker = self.config.broker(self.turn);
        let line = tokio::select! {
            line = Line::open(&self.config, broker, &will, &topics) => line?,
            () = stopped(&mut self.stop) => return Err(Ended::Stopped),
        };
        self.status.change(|state| {
            state.connected = true;
            state.sessions += 1;
        });
        Ok(line)
    }

    async fn talk(&mut self, line: &mut Line) -> Result<std::convert::Infallible, Ended> {
        let reaction = self.node.subscribed();
        self.react(line, reaction).await?;
        let pace = Duration::from_secs(u64::from(self.config.keep_alive_s)) / 2;
        let mut answer_by = Instant::now() + PATIENCE;
        loop {
            let more = self.tell(line).await?;
            if self.pings.is_empty() {
                answer_by = Instant::now() + PATIENCE;
            }
            tokio::select! {
                arrived = line.next() => {
                    self.arrived(line, arrived?).await?;
                    answer_by = Instant::now() + PATIENCE;
                }
                Ok(()) = self.wake.changed() => {}
                () = stopped(&mut self.stop) => return Err(Ended::Stopped),
                () = sleep(pace), if self.pings.is_empty() => self.ping(line, None).await?,
                () = sleep_until(answer_by), if !self.pings.is_empty() => {
                    return Err(LineError::Silent.into());
                }
                () = std::future::ready(()), if more => {}
            }
        }
    }

    async fn arrived(&mut self, line: &mut Line, arrived: Arrived) -> Result<(), Ended> {
        match arrived {
            Arrived::Message { topic, payload } => {
                let reaction = self.node.take(now_ms(), &topic, &payload);
                let (refused, foreign) = (self.node.refused(), self.node.foreign_births());
                self.status.change(|state| {
                    (state.refused_commands, state.foreign_births) = (refused, foreign);
                });
                self.react(line, reaction).await
            }
            Arrived::Pong => match self.pings.pop_front().flatten() {
                Some(id) => Ok(self.delivered(id).await?),
                None => Ok(()),
            },
            Arrived::Subscribed => Ok(()),
        }
    }

    async fn react(&mut self, line: &mut Line, reaction: Reaction) -> Result<(), Ended> {
        match reaction {
            Reaction::None => Ok(()),
            Reaction::Leave => Err(Ended::HostWent),
            Reaction::Tell(message) => self.publish(line, &[message]).await,
            Reaction::Birth => {
                let (plant, motors) = self.with_store(|store| present(store, now_ms())).await?;
                let messages = self.node.birth(now_ms(), plant, motors);
                self.status.change(|state| {
                    state.online = true;
                    state.births += 1;
                });
                self.publish(line, &messages).await
            }
        }
    }

    /// Sends the next batch; whether there may be more at once.
    async fn tell(&mut self, line: &mut Line) -> Result<bool, Ended> {
        let on_their_way = self.pings.iter().flatten().count();
        if self.node.phase() != Phase::Online || on_their_way >= ON_THEIR_WAY {
            return Ok(false);
        }
        let (read, limit) = (self.read, self.config.batch as usize);
        let entries = self
            .with_store(move |store| store.since(read, limit))
            .await?;
        let Some(last) = entries.last().map(|entry| entry.id) else {
            return Ok(false);
        };
        let full = entries.len() >= limit;
        let messages = self
            .node
            .tell(now_ms(), entries.into_iter().map(told).collect());
        self.publish(line, &messages).await?;
        self.ping(line, Some(last)).await?;
        self.read = last;
        Ok(full && on_their_way + 1 < ON_THEIR_WAY)
    }

    async fn ping(&mut self, line: &mut Line, behind: Option<u64>) -> Result<(), Ended> {
        line.ping().await?;
        self.pings.push_back(behind);
        Ok(())
    }

    async fn publish(&self, line: &mut Line, messages: &[Message]) -> Result<(), Ended> {
        line.publish(messages).await?;
        let count = messages.len() as u64;
        self.status.change(|state| state.messages += count);
        Ok(())
    }

    async fn cursor(&self) -> Result<u64, OutputError> {
        let sink = self.config.sink.clone();
        self.with_store(move |store| store.cursor(&sink)).await
    }

    async fn delivered(&self, id: u64) -> Result<(), OutputError> {
        let sink = self.config.sink.clone();
        self.with_store(move |store| store.set_cursor(&sink, id))
            .await?;
        self.status.change(|state| state.delivered = id);
        Ok(())
    }

    /// Work on the store waits for the disk: not here.
    async fn with_store<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Store) -> Result<T, StoreError> + Send + 'static,
    ) -> Result<T, OutputError> {
        let store = Arc::clone(&self.store);
        Ok(tokio::task::spawn_blocking(move || work(&store)).await??)
    }
}

fn told(entry: Numbered) -> (Option<String>, Update) {
    let motor = entry.motor.map(|motor| motor.to_string());
    (motor, of_entry(&entry.entry))
}

async fn stopped(stop: &mut watch::Receiver<bool>) {
    // An error says that nobody is left who could say it.
    let _ = stop.wait_for(|stop| *stop).await;
}
