//! What the source's thread and the server share, and what they tell each other.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{SystemTime, UNIX_EPOCH};

use motor::MotorFile;
use serde::Serialize;
use tokio::sync::{broadcast, oneshot};

use crate::running::events::{Acknowledgement, Events};
use crate::running::fields::{Field, FieldProblem, fields};
use crate::running::history::History;
use crate::running::message::WindowMessage;
use crate::running::wave::WaveMessage;
use crate::source::{PANEL_FAULTS, PanelFault, Source, SourceInfo, SwitchedFault};

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
    pub(crate) fn of<T: Serialize>(event: &'static str, message: &T) -> Option<Broadcast> {
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
pub(crate) type Command = Option<(Request, oneshot::Sender<Result<(), Refusal>>)>;

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
    pub(crate) status: Mutex<Status>,
    pub(crate) history: Mutex<History>,
    pub(crate) events: Mutex<Events>,
    /// The motor that is judged with.
    pub(crate) motor: Mutex<Option<MotorFile>>,
    pub(crate) stream: broadcast::Sender<Broadcast>,
    /// What was shown last, for a page that comes while the source rests.
    pub(crate) shown: Mutex<Shown>,
}

/// The last window and the last supply period.
#[derive(Debug, Default)]
pub(crate) struct Shown {
    pub window: Option<WindowMessage>,
    pub wave: Option<WaveMessage>,
}

/// Poisoned only by a panic in a lock's few lines; what was written until then is still sound.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
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
    pub(crate) fn new(source: &dyn Source, motor: Option<&MotorFile>, speed: f64) -> Status {
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
    pub(crate) fn judge_with(&mut self, motor: &MotorFile) {
        let plate = &motor.nameplate;
        self.motor = Some(motor.name.clone());
        self.fields = fields(motor);
        self.threshold_percent = Some(motor.monitor.threshold_percent);
        self.calibrated = motor.healthy.is_some();
        self.rated = Some([plate.phase_voltage_amplitude(), plate.current_amplitude()]);
    }
}

/// Seconds since 1970.
pub(crate) fn unix_s() -> f64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

/// Milliseconds since 1970: another one after each start.
fn session_number() -> u64 {
    (1e3 * unix_s()) as u64
}
