//! The source's own thread: paced by the clock on the wall, never by a reader.

use std::sync::{Arc, Mutex, mpsc};
use std::thread::JoinHandle;

use motor::MotorFile;
use tokio::sync::{broadcast, oneshot};

use crate::running::bench::MotorError;
use crate::running::events::Event;
use crate::running::history::HistoryRow;
use crate::running::shared::{Broadcast, Command, Refusal, Request, Shared, Status, locked};
use crate::running::worker::Worker;
use crate::source::Source;

/// Messages that a reader may be behind before it loses the oldest: four seconds at 50 windows a second.
const BACKLOG: usize = 256;

/// A running source.
#[derive(Debug)]
pub struct Session {
    /// What it shares with the server.
    pub(crate) shared: Arc<Shared>,
    commands: mpsc::Sender<Command>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// Starts a source on its own thread, judged with `motor`.
///
/// # Errors
/// A motor whose values do not fit the core.
pub fn start(
    source: Box<dyn Source>,
    motor: Option<MotorFile>,
    speed: f64,
) -> Result<Session, MotorError> {
    let shared = Arc::new(Shared {
        status: Mutex::new(Status::new(source.as_ref(), motor.as_ref(), speed)),
        history: Mutex::default(),
        events: Mutex::default(),
        motor: Mutex::new(motor.clone()),
        stream: broadcast::channel(BACKLOG).0,
        shown: Mutex::default(),
    });
    let (commands, inbox) = mpsc::channel();
    let worker = Worker::new(source, motor, shared.clone())?;
    let thread = std::thread::Builder::new()
        .name("source".into())
        .spawn(move || worker.run(&inbox));
    Ok(Session {
        shared,
        commands,
        thread: Mutex::new(thread.ok()),
    })
}

impl Session {
    /// Asks something of the source.
    ///
    /// # Errors
    /// What the source cannot do.
    pub async fn request(&self, request: Request) -> Result<(), Refusal> {
        let (reply, answer) = oneshot::channel();
        let gone = |_| Refusal::of("the source has ended: start the panel again");
        self.commands
            .send(Some((request, reply)))
            .map_err(|_| gone(()))?;
        answer.await.map_err(|_| gone(()))?
    }

    /// What the page shows beside the windows.
    pub fn status(&self) -> Status {
        locked(&self.shared.status).clone()
    }

    /// One thing about the status.
    pub fn status_now<T>(&self, of: impl FnOnce(&Status) -> T) -> T {
        of(&locked(&self.shared.status))
    }

    /// What a source that rests showed last: nothing new comes that a page could wait for.
    pub fn shown_at_rest(&self) -> impl Iterator<Item = Broadcast> + use<> {
        let rests = self.status_now(Status::rests);
        let shown = locked(&self.shared.shown);
        let window = shown
            .window
            .as_ref()
            .and_then(|window| Broadcast::of("window", window));
        let wave = shown
            .wave
            .as_ref()
            .and_then(|wave| Broadcast::of("wave", wave));
        [window, wave].into_iter().flatten().filter(move |_| rests)
    }

    /// The motor that is judged with, where it is known.
    pub fn motor(&self) -> Option<MotorFile> {
        locked(&self.shared.motor).clone()
    }

    /// The last windows.
    pub fn history(&self) -> Vec<HistoryRow> {
        locked(&self.shared.history).rows()
    }

    /// What happened.
    pub fn events(&self) -> Vec<Event> {
        locked(&self.shared.events).list()
    }

    /// Everything that comes from now on.
    pub fn subscribe(&self) -> broadcast::Receiver<Broadcast> {
        self.shared.stream.subscribe()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // A thread that has ended already needs no word.
        let _ = self.commands.send(None);
        if let Some(thread) = locked(&self.thread).take() {
            let _ = thread.join();
        }
    }
}
