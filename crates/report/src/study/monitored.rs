//! What the lamps would have shown.

use std::borrow::Cow;

use audit::{Audit, Expectation, Merger, audit};
use monitor::{ConfigError, Monitor, MonitorConfig, Report};
use motor::{FileError, MotorFile};
use recording::Recording;
use replay::check::{CheckDoubt, Doubting};
use replay::{
    BeyondCalibration, Direction, LampState, MotionSummary, NotJudgedShare, Replay, RotorSummary,
    Samples, SequenceSummary, Timeline, Verdict, VerdictState, WindowOperation, WindowResiduals,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

/// Everything that a replay through the board's core says.
#[derive(Clone, Debug)]
pub struct Monitored {
    /// The recording.
    pub recording: String,
    /// Time from its first to its last sample, s.
    pub duration_s: f64,
    /// Median time between two samples, s; of many pieces that of the first.
    pub t_sample: f64,
    /// What had to be assumed to read it.
    pub assumptions: Vec<String>,
    /// What the audit found.
    pub audit: Audit,
    /// The windows; empty where the audit refused.
    pub timeline: Timeline,
    /// The verdict on the windows at rest.
    pub verdict: Verdict,
    /// What the recording comes to, at rest and in motion together.
    pub state: VerdictState,
    /// What does not fit a motor in good order although no lamp lit.
    pub doubts: Vec<CheckDoubt>,
    /// Thresholds of the motor file, percent of each residual's scale.
    pub threshold_percent: Option<[f64; 4]>,
}

/// Why a recording was not replayed.
#[derive(Debug)]
pub enum MonitorError {
    /// The motor file holds what the core does not take.
    File(FileError),
    /// Its values do not fit the core.
    Config(ConfigError),
}

/// What the lamps would have shown of a recording.
#[derive(Serialize, JsonSchema)]
struct MonitorJson<'a> {
    /// The recording.
    recording: &'a str,
    /// What had to be assumed to read it.
    assumptions: &'a [String],
    /// What the audit found.
    audit: &'a Audit,
    /// What the recording comes to, at rest and in motion together.
    state: VerdictState,
    /// What does not fit a motor in good order although no lamp lit.
    doubts: &'a [CheckDoubt],
    /// Windows of the replay.
    windows: u64,
    /// Of these judged: the motor was at rest and every sensor was trusted.
    judged: u64,
    /// Why windows were not judged, the most frequent reason first.
    not_judged: &'a [NotJudgedShare],
    /// Residuals r1 to r4 over the judged windows; `null` where no window was judged.
    residual_percent: Option<ResidualPercent>,
    /// The lamps, from each change on; of a long recording the first ten thousand changes.
    lamps: &'a [LampState],
    /// Changes of the lamps that are not in `lamps`; absent where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    further_lamp_changes: Option<u64>,
    /// Judged windows beyond the currents, voltages and frequencies of the motor's calibration.
    beyond_calibration: BeyondCalibration,
    /// The verdict on the windows at rest, and the likely causes.
    verdict: &'a Verdict,
    /// Sense of rotation of the supply; `null` where it was not seen.
    direction: Option<Direction>,
    /// Time of the recording at which FAULT first lit at rest, s; `null` where it never did.
    first_alarm_s: Option<f64>,
    /// Positive and negative sequence of voltage and current.
    sequence: SequenceSummary,
    /// The rotor cage, from the sidebands of the current.
    rotor: RotorSummary,
    /// Thresholds of r1 to r4, percent of each residual's scale; `null` without a motor file.
    threshold_percent: Option<[f64; 4]>,
    /// Smallest residuals that would have lit a lamp in the noise of this recording, percent of each residual's scale.
    smallest_visible_percent: Option<[f64; 4]>,
    /// Residuals of every window, or of one of `one_window_of`.
    residuals: &'a [WindowResiduals],
    /// Operating point of every window, or of one of `one_window_of`.
    operation: &'a [WindowOperation],
    /// `residuals` and `operation` hold one of so many windows; absent where they hold all.
    #[serde(skip_serializing_if = "Option::is_none")]
    one_window_of: Option<u64>,
    /// What was judged while something changed.
    motion: &'a MotionSummary,
}

/// Residuals over the judged windows, percent of their scales.
#[derive(Serialize, JsonSchema)]
struct ResidualPercent {
    /// Means of r1 to r4.
    mean: [f64; 4],
    /// Standard deviations of r1 to r4.
    standard_deviation: [f64; 4],
}

impl Monitored {
    /// Replays a recording; without a motor file only audit and sequence components are told. `progress` gets the number of
    /// samples done.
    ///
    /// # Errors
    /// A motor file that the core cannot take.
    pub fn new(
        recording: &Recording,
        motor: Option<&MotorFile>,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Monitored, MonitorError> {
        let mut monitoring = Monitoring::new(motor);
        monitoring.take(recording, progress)?;
        Ok(monitoring.finish())
    }
}

/// A recording that is monitored piece by piece, and of which no sample is kept.
pub struct Monitoring<'m> {
    motor: Option<&'m MotorFile>,
    expectation: Expectation,
    merger: Merger,
    /// As the motor file and the first piece say.
    config: Option<MonitorConfig>,
    replay: Option<Replay>,
    doubting: Option<Doubting>,
    first: Option<First>,
    end_s: f64,
}

