//! A recording that is checked piece by piece, and of which no sample is kept.

use audit::{Audit, Code, Expectation, Finding, Merger, audit};
use monitor::Monitor;
use motor::MotorFile;
use recording::{Channel, Recording};

use super::caveat::caveat;
use super::clamp::{ClampSignal, clamp_signals};
use super::doubts::{Doubting, reasons};
use super::{BlindSpot, Checked, Told, blind, blind_spots, severity, todo};
use crate::speed::{EstimatedSpeed, with_estimated_speed};
use crate::{
    BeyondCalibration, MotionSummary, Replay, Samples, Timeline, config_for, replay, words,
};

/// Why a recording without a speed is not judged in motion.
const SPEED_IS_ESTIMATED: &str =
    "the speed is not recorded: an estimate is too slow for what changes within a cycle";

/// The pieces so far.
pub struct Checking<'m> {
    motor: &'m MotorFile,
    expectation: Expectation,
    /// Audits with the speed that was estimated, and of what was recorded.
    shown: Merger,
    recorded: Merger,
    replay: Option<Replay>,
    monitor: Option<Monitor>,
    /// What the first piece comes to where the audit refuses it: told where no other follows.
    refused: Option<Timeline>,
    speed: Option<Speed>,
    clamps: Clamps,
    blind: Vec<BlindSpot>,
    doubting: Doubting,
    pieces: u64,
}

/// Estimates of the speed, weighed by samples.
struct Speed {
    estimated: EstimatedSpeed,
    samples: f64,
}

/// Single channels: what the first piece says of them, and their sizes.
#[derive(Default)]
struct Clamps {
    first: Vec<ClampSignal>,
    /// Sum over the samples of the squares, of each channel.
    squares: Vec<f64>,
    latest_rms: Vec<f64>,
    samples: f64,
    pieces: u64,
}

