//! What the lamps would have shown.

use std::borrow::Cow;

use audit::{Audit, Expectation, audit};
use monitor::{ConfigError, Monitor};
use motor::{FileError, MotorFile};
use recording::Recording;
use replay::{
    Direction, LampState, MotionSummary, NotJudgedShare, RotorSummary, Samples, SequenceSummary,
    Timeline, Verdict, VerdictState, WindowOperation, WindowResiduals,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

/// Everything that a replay through the board's core says.
#[derive(Clone, Debug)]
pub struct Monitored {
    /// The recording.
    pub recording: String,
    /// What had to be assumed to read it.
    pub assumptions: Vec<String>,
    /// What the audit found.
    pub audit: Audit,
    /// Every window; empty where the audit refused.
    pub timeline: Timeline,
    /// The verdict on the windows at rest.
    pub verdict: Verdict,
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
    /// Windows of the replay.
    windows: u64,
    /// Of these judged: the motor was at rest and every sensor was trusted.
    judged: u64,
    /// Why windows were not judged, the most frequent reason first.
    not_judged: &'a [NotJudgedShare],
    /// Residuals r1 to r4 over the judged windows; `null` where no window was judged.
    residual_percent: Option<ResidualPercent>,
    /// The lamps, from each change on.
    lamps: &'a [LampState],
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
    /// Residuals of every window.
    residuals: &'a [WindowResiduals],
    /// Operating point of every window.
    operation: &'a [WindowOperation],
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
        let expectation = motor.map_or_else(Expectation::default, Expectation::from);
        let audit = audit(recording, &expectation);
        let config = match motor {
            Some(motor) => replay::config_for(motor, recording).map_err(MonitorError::File)?,
            None => replay::stand_in_config(recording),
        };
        let timeline = if audit.supported {
            let monitor = Monitor::new(config).map_err(MonitorError::Config)?;
            replayed(&monitor, recording, &audit, motor.is_some(), progress)
        } else {
            Timeline::default()
        };
        Ok(Monitored {
            recording: recording.name().to_owned(),
            assumptions: recording.assumptions.clone(),
            verdict: timeline.verdict(&audit.findings),
            audit,
            timeline,
            threshold_percent: motor.map(|motor| motor.monitor.threshold_percent),
        })
    }
}

impl Monitored {
    /// What the recording comes to: FAULT at rest or in motion; healthy where either was judged and neither lit.
    pub fn state(&self) -> VerdictState {
        let motion = &self.timeline.motion;
        match self.verdict.state {
            _ if motion.is_fault() => VerdictState::Fault,
            VerdictState::NotJudged if motion.judged > 0 => VerdictState::Healthy,
            state => state,
        }
    }
}

fn replayed(
    monitor: &Monitor,
    recording: &Recording,
    audit: &Audit,
    motor_known: bool,
    progress: &mut dyn FnMut(usize),
) -> Timeline {
    let mut samples = Samples::new(recording, audit);
    if !motor_known {
        samples.leave_out_speed();
    }
    let mut timeline = replay::replay(monitor, &samples, progress);
    if !motor_known {
        timeline.blame_missing_motor_file();
    }
    timeline
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
            state: self.state(),
            windows: timeline.windows,
            judged: timeline.judged,
            not_judged: &timeline.not_judged,
            residual_percent: residual_percent.map(|(mean, standard_deviation)| ResidualPercent {
                mean,
                standard_deviation,
            }),
            lamps: &timeline.lamps,
            verdict: &self.verdict,
            direction: timeline.direction(),
            first_alarm_s: timeline.first_alarm_s,
            sequence: timeline.sequence(),
            rotor: timeline.rotor(),
            threshold_percent: self.threshold_percent,
            smallest_visible_percent: timeline.visible_percent(),
            residuals: &timeline.trace.residuals,
            operation: &timeline.trace.operation,
            motion: &timeline.motion,
        };
        json.serialize(serializer)
    }
}
