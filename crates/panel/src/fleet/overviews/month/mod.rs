//! A month of a plant: availability of data, alarms and who took note of them, models in force, trends.

mod alarms;
pub(in crate::fleet) mod calendar;
mod served;

use std::path::Path;

use fleet::{MotorState, Reader, StoreError, now_ms};
use report::Subject;
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use super::models::{self, Model};
use crate::fleet::plant::DueRule;
use alarms::Happened;

pub use calendar::{CalendarMonth, NoMonth};
pub(in crate::fleet) use served::{WhichMonth, month, page};

/// A day, ms.
const DAY_MS: i64 = 86_400_000;
/// Trends compare the mean of so many days at the month's beginning with as many at its end.
const COMPARED_DAYS: i64 = 7;

/// What a month was like.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Month {
    /// The month, as 2026-10; days are those of UTC.
    pub month: String,
    /// When this was counted, Unix ms; a month that is not over is counted up to here.
    pub now_ms: i64,
    /// Begin, Unix ms.
    pub from_ms: i64,
    /// End of what is counted, Unix ms.
    pub to_ms: i64,
    /// Seconds that are stored of all that passed, percent, mean of the motors that were there.
    pub availability_percent: Option<f64>,
    /// Motors, those whose residuals moved most first.
    pub motors: Vec<OfMotor>,
    /// Alarms that rose in the month, by cause.
    pub causes: Vec<OfCause>,
    /// Alarms that rose in the month, the first of them first.
    pub alarms: Vec<Happened>,
    /// Models in force when this was counted, those that are due first.
    pub models: Vec<Model>,
}

/// A motor's month.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OfMotor {
    /// Name within the plant.
    pub id: String,
    /// What people call it.
    pub title: String,
    /// Where it is.
    pub place: String,
    /// Seconds that are stored of all that passed in the month since the motor's first one, percent; `null`: it had none yet.
    pub availability_percent: Option<f64>,
    /// Windows that were judged, percent of all; `null`: no window.
    pub judged_percent: Option<f64>,
    /// Alarms that rose.
    pub alarms: u32,
    /// Of them marked as false by people.
    pub marked_false: u32,
    /// How long alarms lasted within the month, h.
    pub alarm_hours: f64,
    /// Mean of r1 to r4 in the first seven days, percent of their scales; `null`: not known.
    pub first_percent: [Option<f32>; 4],
    /// The same of the last seven days.
    pub last_percent: [Option<f32>; 4],
    /// Largest change between them, percent of its scale; `null`: not known, or the month is younger than two weeks.
    pub moved_percent: Option<f32>,
}

/// Alarms of one cause.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct OfCause {
    /// What they are about, in words.
    pub words: String,
    /// How many rose.
    pub alarms: u32,
    /// Of how many motors.
    pub motors: u32,
    /// Of them marked as false by people.
    pub marked_false: u32,
    /// How long they lasted within the month, h.
    pub hours: f64,
}

impl Answer for Month {
    const FORMAT: &'static str = "fleet-month/1";
}

/// The page of a month of a store, by the usual rule.
///
/// # Errors
/// What is no month, or a store that cannot be read, in words.
pub fn month_page(store: &Path, month: &str) -> Result<String, String> {
    page_at(store, month, now_ms())
}

pub(super) fn page_at(store: &Path, month: &str, now_ms: i64) -> Result<String, String> {
    let month: CalendarMonth = month.parse().map_err(|error: NoMonth| error.to_string())?;
    let reader = Reader::open(store).map_err(|error| error.to_string())?;
    let month =
        count(&reader, &DueRule::default(), month, now_ms).map_err(|error| error.to_string())?;
    report::page(Subject::FleetMonth, &month).map_err(|error| error.to_string())
}