impl<'m> Checking<'m> {
    /// Before the first piece.
    pub fn new(motor: &'m MotorFile) -> Checking<'m> {
        Checking {
            motor,
            expectation: Expectation::from(motor),
            shown: Merger::default(),
            recorded: Merger::default(),
            replay: None,
            monitor: None,
            refused: None,
            speed: None,
            clamps: Clamps::default(),
            blind: Vec::new(),
            doubting: Doubting::new(motor),
            pieces: 0,
        }
    }

    /// Takes the next piece; one that the audit refuses is passed over, as time without samples. `progress` gets the number of
    /// its samples that are done.
    ///
    /// # Errors
    /// A motor file or a recording that the core cannot take, in words.
    pub fn take(
        &mut self,
        recorded: &Recording,
        progress: &mut dyn FnMut(usize),
    ) -> Result<(), String> {
        let estimated = with_estimated_speed(recorded, self.motor);
        let shown = estimated.as_ref().map_or(recorded, |(shown, _)| shown);
        let audit = audit(shown, &self.expectation);
        let is_usable = self.shown.add(shown, &audit);
        if let Some((_, speed)) = &estimated {
            // An estimate is no channel of the recorder: the audit is about what was recorded.
            let own = audit::audit(recorded, &self.expectation);
            self.recorded.add(recorded, &own);
            self.note_speed(speed, recorded.len());
        }
        self.clamps.add(clamp_signals(recorded), recorded.len());
        if self.pieces == 0 {
            self.blind = blind_spots(recorded, self.motor, estimated.is_some());
        }
        self.pieces += 1;
        self.judge(shown, &audit, is_usable, progress)
    }

    fn judge(
        &mut self,
        shown: &Recording,
        audit: &Audit,
        is_usable: bool,
        progress: &mut dyn FnMut(usize),
    ) -> Result<(), String> {
        let monitor = match self.monitor {
            Some(monitor) => monitor,
            None => {
                let config = config_for(self.motor, shown).map_err(|error| error.to_string())?;
                *self
                    .monitor
                    .insert(Monitor::new(config).map_err(|error| error.to_string())?)
            }
        };
        let samples = Samples::new(shown, audit);
        if is_usable {
            let replay = self.replay.get_or_insert_with(|| Replay::new(monitor));
            let (doubting, config) = (&mut self.doubting, monitor.config());
            replay.follow(samples, &mut |done, t, report| {
                doubting.add(t, report, config);
                progress(done);
            });
        } else if self.pieces == 1 {
            self.refused = Some(replay(&monitor, &samples, progress));
        }
        Ok(())
    }

    fn note_speed(&mut self, new: &EstimatedSpeed, samples: usize) {
        let samples = samples as f64;
        match &mut self.speed {
            Some(speed) => speed.join(new, samples),
            None => {
                self.speed = Some(Speed {
                    estimated: new.clone(),
                    samples,
                });
            }
        }
    }

    /// What all pieces come to.
    pub fn finish(self) -> Checked {
        let shown = self.shown.finish();
        let timeline = match (self.replay, self.refused) {
            (Some(replay), _) => replay.finish(),
            (None, refused) => refused.filter(|_| self.pieces == 1).unwrap_or_default(),
        };
        let speed = self.speed.map(|speed| speed.estimated);
        let mut verdict = timeline.verdict(&shown.findings);
        let mut motion = timeline.motion.clone();
        if speed.is_some() {
            blind::forget_speed(&mut verdict);
            motion = MotionSummary::impossible(SPEED_IS_ESTIMATED);
        }
        if motion.not_possible.is_some() && !timeline.something_moved() {
            motion = MotionSummary::default();
        }
        let state = timeline.state(verdict.state, &motion);
        let reasons = not_judged(&timeline, &shown);
        let about = of_recorded(&shown, speed.is_some());
        let (state, doubts) = self.doubting.finish(&timeline, &motion, state, &about);
        let is_refused = !shown.supported;
        let clamps = self.clamps.finish();
        let mut answer = Checked {
            state,
            severity: severity::of(&verdict),
            todo: todo(self.motor, state, &verdict, &motion, &doubts),
            doubts,
            caveat: caveat(self.motor, &timeline, &verdict),
            motion,
            windows: [timeline.judged, timeline.windows],
            not_judged: match clamps.is_empty() {
                true => reasons,
                false => vec!["three voltages or three currents are needed".to_owned()],
            },
            clamps,
            visible_percent: timeline.visible_percent(),
            rotor: words::rotor(&timeline.rotor()),
            current_unbalance_percent: timeline.sequence().i2_over_i1.map(|x| 100.0 * x),
            beyond_calibration: timeline.beyond,
            blind: with_beyond(self.blind, &timeline.beyond),
            verdict,
            audit: match speed {
                Some(_) => self.recorded.finish(),
                None => shown,
            },
            speed,
            told: Told::default(),
            residuals: timeline.trace.residuals.to_vec(),
            operation: timeline.trace.operation.to_vec(),
        };
        if is_refused {
            answer.withdraw();
        }
        answer.told = Told::of(&answer);
        answer
    }
}

/// What cannot be seen, where the motor ran beyond what is known of it too.
fn with_beyond(mut blind: Vec<BlindSpot>, beyond: &BeyondCalibration) -> Vec<BlindSpot> {
    if beyond.windows > 0 {
        blind.push(blind::BEYOND);
    }
    blind
}

/// Why windows were not judged, or why there are none.
fn not_judged(timeline: &Timeline, shown: &Audit) -> Vec<String> {
    let between_gaps = shown.findings.iter().any(|one| one.code == Code::Gap);
    if timeline.windows == 0 && between_gaps {
        return vec![
            "no window fits between two gaps in time: record without lost samples".to_owned(),
        ];
    }
    reasons(timeline)
}

/// Findings without those of an estimated speed, which is no channel that anybody could mend.
fn of_recorded(shown: &Audit, is_estimated: bool) -> Vec<Finding> {
    let speed = Channel::SPEED.to_string();
    let recorded = shown.findings.iter();
    let recorded = recorded.filter(|finding| !is_estimated || finding.channel != speed);
    recorded.cloned().collect()
}

impl Speed {
    /// The means over both; as unsure as the less sure one.
    fn join(&mut self, new: &EstimatedSpeed, samples: f64) {
        let share = samples / (self.samples + samples);
        let known = &mut self.estimated;
        known.mean_rpm += share * (new.mean_rpm - known.mean_rpm);
        known.slip_percent += share * (new.slip_percent - known.slip_percent);
        if new.slip_half_width_percent > known.slip_half_width_percent {
            known.slip_half_width_percent = new.slip_half_width_percent;
            known.source = new.source;
        }
        if known.rotor_bars.is_empty() {
            known.rotor_bars.clone_from(&new.rotor_bars);
        }
        self.samples += samples;
    }
}

impl Clamps {
    fn add(&mut self, signals: Vec<ClampSignal>, samples: usize) {
        let samples = samples as f64;
        self.latest_rms = signals.iter().map(|signal| signal.rms).collect();
        self.squares.resize(signals.len(), 0.0);
        for (sum, rms) in self.squares.iter_mut().zip(&self.latest_rms) {
            *sum += samples * rms * rms;
        }
        self.samples += samples;
        self.pieces += 1;
        if self.pieces == 1 {
            self.first = signals;
        }
    }

    /// Of several pieces the size of all, and its change from the first to the last.
    fn finish(mut self) -> Vec<ClampSignal> {
        if self.pieces < 2 {
            return self.first;
        }
        let sizes = self.squares.iter().zip(&self.latest_rms);
        for (signal, (squares, latest)) in self.first.iter_mut().zip(sizes) {
            let begin = signal.rms.max(f64::MIN_POSITIVE);
            signal.change_percent = 100.0 * (latest / begin - 1.0);
            signal.rms = (squares / self.samples).sqrt();
        }
        self.first
    }
}