/// What the first piece tells of the recording.
#[derive(Default)]
struct First {
    name: String,
    begin_s: f64,
    t_sample: f64,
}

impl<'m> Monitoring<'m> {
    /// Before the first piece; without a motor file only audit and sequence components are told.
    pub fn new(motor: Option<&'m MotorFile>) -> Monitoring<'m> {
        Monitoring {
            motor,
            expectation: motor.map_or_else(Expectation::default, Expectation::from),
            merger: Merger::default(),
            config: None,
            replay: None,
            doubting: motor.map(Doubting::new),
            first: None,
            end_s: 0.0,
        }
    }

    /// Takes the next piece. Each is audited by itself; one that the audit refuses is passed over, as time without samples.
    /// `progress` gets the number of its samples that are done.
    ///
    /// # Errors
    /// A motor file that the core cannot take.
    pub fn take(
        &mut self,
        piece: &Recording,
        progress: &mut dyn FnMut(usize),
    ) -> Result<(), MonitorError> {
        self.follow(piece, &mut |done, _, _| progress(done))
    }

    /// The same; `look` gets the number of the piece's samples that are done, the time, s, and the report of each window.
    ///
    /// # Errors
    /// As [`Monitoring::take`].
    pub fn follow(
        &mut self,
        piece: &Recording,
        look: &mut dyn FnMut(usize, f64, &Report),
    ) -> Result<(), MonitorError> {
        let audit = audit(piece, &self.expectation);
        let is_usable = self.merger.add(piece, &audit);
        self.first.get_or_insert_with(|| First {
            name: piece.name().to_owned(),
            begin_s: piece.t()[0],
            t_sample: piece.t_sample(),
        });
        self.end_s = piece.t()[piece.len() - 1];
        // Scales of an unknown motor come from a piece in which it is supplied.
        let is_supplied = audit.has_supply() || self.motor.is_some();
        if self.config.is_none() && is_supplied {
            self.config = Some(self.config_for(piece)?);
        }
        let Some(config) = self.config.filter(|_| is_usable) else {
            return Ok(());
        };
        let mut samples = Samples::new(piece, &audit);
        if self.motor.is_none() {
            samples.leave_out_speed();
        }
        let replay = match &mut self.replay {
            Some(replay) => replay,
            none => {
                let monitor = Monitor::new(config).map_err(MonitorError::Config)?;
                none.insert(Replay::new(monitor))
            }
        };
        let doubting = &mut self.doubting;
        replay.follow(samples, &mut |done, t, report| {
            if let Some(doubting) = doubting {
                doubting.add(t, report, &config);
            }
            look(done, t, report);
        });
        Ok(())
    }

    fn config_for(&self, piece: &Recording) -> Result<MonitorConfig, MonitorError> {
        match self.motor {
            Some(motor) => replay::config_for(motor, piece).map_err(MonitorError::File),
            None => Ok(replay::stand_in_config(piece)),
        }
    }

    /// What all pieces come to.
    pub fn finish(self) -> Monitored {
        let audit = self.merger.finish();
        let first = self.first.unwrap_or_default();
        let replay = self.replay.filter(|_| audit.supported);
        let mut timeline = replay.map_or_else(Timeline::default, Replay::finish);
        if self.motor.is_none() && audit.supported {
            timeline.blame_missing_motor_file();
        }
        let verdict = timeline.verdict(&audit.findings);
        let state = timeline.state(verdict.state, &timeline.motion);
        let doubting = self.doubting.filter(|_| audit.supported);
        let (state, doubts) = doubting.map_or((state, Vec::new()), |doubting| {
            doubting.finish(&timeline, &timeline.motion, state, &audit.findings)
        });
        Monitored {
            recording: first.name,
            duration_s: self.end_s - first.begin_s,
            t_sample: first.t_sample,
            assumptions: audit.assumptions.clone(),
            verdict,
            state,
            doubts,
            audit,
            timeline,
            threshold_percent: self.motor.map(|motor| motor.monitor.threshold_percent),
        }
    }
}

impl JsonSchema for Monitored {
    fn schema_name() -> Cow<'static, str> {
        "Monitored".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        MonitorJson::json_schema(generator)
    }
}

impl Serialize for Monitored {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let timeline = &self.timeline;
        let residual_percent = timeline.residual_percent();
        let json = MonitorJson {
            recording: &self.recording,
            assumptions: &self.assumptions,
            audit: &self.audit,
            state: self.state,
            doubts: &self.doubts,
            windows: timeline.windows,
            judged: timeline.judged,
            not_judged: &timeline.not_judged,
            beyond_calibration: timeline.beyond,
            residual_percent: residual_percent.map(|(mean, standard_deviation)| ResidualPercent {
                mean,
                standard_deviation,
            }),
            lamps: &timeline.lamps,
            further_lamp_changes: Some(timeline.further_changes).filter(|n| *n > 0),
            verdict: &self.verdict,
            direction: timeline.direction(),
            first_alarm_s: timeline.first_alarm_s,
            sequence: timeline.sequence(),
            rotor: timeline.rotor(),
            threshold_percent: self.threshold_percent,
            smallest_visible_percent: timeline.visible_percent(),
            residuals: &timeline.trace.residuals,
            operation: &timeline.trace.operation,
            one_window_of: Some(timeline.trace.every()).filter(|n| *n > 1),
            motion: &timeline.motion,
        };
        json.serialize(serializer)
    }
}