/// Counts a month.
///
/// # Errors
/// The store cannot be read.
fn count(
    reader: &Reader,
    rule: &DueRule,
    month: CalendarMonth,
    now_ms: i64,
) -> Result<Month, StoreError> {
    let from_ms = month.from_ms();
    let to_ms = month.to_ms().min(now_ms).max(from_ms);
    let happened = alarms::of_month(reader, from_ms, to_ms)?;
    let states = reader.motors()?;
    let of_motor = |state: &MotorState| of_motor(reader, state, &happened, [from_ms, to_ms]);
    let mut motors: Vec<OfMotor> = states.iter().map(of_motor).collect::<Result<_, _>>()?;
    motors.sort_by(|a, b| {
        let moved = |motor: &OfMotor| motor.moved_percent.unwrap_or(-1.0);
        moved(b).total_cmp(&moved(a)).then(a.id.cmp(&b.id))
    });
    let there: Vec<f64> = motors
        .iter()
        .filter_map(|motor| motor.availability_percent)
        .collect();
    let mean = there.iter().sum::<f64>() / there.len() as f64;
    Ok(Month {
        month: month.to_string(),
        now_ms,
        from_ms,
        to_ms,
        availability_percent: (!there.is_empty()).then_some(mean),
        causes: alarms::by_cause(&happened),
        alarms: happened,
        motors,
        models: models::all(reader, rule, now_ms)?.models,
    })
}

fn of_motor(
    reader: &Reader,
    state: &MotorState,
    happened: &[Happened],
    [from_ms, to_ms]: [i64; 2],
) -> Result<OfMotor, StoreError> {
    let info = &state.info;
    let trend = reader.trend(&info.id, from_ms, to_ms.max(from_ms + 1), 31)?;
    let sum = |of: &dyn Fn(&fleet::TrendPoint) -> u32| {
        trend
            .points
            .iter()
            .map(|point| u64::from(of(point)))
            .sum::<u64>() as f64
    };
    // Nobody has lost what was before a motor's first second.
    let since_ms = reader.first_ms(&info.id)?.map(|first| first.max(from_ms));
    let passed = since_ms.map(|since| (to_ms - since) as f64 / 1e3);
    let stored = |passed: f64| 100.0 * (sum(&|point| point.seconds) / passed.max(1.0)).min(1.0);
    let windows = sum(&|point| point.windows);
    let id = info.id.to_string();
    let own = || {
        happened
            .iter()
            .filter(|alarm| alarm.motor.as_deref() == Some(&*id))
    };
    let [first, last] = [
        [from_ms, from_ms + COMPARED_DAYS * DAY_MS],
        [to_ms - COMPARED_DAYS * DAY_MS, to_ms],
    ]
    .map(|within| means(&trend, within));
    let is_long = to_ms - from_ms >= 2 * COMPARED_DAYS * DAY_MS;
    let moved = first
        .iter()
        .zip(&last)
        .filter_map(|(a, b)| Some(((*b)? - (*a)?).abs()));
    Ok(OfMotor {
        title: info.title.clone(),
        place: info.place.clone(),
        availability_percent: passed.filter(|passed| *passed > 0.0).map(stored),
        judged_percent: (windows > 0.0).then(|| 100.0 * sum(&|point| point.judged) / windows),
        alarms: own().count() as u32,
        marked_false: own().filter(|alarm| alarm.marked_false).count() as u32,
        alarm_hours: own().map(|alarm| alarm.hours).sum(),
        moved_percent: moved.reduce(f32::max).filter(|_| is_long),
        first_percent: first,
        last_percent: last,
        id,
    })
}

/// Means of r1 to r4 over the points that begin within a time, percent of their scales.
fn means(trend: &fleet::Trend, [from_ms, to_ms]: [i64; 2]) -> [Option<f32>; 4] {
    let within = |point: &&fleet::TrendPoint| (from_ms..to_ms).contains(&point.from_ms);
    std::array::from_fn(|k| {
        let points = trend.points.iter().filter(within);
        let values = points.filter_map(|point| point.residuals[k]);
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), values| {
            (sum + values.mean, count + 1.0)
        });
        (count > 0.0).then(|| 100.0 * sum / count)
    })
}
