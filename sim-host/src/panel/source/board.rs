//! A running board: windows that it has judged, and the samples around its alarms.

use std::time::{Duration, Instant as WallTime};

use ::board::{Frame, Message};
use monitor::MonitorConfig;
use motor::MotorFile;

use super::{Can, Item, Source, SourceFailure, SourceInfo};
use crate::live::{Collector, Decoder, Source as Link, recording};
use crate::panel::message::{LampsMessage, Operation, WindowMessage, rms, slip_percent};
use crate::words;

/// s; sampling time of the board.
const T_SAMPLE: f64 = 1e-4;
/// Silence after which the board is taken not to be there.
const SILENCE: Duration = Duration::from_secs(3);

/// A board behind a serial port or a debug probe.
pub struct BoardSource {
    link: Box<dyn Link>,
    name: String,
    motor: Option<MotorFile>,
    decoder: Decoder,
    collector: Collector,
    now_s: f64,
    heard: WallTime,
}

impl BoardSource {
    /// Listens to an open link; the motor file gives slip and the captures their units.
    pub fn new(link: Box<dyn Link>, name: String, motor: Option<MotorFile>) -> BoardSource {
        BoardSource {
            link,
            name,
            motor,
            decoder: Decoder::default(),
            collector: Collector::default(),
            now_s: 0.0,
            heard: WallTime::now(),
        }
    }

    fn window(&mut self, frame: &Frame) -> Item {
        self.now_s = frame.sample_index as f64 * T_SAMPLE;
        let pole_pairs = self.motor.as_ref().map(|motor| motor.mechanics.n_p as f32);
        Item::Judged(Box::new(WindowMessage {
            t_s: self.now_s,
            lamps: LampsMessage::from_order(std::array::from_fn(|k| frame.lamp(k))),
            not_judged: words::reason(frame.not_judged),
            r_percent: frame.residuals.map(|r| r.map(|r| 100.0 * r)),
            r_over_threshold: frame.residuals.zip(self.motor.as_ref()).map(|(r, motor)| {
                let thresholds = motor.monitor.threshold_percent;
                std::array::from_fn(|k| Some(100.0 * r[k] / thresholds[k] as f32))
            }),
            operation: operation(frame, pole_pairs),
            ..WindowMessage::default()
        }))
    }
}

fn operation(frame: &Frame, pole_pairs: Option<f32>) -> Operation {
    let omega = frame.omega_sync_rad_s;
    let turning = (omega > 0.0).then_some(omega);
    Operation {
        voltage_rms_volt: rms(frame.u_s_volt),
        current_rms_amp: rms(frame.i_s_amp),
        frequency_hz: turning.map(|omega| omega / std::f32::consts::TAU),
        speed_rad_s: frame.omega_mech_rad_s,
        slip_percent: turning
            .zip(frame.omega_mech_rad_s.zip(pole_pairs))
            .map(|(omega, (speed, n_p))| slip_percent(omega, speed * n_p)),
        ..Operation::default()
    }
}

impl Source for BoardSource {
    fn info(&self) -> SourceInfo {
        SourceInfo {
            kind: "board",
            name: self.name.clone(),
            sample_rate_hz: 1.0 / T_SAMPLE,
            span_s: None,
            can: Can::default(),
            audit: Vec::new(),
        }
    }

    fn now_s(&self) -> f64 {
        self.now_s
    }

    fn advance(&mut self, _: f64, take: &mut dyn FnMut(Item)) -> Result<bool, SourceFailure> {
        let bytes = self
            .link
            .read()
            .map_err(|error| SourceFailure(error.to_string()))?;
        for message in self.decoder.take(&bytes) {
            self.heard = WallTime::now();
            match message {
                Message::Window(frame) => take(self.window(&frame)),
                Message::Capture(piece) => {
                    let fetched = self.collector.take(piece).zip(self.motor.as_ref());
                    let kept = fetched.and_then(|(fetched, motor)| recording(&fetched, motor).ok());
                    kept.into_iter()
                        .for_each(|kept| take(Item::Capture(Box::new(kept))));
                }
            }
        }
        if self.heard.elapsed() > SILENCE {
            let why = "no frame came for 3 s: is this the board's port, is its speed right, and is the board running?";
            self.heard = WallTime::now();
            return Err(SourceFailure(why.into()));
        }
        Ok(true)
    }

    fn config(&self, _: Option<&MotorFile>) -> Option<MonitorConfig> {
        None
    }
}
