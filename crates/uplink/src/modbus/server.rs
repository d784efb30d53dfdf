//! The server: masters connect, ask, and are answered from the store.

use std::io;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use fleet::{Store, StoreError, now_ms};
use serde::Serialize;
use thiserror::Error;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::time::{Instant, timeout};

use super::ModbusConfig;
use super::frame::{Frame, LARGEST_FRAME, answer, split};
use super::map::{Layout, Plant};

/// How long a master may take to send the rest of a request, or to take an answer.
const PATIENCE: Duration = Duration::from_secs(5);
/// Answers come from the store as it was at most so long ago.
const FRESH: Duration = Duration::from_millis(200);

/// Why the server ended.
#[derive(Debug, Error)]
pub enum ModbusError {
    /// It cannot listen where it should.
    #[error("Modbus cannot listen at {address}: {error}")]
    Listen {
        /// Where.
        address: String,
        /// Why not.
        error: io::Error,
    },
}

/// Counts of the server.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ModbusState {
    /// Masters that connected.
    pub connections: u64,
    /// Masters that were turned away: too many at once.
    pub refused_connections: u64,
    /// Requests that were answered with registers.
    pub answered: u64,
    /// Requests that were answered with an exception.
    pub exceptions: u64,
    /// Lines that were closed because what came was no Modbus TCP.
    pub broken: u64,
    /// Lines that were closed because a request did not end, or an answer was not taken.
    pub slow: u64,
}

/// Counts that the server writes and others read.
#[derive(Clone, Debug, Default)]
pub struct ModbusStatus(Arc<Counters>);

#[derive(Debug, Default)]
struct Counters {
    connections: AtomicU64,
    refused_connections: AtomicU64,
    answered: AtomicU64,
    exceptions: AtomicU64,
    broken: AtomicU64,
    slow: AtomicU64,
}

fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

impl ModbusStatus {
    /// The counts now.
    pub fn get(&self) -> ModbusState {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let counters = &self.0;
        ModbusState {
            connections: read(&counters.connections),
            refused_connections: read(&counters.refused_connections),
            answered: read(&counters.answered),
            exceptions: read(&counters.exceptions),
            broken: read(&counters.broken),
            slow: read(&counters.slow),
        }
    }
}

/// Answers masters until `stop` is true or its sender is gone.
///
/// # Errors
/// The address is taken, or may not be used.
pub async fn run(
    config: ModbusConfig,
    store: Arc<Store>,
    status: ModbusStatus,
    stop: watch::Receiver<bool>,
) -> Result<(), ModbusError> {
    let address = config.listen.to_string();
    let failed = |error| ModbusError::Listen { address, error };
    let listener = TcpListener::bind(config.listen).await.map_err(failed)?;
    serve(listener, &config, store, status, stop).await;
    Ok(())
}

async fn serve(
    listener: TcpListener,
    config: &ModbusConfig,
    store: Arc<Store>,
    status: ModbusStatus,
    mut stop: watch::Receiver<bool>,
) {
    let places = Arc::new(Semaphore::new(config.connections as usize));
    let plant = Arc::new(Newest::new(store, config.layout));
    let idle = Duration::from_secs(u64::from(config.idle_s));
    loop {
        let stream = tokio::select! {
            accepted = listener.accept() => accepted,
            _ = stop.wait_for(|stop| *stop) => return,
        };
        let Ok((stream, _)) = stream else {
            // Out of file descriptors, or the master is gone already.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        count(&status.0.connections);
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            count(&status.0.refused_connections);
            continue;
        };
        let (plant, status, mut stop) = (Arc::clone(&plant), status.clone(), stop.clone());
        tokio::spawn(async move {
            tokio::select! {
                () = converse(stream, &plant, &status.0, idle) => {}
                _ = stop.wait_for(|stop| *stop) => {}
            }
            drop(place);
        });
    }
}

/// Answers one master until it hangs up, is silent, or does not keep to the protocol.
async fn converse(mut stream: TcpStream, plant: &Newest, counters: &Counters, idle: Duration) {
    let mut buffer = Vec::with_capacity(2 * LARGEST_FRAME);
    loop {
        match split(&buffer) {
            Frame::Broken => return count(&counters.broken),
            Frame::Whole(request, length) => {
                let plant = plant.get().await;
                let Ok(plant) = plant else { return };
                let (reply, exception) = answer(&request, &plant, now_ms());
                count(if exception {
                    &counters.exceptions
                } else {
                    &counters.answered
                });
                match timeout(PATIENCE, stream.write_all(&reply)).await {
                    Ok(Ok(())) => _ = buffer.drain(..length),
                    Ok(Err(_)) => return,
                    Err(_) => return count(&counters.slow),
                }
            }
            Frame::Incomplete => {
                let begun = !buffer.is_empty();
                let patience = if begun { PATIENCE } else { idle };
                match timeout(patience, read(&mut stream, &mut buffer)).await {
                    Ok(true) => {}
                    Ok(false) => return,
                    Err(_) if begun => return count(&counters.slow),
                    Err(_) => return,
                }
            }
        }
    }
}

/// Reads what is there, at most to twice the longest frame; whether the line still holds.
async fn read(stream: &mut TcpStream, buffer: &mut Vec<u8>) -> bool {
    let room = (2 * LARGEST_FRAME).saturating_sub(buffer.len());
    let mut limited = stream.take(room as u64);
    matches!(limited.read_buf(buffer).await, Ok(count) if count > 0)
}

/// The plant as the store knew it a moment ago, shared by all masters.
struct Newest {
    store: Arc<Store>,
    layout: Layout,
    known: Mutex<Option<(Instant, Arc<Plant>)>>,
}

impl Newest {
    fn new(store: Arc<Store>, layout: Layout) -> Newest {
        Newest {
            store,
            layout,
            known: Mutex::new(None),
        }
    }

    async fn get(&self) -> Result<Arc<Plant>, StoreError> {
        let known = self
            .known
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        if let Some((at, plant)) = known
            && at.elapsed() < FRESH
        {
            return Ok(plant);
        }
        let store = Arc::clone(&self.store);
        let motors = tokio::task::spawn_blocking(move || store.motors()).await;
        let plant = match motors {
            Ok(motors) => Arc::new(Plant::new(&motors?, self.layout)),
            // The program ends.
            Err(_) => Arc::default(),
        };
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        *known = Some((Instant::now(), Arc::clone(&plant)));
        Ok(plant)
    }
}
