//! A motor's history for a chart: at most so many points, each with least, mean and largest value.

use rusqlite::{Connection, params};
use serde::{Deserialize, Serialize};

use super::tally::Tally;
use super::{StoreError, seconds};

/// Least, mean and largest of one quantity within a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// Least.
    pub min: f32,
    /// Mean.
    pub mean: f32,
    /// Largest.
    pub max: f32,
}

/// One point of a trend.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrendPoint {
    /// Begin, Unix ms.
    pub from_ms: i64,
    /// End, Unix ms.
    pub to_ms: i64,
    /// Seconds that are in it.
    pub seconds: u32,
    /// Windows that were judged.
    pub judged: u32,
    /// Windows.
    pub windows: u32,
    /// Lamps, two bits each; of each the most severe state.
    pub lamps: u32,
    /// r1 to r4, shares of their scales; `None`: not known in any second.
    pub residuals: [Option<Values>; 4],
    /// Voltage, V RMS.
    pub voltage_v: Option<Values>,
    /// Current, A RMS.
    pub current_a: Option<Values>,
    /// Frequency of the supply, Hz.
    pub frequency_hz: Option<Values>,
    /// Speed, 1/min.
    pub speed_rpm: Option<Values>,
}

/// A trend.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trend {
    /// Length of a point, ms.
    pub step_ms: i64,
    /// Points in which there is a second, in order.
    pub points: Vec<TrendPoint>,
}

/// Most points of one trend: more than any screen has columns.
const MOST: usize = 20_000;

/// Sorts what happened into points of equal length.
struct Points {
    from_ms: i64,
    step_ms: i64,
    tallies: Vec<Tally>,
}

impl Points {
    fn new(from_ms: i64, to_ms: i64, points: usize) -> Self {
        let points = points.clamp(1, MOST);
        let span = to_ms.saturating_sub(from_ms).max(1).unsigned_abs();
        // Whole seconds: a point that is shorter would be empty every other time.
        let step = span.div_ceil(points as u64).div_ceil(1000) * 1000;
        let count = span.div_ceil(step) as usize;
        let step_ms = step as i64;
        Self {
            from_ms,
            step_ms,
            tallies: vec![Tally::default(); count],
        }
    }

    fn at(&mut self, time_ms: i64) -> Option<&mut Tally> {
        let place = time_ms.checked_sub(self.from_ms)?.div_euclid(self.step_ms);
        self.tallies.get_mut(usize::try_from(place).ok()?)
    }

    fn trend(&self) -> Trend {
        let step_ms = self.step_ms;
        let begins = (0..).map(|k| self.from_ms + k * step_ms);
        let full = begins
            .zip(&self.tallies)
            .filter(|(_, tally)| tally.seconds > 0);
        let points = full
            .map(|(begin, tally)| tally.point(begin, begin + step_ms))
            .collect();
        Trend { step_ms, points }
    }
}

/// The trend of a motor from `from_ms` to before `to_ms`.
pub(super) fn trend(
    connection: &Connection,
    motor: i64,
    from_ms: i64,
    to_ms: i64,
    points: usize,
) -> Result<Trend, StoreError> {
    let mut points = Points::new(from_ms, to_ms, points);
    let text = format!(
        "SELECT {} FROM queue WHERE motor = ?1 AND time_ms >= ?2 AND time_ms < ?3",
        seconds::COLUMNS
    );
    let mut statement = connection.prepare_cached(&text)?;
    let mut rows = statement.query(params![motor, from_ms, to_ms])?;
    while let Some(row) = rows.next()? {
        let second = seconds::second_of(row, 0)?;
        if let Some(tally) = points.at(second.time_ms) {
            tally.second(&second);
        }
    }
    Ok(points.trend())
}
