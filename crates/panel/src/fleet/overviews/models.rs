//! Models in force: by which motor file each motor is judged, since when it is calibrated, and whether that is due again.

use std::path::Path;
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use axum::extract::State;
use axum::response::Response;
use board::{EventCause, MotorImage};
use fleet::{BoardEvent, Entry, EntryFilter, MotorState, Reader, StoreError, now_ms};
use monitor::MonitorConfig;
use motor::MotorFile;
use schemars::JsonSchema;
use serde::Serialize;

use super::month::calendar::day;
use crate::fleet::plant::{DueRule, Plant};
use crate::fleet::questions::{answer, failed};

/// Events of a board that are searched for its newest calibration.
const SEARCHED: usize = 2_000;
const DAY_MS: i64 = 86_400_000;
/// Means of so long are compared: after the calibration, and now.
const COMPARED_MS: i64 = 7 * DAY_MS;

/// Which model each motor is judged by.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Models {
    /// When this was so, Unix ms.
    pub now_ms: i64,
    /// A calibration that is older than so many days is due.
    pub due_after_days: u32,
    /// A residual r1 or r4 that has moved by more than so much since the calibration is due, percent of its scale.
    pub due_drift_percent: f32,
    /// Motors, those that are due first.
    pub models: Vec<Model>,
}

/// The model of one motor.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Model {
    /// Name within the plant.
    pub id: String,
    /// What people call it.
    pub title: String,
    /// Where it is.
    pub place: String,
    /// Path of its motor file by the gateway's configuration; `null`: none is named.
    pub file: Option<String>,
    /// What the motor file calls the machine; empty: it could not be read.
    pub name: String,
    /// Effects of the motor file beyond the T model.
    pub effects: Vec<String>,
    /// Whether the motor file holds a calibration; `null`: not known.
    pub calibrated: Option<bool>,
    /// Checksum of the motor constants that the file makes, hexadecimal, as a board that holds them shows it.
    pub file_constants: Option<String>,
    /// Checksum of the motor constants by the board's newest event "configured"; `null`: it has told none.
    pub board_constants: Option<String>,
    /// Checksum of what the board learnt last, by its newest event "learnt"; `null`: it has told none.
    pub learnt: Option<String>,
    /// When the calibration was made, Unix ms; `null`: not known.
    pub calibrated_ms: Option<i64>,
    /// The same as a day in UTC, as 2026-03-01.
    pub calibrated_on: Option<String>,
    /// Who says so: `board` (it learnt), `file` (time of the motor file); empty: nobody.
    pub calibrated_by: &'static str,
    /// When it is due by its age, Unix ms.
    pub due_ms: Option<i64>,
    /// How far r1 or r4 has moved since, percent of its scale: means of seven days; `null`: not known.
    pub drift_percent: Option<f32>,
    /// Whether a calibration is due.
    pub due: bool,
    /// Why it is or what is not known, in words.
    pub why: String,
}

/// What a motor file says.
#[derive(Default)]
struct FileModel {
    name: String,
    effects: Vec<String>,
    calibrated: Option<bool>,
    constants: Option<String>,
    modified_ms: Option<i64>,
    problem: String,
}

pub(in crate::fleet) async fn models(State(plant): State<Arc<Plant>>) -> Response {
    answer(move || {
        let due = &plant.settings.due;
        all(&plant.reader, due, now_ms()).map_err(failed)
    })
    .await
}

/// The models of all motors, those that are due first.
///
/// # Errors
/// The store cannot be read.
pub(in crate::fleet) fn all(
    reader: &Reader,
    rule: &DueRule,
    now_ms: i64,
) -> Result<Models, StoreError> {
    let motors = reader.motors()?;
    let models = motors
        .iter()
        .map(|state| model(reader, rule, state, now_ms));
    let mut models: Vec<Model> = models.collect::<Result<_, _>>()?;
    models.sort_by(|a, b| (!a.due, &a.id).cmp(&(!b.due, &b.id)));
    Ok(Models {
        now_ms,
        due_after_days: rule.after_days,
        due_drift_percent: rule.drift_percent,
        models,
    })
}

