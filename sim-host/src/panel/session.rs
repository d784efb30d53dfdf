//! The source's own thread: paced by the clock on the wall, never by a reader.

use std::sync::{Arc, Mutex, MutexGuard, mpsc};
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

use motor::MotorFile;
use serde::Serialize;
use tokio::sync::{broadcast, oneshot};

use super::events::{Acknowledgement, Event, Events};
use super::fields::{Field, FieldProblem, fields};
use super::history::{History, HistoryRow};
use super::message::WindowMessage;
use super::source::{PANEL_FAULTS, PanelFault, Source, SourceInfo, SwitchedFault};
use super::wave::WaveMessage;
use super::worker::Worker;

/// Messages that a reader may be behind before it loses the oldest: four seconds at 50 windows a second.
const BACKLOG: usize = 256;

/// What goes to every page: the name of the event and its JSON.
#[derive(Clone, Debug)]
pub struct Broadcast {
    /// `window`, `wave`, `status`, `events` or `alive`.
    pub event: &'static str,
    /// The message.
    pub json: Arc<str>,
}

impl Broadcast {
    /// `None` never: no message has a key that is no text.
    pub(super) fn of<T: Serialize>(event: &'static str, message: &T) -> Option<Broadcast> {
        let json = serde_json::to_string(message).ok()?;
        Some(Broadcast {
            event,
            json: json.into(),
        })
    }
}

/// What a page may ask of the source.
#[derive(Clone, Debug)]
pub enum Request {
    /// Exactly these faults are in force.
    Faults(Vec<SwitchedFault>),
    /// Source seconds per second on the wall.
    Speed(f64),
    /// Stop or go on.
    Pause(bool),
    /// Go to an instant of a recording, s.
    Seek(f64),
    /// Judge with another motor from now on.
    Motor(Box<MotorFile>),
    /// All events have been seen.
    Acknowledge(Acknowledgement),
}

/// Understood, and not possible.
const UNPROCESSABLE: u16 = 422;

/// Why a request was refused.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refusal {
    /// Status of the answer.
    #[serde(skip)]
    pub status: u16,
    /// In words for the person at the page.
    pub message: String,
    /// Which fields of the page are to blame.
    pub problems: Vec<FieldProblem>,
}

/// A request on its way to the source's thread; `None` ends it.
pub(super) type Command = Option<(Request, oneshot::Sender<Result<(), Refusal>>)>;

/// Everything about the source that does not change with every window.
#[derive(Clone, Debug, Serialize)]
pub struct Status {
    /// Another number after each start of the server.
    pub session: u64,
    /// The source.
    pub source: SourceInfo,
    /// Name of the motor file; `None` without one.
    pub motor: Option<String>,
    /// Its parameters as inputs.
    pub fields: Vec<Field>,
    /// Thresholds of r1..r4, percent of their scales.
    pub threshold_percent: Option<[f64; 4]>,
    /// Whether the motor was calibrated.
    pub calibrated: bool,
    /// Rated values, for scales: phase voltage and current amplitude, V and A.
    pub rated: Option<[f64; 2]>,
    /// Every switch of the page; empty where faults cannot be switched.
    pub switches: Vec<PanelFault>,
    /// Faults in force.
    pub faults: Vec<SwitchedFault>,
    /// Source seconds per second on the wall.
    pub speed: f64,
    /// The source stands still.
    pub paused: bool,
    /// A recording has been played to its end.
    pub ended: bool,
    /// Why nothing comes; `None` while all is well.
    pub failure: Option<String>,
    /// Time on the wall by which the source could not keep up, s.
    pub behind_s: f64,
}

/// What the source's thread and the server share.
#[derive(Debug)]
pub struct Shared {
    pub(super) status: Mutex<Status>,
    pub(super) history: Mutex<History>,
    pub(super) events: Mutex<Events>,
    /// The motor that is judged with.
    pub(super) motor: Mutex<Option<MotorFile>>,
    pub(super) stream: broadcast::Sender<Broadcast>,
    /// What was shown last, for a page that comes while the source rests.
    pub(super) shown: Mutex<Shown>,
}

/// The last window and the last supply period.
#[derive(Debug, Default)]
pub(super) struct Shown {
    pub window: Option<WindowMessage>,
    pub wave: Option<WaveMessage>,
}

/// A running source.
#[derive(Debug)]
pub struct Session {
    /// What it shares with the server.
    pub(super) shared: Arc<Shared>,
    commands: mpsc::Sender<Command>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

/// Poisoned only by a panic in a lock's few lines; what was written until then is still sound.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Starts a source on its own thread, judged with `motor`.
///
/// # Errors
/// A motor whose values do not fit the core.
pub fn start(
    source: Box<dyn Source>,
    motor: Option<MotorFile>,
    speed: f64,
) -> Result<Session, monitor::ConfigError> {
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

impl Refusal {
    /// Without a field to blame.
    pub fn of(message: impl Into<String>) -> Refusal {
        Refusal {
            status: UNPROCESSABLE,
            message: message.into(),
            problems: Vec::new(),
        }
    }
}

impl Status {
    fn new(source: &dyn Source, motor: Option<&MotorFile>, speed: f64) -> Status {
        let info = source.info();
        let mut status = Status {
            session: session_number(),
            switches: match info.can.faults {
                true => PANEL_FAULTS().to_vec(),
                false => Vec::new(),
            },
            source: info,
            motor: None,
            fields: Vec::new(),
            threshold_percent: None,
            calibrated: false,
            rated: None,
            faults: Vec::new(),
            speed,
            paused: false,
            ended: false,
            failure: None,
            behind_s: 0.0,
        };
        if let Some(motor) = motor {
            status.judge_with(motor);
        }
        status
    }

    /// No window is due.
    pub fn rests(&self) -> bool {
        self.paused || self.ended
    }

    /// Shows another motor.
    pub(super) fn judge_with(&mut self, motor: &MotorFile) {
        let plate = &motor.nameplate;
        self.motor = Some(motor.name.clone());
        self.fields = fields(motor);
        self.threshold_percent = Some(motor.monitor.threshold_percent);
        self.calibrated = motor.healthy.is_some();
        self.rated = Some([plate.phase_voltage_amplitude(), plate.current_amplitude()]);
    }
}

/// Seconds since 1970.
pub(super) fn unix_s() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

/// Milliseconds since 1970: another one after each start.
fn session_number() -> u64 {
    (1e3 * unix_s()) as u64
}
