//! One recording of many as one row of a table that other programs can read.

use formats::{PIECE_ROWS, read_in_pieces};
use parquet_derive::{ParquetRecordReader, ParquetRecordWriter};
use recording::{Error, Mapping, Recording, Source};
use replay::{VerdictState, WindowOperation};
use serde::Serialize;

use crate::study::{Job, MappedMotor, MonitorError, Monitored, Monitoring};

/// FAULT lit.
pub const FAULT: &str = "fault";
/// Judged, and FAULT never lit.
pub const HEALTHY: &str = "healthy";
/// No window could be judged.
pub const NOT_JUDGED: &str = "not-judged";
/// The file could not be read.
pub const NOT_READ: &str = "not-read";

/// One recording: what it was, and what the lamps said. Units stand in the names; a number that does not exist is NaN, a text
/// empty.
#[derive(Clone, Debug, Default, PartialEq, ParquetRecordReader, ParquetRecordWriter)]
pub struct Row {
    /// Path seen from the folder.
    pub recording: String,
    /// Motor file as the map names it.
    pub motor: String,
    /// `healthy`, `fault`, `not-judged` or `not-read`.
    pub state: String,
    /// Likeliest cause; empty without FAULT.
    pub fault: String,
    /// Phase of the cause, `a` to `c`; empty where it is not known.
    pub phase: String,
    /// Probability of the cause, 0 to 1.
    pub probability: f64,
    /// Causes, from the first, that the recording cannot tell apart.
    pub tied: u32,
    /// When FAULT first lit, s.
    pub first_alarm_s: f64,
    /// When FAULT was first raised in motion, s.
    pub motion_alarm_s: f64,
    /// What that alarm is put down to; empty where it was over before its cause could be told, and without one.
    pub motion_cause: String,
    /// Windows.
    pub windows: u32,
    /// Windows judged.
    pub judged_windows: u32,
    /// What does not fit, where that is why it is not judged; else why most of the windows that were not judged were not.
    pub not_judged: String,
    /// Codes of the audit's findings, a blank between them.
    pub findings: String,
    /// Samples.
    pub samples: u64,
    /// Length, s.
    pub duration_s: f64,
    /// Samples a second, Hz.
    pub sample_rate_hz: f64,
    /// Negative over positive sequence of the currents, percent.
    pub i2_over_i1_percent: f64,
    /// Negative over positive sequence of the voltages, percent.
    pub v2_over_v1_percent: f64,
    /// Mean of residual r1 over the judged windows, percent of its scale.
    pub r1_percent: f64,
    /// Mean of r2.
    pub r2_percent: f64,
    /// Mean of r3.
    pub r3_percent: f64,
    /// Mean of r4.
    pub r4_percent: f64,
    /// Positive sequence of the phase voltages, mean over the windows, V rms.
    pub voltage_rms_volt: f64,
    /// Positive sequence of the phase currents, mean over the windows, A rms.
    pub current_rms_amp: f64,
    /// Supply frequency, mean over the windows, Hz.
    pub frequency_hz: f64,
    /// Shaft speed, mean over the windows, rad/s.
    pub speed_rad_s: f64,
    /// Why the file was not read: file, line, column, remedy.
    pub error: String,
    /// Hash of the recording, what is read with it, its motor file, the flags and the program's version.
    pub fingerprint: String,
}

impl Row {
    /// Reads and judges one recording; a file that cannot be read is a row that says why. `fingerprint` is kept in it.
    pub fn judged(job: &Job, motor: &MappedMotor, mapping: &Mapping, fingerprint: &str) -> Row {
        let mut row = Row {
            recording: job.name.clone(),
            motor: motor.name.clone(),
            fingerprint: fingerprint.to_owned(),
            ..Row::without_numbers()
        };
        let mut monitoring = Monitoring::new(Some(&motor.file));
        let (mut samples, mut refused) = (0, None);
        let mut take = |piece: &Recording, _| {
            samples += piece.len() as u64;
            if refused.is_none() {
                refused = monitoring.take(piece, &mut |_| {}).err();
            }
            Ok::<(), Error>(())
        };
        match read_in_pieces(&job.path, mapping, PIECE_ROWS, &mut |_| {}, &mut take) {
            Ok(Source::Recording(_)) => row.judge(&monitoring.finish(), samples, refused, motor),
            Ok(Source::LoadTable(table)) => {
                row.state = NOT_JUDGED.to_owned();
                row.not_judged = "a load table has no waveforms".to_owned();
                row.samples = table.len() as u64;
            }
            Err(error) => row.not_read(&error),
        }
        row
    }