fn model(
    reader: &Reader,
    rule: &DueRule,
    state: &MotorState,
    now_ms: i64,
) -> Result<Model, StoreError> {
    let info = &state.info;
    let file = info.motor_file.as_deref().map(Path::new);
    let of_file = file.map_or_else(FileModel::default, read);
    let filter = EntryFilter {
        motor: Some(info.id.clone()),
        ..EntryFilter::default()
    };
    let entries = reader.entries(&filter, SEARCHED)?;
    let newest = |cause: EventCause| {
        let mut events = entries.iter().filter_map(|stored| match &stored.entry {
            Entry::Event(event) => Some(event),
            _ => None,
        });
        events.find(|event| event.cause == cause as u16)
    };
    let (configured, learnt) = (newest(EventCause::Configured), newest(EventCause::Learnt));
    let first = |event: Option<&BoardEvent>| event.map(|event| hexadecimal(event.values[0]));
    let made_by_file = of_file
        .modified_ms
        .filter(|_| of_file.calibrated == Some(true));
    let (calibrated_ms, calibrated_by) = match (learnt, made_by_file) {
        (Some(event), file) if file.is_none_or(|file| event.time_ms >= file) => {
            (Some(event.time_ms), "board")
        }
        (_, Some(file)) => (Some(file), "file"),
        _ => (None, ""),
    };
    let mut model = Model {
        id: info.id.to_string(),
        title: info.title.clone(),
        place: info.place.clone(),
        file: info.motor_file.clone(),
        name: of_file.name,
        effects: of_file.effects,
        calibrated: of_file.calibrated,
        file_constants: of_file.constants,
        board_constants: first(configured),
        learnt: first(learnt),
        calibrated_ms,
        calibrated_on: calibrated_ms.map(day),
        calibrated_by,
        due_ms: calibrated_ms.map(|ms| ms + i64::from(rule.after_days) * DAY_MS),
        drift_percent: match calibrated_ms {
            Some(since_ms) => drift(reader, state, since_ms, now_ms)?,
            None => None,
        },
        due: false,
        why: String::new(),
    };
    (model.due, model.why) = judged(&model, rule, &of_file.problem, now_ms);
    Ok(model)
}

fn read(path: &Path) -> FileModel {
    let motor = match MotorFile::read(path) {
        Ok(motor) => motor,
        Err(error) => {
            return FileModel {
                problem: error.to_string(),
                ..FileModel::default()
            };
        }
    };
    let config = MonitorConfig::of_board(&motor);
    let modified = std::fs::metadata(path)
        .and_then(|meta| meta.modified())
        .ok();
    let since = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    FileModel {
        constants: config
            .ok()
            .map(|config| hexadecimal(MotorImage::new(&config).identification())),
        effects: motor
            .effects
            .iter()
            .map(|effect| effect.name.clone())
            .collect(),
        calibrated: Some(motor.healthy.is_some()),
        name: motor.name,
        modified_ms: since.and_then(|since| i64::try_from(since.as_millis()).ok()),
        problem: String::new(),
    }
}

fn hexadecimal(checksum: u32) -> String {
    format!("{checksum:08x}")
}

/// How far the means of r1 and r4 have moved from the first days after the calibration to the last days.
fn drift(
    reader: &Reader,
    state: &MotorState,
    since_ms: i64,
    now_ms: i64,
) -> Result<Option<f32>, StoreError> {
    if now_ms - since_ms < 2 * COMPARED_MS {
        return Ok(None);
    }
    let means = |from_ms: i64| -> Result<[Option<f32>; 2], StoreError> {
        let trend = reader.trend(&state.info.id, from_ms, from_ms + COMPARED_MS, 7)?;
        Ok([0, 3].map(|k| {
            let days = trend.points.iter().filter_map(|point| point.residuals[k]);
            let (sum, count) = days.fold((0.0, 0.0), |(sum, count), values| {
                (sum + values.mean, count + 1.0)
            });
            (count > 0.0).then(|| sum / count)
        }))
    };
    let (then, now) = (means(since_ms)?, means(now_ms - COMPARED_MS)?);
    let moved = then.into_iter().zip(now);
    let moved = moved.filter_map(|(then, now)| Some(100.0 * (now? - then?).abs()));
    Ok(moved.reduce(f32::max))
}

/// Whether a calibration is due, and why or what is not known.
fn judged(model: &Model, rule: &DueRule, problem: &str, now_ms: i64) -> (bool, String) {
    if let (Some(file), Some(board)) = (&model.file_constants, &model.board_constants)
        && file != board
    {
        let words = format!(
            "the board was configured with other constants ({board}) than the motor file makes ({file}): configure it again, \
             or name its file in the gateway's configuration"
        );
        return (true, words);
    }
    if model.due_ms.is_some_and(|due_ms| due_ms <= now_ms) {
        return (true, format!("older than {} days", rule.after_days));
    }
    if let Some(moved) = model
        .drift_percent
        .filter(|moved| *moved > rule.drift_percent)
    {
        return (
            true,
            format!("r1 or r4 has moved by {moved:.2} % of its scale"),
        );
    }
    if !problem.is_empty() {
        return (false, problem.to_owned());
    }
    match (&model.file, model.calibrated_ms) {
        (_, Some(_)) if model.calibrated_by == "file" => (
            false,
            "by the time of the motor file; the board has not told that it learnt".to_owned(),
        ),
        (_, Some(_)) => (false, String::new()),
        (Some(_), None) => (
            true,
            "never calibrated: the motor file holds no calibration, and the board has not told that it learnt".to_owned(),
        ),
        (None, None) => (
            false,
            "not known: name its motor_file in the gateway's configuration".to_owned(),
        ),
    }
}
