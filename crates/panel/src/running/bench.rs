//! Samples through the core, and what follows from its reports.

use std::sync::Arc;
use std::time::{Duration, Instant as WallTime};

use document::FileError;
use monitor::{Beside, ConfigError, LoadKind, Monitor, MonitorState, Rehearsal, Report};
use motion::{Companion, MotionSample};
use motor::MotorFile;
use recording::{LoadTorque, Sensors};
use serde::Serialize;

use crate::running::events::Belief;
use crate::running::message::{Plate, WindowMessage};
use crate::running::shared::{Broadcast, Shared, locked, unix_s};
use crate::running::wave::Wave;
use crate::source::{Instant, Item, Reading, Source};

/// Between two waveforms.
const WAVE: Duration = Duration::from_millis(200);

/// Why a motor cannot be judged.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum MotorError {
    /// A value outside the core's range.
    #[error(transparent)]
    Value(#[from] ConfigError),
    /// Effects that the core cannot take.
    #[error(transparent)]
    Effects(#[from] FileError),
}

/// Everything that judges.
pub(crate) struct Bench {
    monitor: Option<Monitor>,
    state: MonitorState,
    /// Judges in motion; made with the first sample, which says in what units the source delivers.
    companion: Option<Companion>,
    plate: Plate,
    belief: Belief,
    sequence: u64,
    wave: Wave,
    wave_sent: WallTime,
    shared: Arc<Shared>,
}

impl Bench {
    /// # Errors
    /// A motor whose values do not fit the core.
    pub fn new(
        source: &dyn Source,
        motor: Option<&MotorFile>,
        shared: Arc<Shared>,
    ) -> Result<Bench, MotorError> {
        let config = source.config(motor)?;
        let monitor = config.map(Monitor::new).transpose()?;
        let plate = plate(source, monitor.as_ref(), motor.is_some());
        Ok(Bench {
            belief: belief(source, motor, plate.load_friction),
            plate,
            monitor,
            state: MonitorState::default(),
            companion: None,
            sequence: 0,
            wave: Wave::default(),
            wave_sent: WallTime::now(),
            shared,
        })
    }

    /// Judges with another motor; the supply is found anew.
    pub fn judge_with(&mut self, source: &dyn Source, motor: &MotorFile, monitor: Monitor) {
        self.plate = plate(source, Some(&monitor), true);
        self.belief = belief(source, Some(motor), self.plate.load_friction);
        self.monitor = Some(monitor);
        self.restart_judging();
    }

    /// Sensor faults that are rehearsed from the next window on.
    pub fn rehearse(&mut self, rehearsal: Rehearsal) {
        self.state.rehearse(rehearsal);
    }

    /// The source has gone elsewhere.
    pub fn restart(&mut self) {
        self.restart_judging();
        self.wave.clear();
    }

    fn restart_judging(&mut self) {
        self.state = MonitorState::default();
        self.companion = None;
    }

    /// Takes what the source delivers.
    pub fn take(&mut self, item: Item) {
        match item {
            Item::Sample(instant, reading) => self.sample(&instant, &reading),
            Item::Judged(window) => self.tell(*window),
            Item::Capture(recording) => {
                locked(&self.shared.events).keep_captured(*recording);
                self.tell_events();
            }
        }
    }

    fn sample(&mut self, instant: &Instant, reading: &Reading) {
        self.wave.sample(instant);
        if locked(&self.shared.events).sample(instant, &self.belief) {
            self.tell_events();
        }
        let Some(monitor) = &self.monitor else {
            return;
        };
        let companion = self.companion.get_or_insert_with(|| match reading {
            Reading::Raw(_) => Companion::new(monitor.config()),
            Reading::Si(..) => Companion::of_samples(monitor.config()),
        });
        let report = match reading {
            Reading::Raw(raw) => monitor.update_raw_beside(&mut self.state, raw, companion),
            Reading::Si(sample, gap) => {
                if *gap {
                    self.state.resume_after_gap();
                    companion.resume_after_gap();
                }
                let report = monitor.update(&mut self.state, sample);
                companion.take_sample(&MotionSample {
                    sample: *sample,
                    supply: self.state.supply(),
                });
                report.map(|report| Report {
                    moving: companion.window(&report),
                    ..report
                })
            }
        };
        if let Some(report) = report {
            self.report(instant.t_s, &report);
        }
    }

    fn report(&mut self, t_s: f64, report: &Report) {
        self.tell(WindowMessage::new(0, t_s, report, &self.plate));
        if self.wave_sent.elapsed() < WAVE {
            return;
        }
        if let Some(period) = self.wave.period(report) {
            self.wave_sent = WallTime::now();
            self.shared.tell("wave", &period);
            locked(&self.shared.shown).wave = Some(period);
        }
    }

    fn tell(&mut self, mut window: WindowMessage) {
        window.sequence = self.sequence;
        self.sequence += 1;
        locked(&self.shared.history).push(&window);
        let happened = locked(&self.shared.events).window(&window, unix_s());
        self.shared.tell("window", &window);
        locked(&self.shared.shown).window = Some(window);
        if happened {
            self.tell_events();
        }
    }

    /// Tells every page what happened.
    pub fn tell_events(&self) {
        let list = locked(&self.shared.events).list();
        self.shared.tell("events", &list);
    }
}

impl Shared {
    /// Hands a message to all listeners; never waits.
    pub(crate) fn tell<T: Serialize>(&self, event: &'static str, message: &T) {
        if self.stream.receiver_count() == 0 {
            return;
        }
        if let Some(message) = Broadcast::of(event, message) {
            // The listener may have gone in this moment.
            let _ = self.stream.send(message);
        }
    }
}

fn plate(source: &dyn Source, monitor: Option<&Monitor>, known: bool) -> Plate {
    let config = monitor.map(Monitor::config);
    Plate {
        rated_torque: config.map_or(f32::NAN, |config| config.rated_torque),
        pole_pairs: config.map_or(f32::NAN, |config| config.mechanics.n_p),
        frame: config.map_or(monitor::Frame::default(), |config| config.frame),
        load_friction: config.is_some_and(|config| config.load == LoadKind::Friction),
        known: known && config.is_some(),
        audit: source.info().audit,
    }
}

fn belief(source: &dyn Source, motor: Option<&MotorFile>, friction: bool) -> Belief {
    let sensors = motor.map(|motor| Sensors {
        voltage_full_scale_volt: Some(motor.sensors.voltage_full_scale_volt),
        current_full_scale_amp: Some(motor.sensors.current_full_scale_amp),
        adc_bits: Some(motor.sensors.adc_bits),
        ..Sensors::default()
    });
    Belief {
        name: source.info().name,
        load: match friction && motor.is_some() {
            true => LoadTorque::Friction,
            false => LoadTorque::Free,
        },
        sensors: sensors.unwrap_or_default(),
    }
}