    fn without_numbers() -> Row {
        Row {
            probability: f64::NAN,
            first_alarm_s: f64::NAN,
            motion_alarm_s: f64::NAN,
            duration_s: f64::NAN,
            sample_rate_hz: f64::NAN,
            i2_over_i1_percent: f64::NAN,
            v2_over_v1_percent: f64::NAN,
            r1_percent: f64::NAN,
            r2_percent: f64::NAN,
            r3_percent: f64::NAN,
            r4_percent: f64::NAN,
            voltage_rms_volt: f64::NAN,
            current_rms_amp: f64::NAN,
            frequency_hz: f64::NAN,
            speed_rad_s: f64::NAN,
            ..Row::default()
        }
    }

    fn not_read(&mut self, error: &Error) {
        self.state = NOT_READ.to_owned();
        self.error = error.to_string();
    }

    fn judge(
        &mut self,
        monitored: &Monitored,
        samples: u64,
        refused: Option<MonitorError>,
        motor: &MappedMotor,
    ) {
        self.samples = samples;
        self.duration_s = monitored.duration_s;
        self.sample_rate_hz = 1.0 / monitored.t_sample;
        match refused {
            None => self.take(monitored),
            Some(error) => {
                self.state = NOT_JUDGED.to_owned();
                self.error = match error {
                    MonitorError::File(error) => error.to_string(),
                    MonitorError::Config(error) => format!("{}: {error}", motor.path.display()),
                };
            }
        }
    }

    fn take(&mut self, monitored: &Monitored) {
        let (timeline, verdict) = (&monitored.timeline, &monitored.verdict);
        self.state = match monitored.state {
            VerdictState::Healthy => HEALTHY,
            VerdictState::Fault => FAULT,
            VerdictState::NotJudged => NOT_JUDGED,
        }
        .to_owned();
        if let Some(first) = verdict.candidates.first() {
            self.fault = first.fault.to_string();
            self.phase = first.phase.unwrap_or_default().to_owned();
            self.probability = first.probability;
            self.tied = verdict.tied as u32;
        }
        self.first_alarm_s = timeline.first_alarm_s.unwrap_or(f64::NAN);
        if let Some(alarm) = timeline.motion.alarms.first() {
            self.motion_alarm_s = alarm.raised_s;
            self.motion_cause = alarm.words().unwrap_or_default();
        }
        self.windows = timeline.windows as u32;
        self.judged_windows = timeline.judged as u32;
        let most = timeline.not_judged.first();
        self.not_judged = match monitored.doubts.first() {
            Some(doubt) if self.state == NOT_JUDGED => format!("does not fit: {}", doubt.seen),
            _ => most.map_or_else(String::new, |share| share.reason.to_string()),
        };
        let codes = monitored.audit.findings.iter();
        self.findings = codes
            .filter_map(|finding| word(&finding.code))
            .collect::<Vec<_>>()
            .join(" ");
        self.measure(monitored);
    }

    fn measure(&mut self, monitored: &Monitored) {
        let timeline = &monitored.timeline;
        let sequence = timeline.sequence();
        let percent = |x: Option<f64>| x.map_or(f64::NAN, |x| 100.0 * x);
        self.i2_over_i1_percent = percent(sequence.i2_over_i1);
        self.v2_over_v1_percent = percent(sequence.v2_over_v1);
        if let Some(([r1, r2, r3, r4], _)) = timeline.residual_percent() {
            (self.r1_percent, self.r2_percent) = (r1, r2);
            (self.r3_percent, self.r4_percent) = (r3, r4);
        }
        let windows = &timeline.trace.operation;
        self.voltage_rms_volt = mean(windows, |one| one.voltage_rms_volt);
        self.current_rms_amp = mean(windows, |one| one.current_rms_amp);
        self.frequency_hz = mean(windows, |one| Some(one.frequency_hz));
        self.speed_rad_s = mean(windows, |one| one.speed_rad_s);
    }
}

/// The word that the JSON has for a value.
fn word(value: &impl Serialize) -> Option<String> {
    let value = serde_json::to_value(value).ok()?;
    value.as_str().map(str::to_owned)
}

/// Mean over the windows that have the quantity; NaN where none has.
fn mean(windows: &[WindowOperation], of: impl Fn(&WindowOperation) -> Option<f64>) -> f64 {
    let values = windows.iter().filter_map(of);
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    sum / count
}
