//! A motor's history for a chart.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::words::finite;
use crate::motor::MotorId;
use crate::store::{Trend, TrendPoint, Values};

/// A trend, column by column: all lists have the length of `times_unix_ms`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrendAnswer {
    /// Its motor.
    pub motor: String,
    /// Length of a point, s.
    pub step_s: f64,
    /// Begin of each point in which something was heard, Unix ms.
    pub times_unix_ms: Vec<i64>,
    /// Seconds in it.
    pub seconds: Vec<u32>,
    /// Share of its windows that were judged, 0 to 1; null: there was none.
    pub judged_share: Vec<Option<f32>>,
    /// Lamps, two bits each (docs/modbus.md); of each the most severe state.
    pub lamps: Vec<u32>,
    /// r1 to r4, percent of their scales.
    pub residuals_percent: [SeriesAnswer; 4],
    /// Voltage, V RMS.
    pub voltage_v: SeriesAnswer,
    /// Current, A RMS.
    pub current_a: SeriesAnswer,
    /// Frequency of the supply, Hz.
    pub frequency_hz: SeriesAnswer,
    /// Speed, 1/min.
    pub speed_rpm: SeriesAnswer,
}

/// Least, mean and largest value of each point; null: not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeriesAnswer {
    /// Least.
    pub min: Vec<Option<f32>>,
    /// Mean.
    pub mean: Vec<Option<f32>>,
    /// Largest.
    pub max: Vec<Option<f32>>,
}

impl SeriesAnswer {
    fn new(
        points: &[TrendPoint],
        factor: f32,
        get: impl Fn(&TrendPoint) -> Option<Values>,
    ) -> Self {
        let column = |part: fn(Values) -> f32| {
            points
                .iter()
                .map(|p| get(p).and_then(|v| finite(factor * part(v))))
                .collect()
        };
        Self {
            min: column(|v| v.min),
            mean: column(|v| v.mean),
            max: column(|v| v.max),
        }
    }
}

impl TrendAnswer {
    /// A trend of the store.
    pub fn new(motor: &MotorId, trend: &Trend) -> Self {
        let points = &trend.points;
        let share = |p: &TrendPoint| (p.windows > 0).then(|| p.judged as f32 / p.windows as f32);
        Self {
            motor: motor.to_string(),
            step_s: trend.step_ms as f64 / 1000.0,
            times_unix_ms: points.iter().map(|p| p.from_ms).collect(),
            seconds: points.iter().map(|p| p.seconds).collect(),
            judged_share: points.iter().map(share).collect(),
            lamps: points.iter().map(|p| p.lamps).collect(),
            residuals_percent: [0, 1, 2, 3]
                .map(|k| SeriesAnswer::new(points, 100.0, |p| p.residuals[k])),
            voltage_v: SeriesAnswer::new(points, 1.0, |p| p.voltage_v),
            current_a: SeriesAnswer::new(points, 1.0, |p| p.current_a),
            frequency_hz: SeriesAnswer::new(points, 1.0, |p| p.frequency_hz),
            speed_rpm: SeriesAnswer::new(points, 1.0, |p| p.speed_rpm),
        }
    }
}
