//! A trend and its points.

use serde::{Deserialize, Serialize};

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
