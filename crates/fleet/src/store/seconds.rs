//! A second as columns of a table.

use rusqlite::types::Value;
use rusqlite::{Row, ToSql};

use crate::entry::Second;

/// The columns, in the order of [`values_of`].
pub(super) const COLUMNS: &str = "start, number, time_ms, lamps, windows, judged, not_judged, fault, r1, r2, r3, r4, \
     voltage_v, current_a, frequency_hz, speed_rpm";

/// Number of columns.
pub(super) const WIDTH: usize = 16;

/// Steps of a residual in one scale: what a board sends has this resolution.
const STEPS: f32 = 1e4;

/// A residual as a whole number; not known: `None`.
pub(super) fn steps_of(residual: f32) -> Option<i16> {
    // The board's own range; i16::MIN is its "none".
    (!residual.is_nan()).then(|| (residual * STEPS).round().clamp(-32767.0, 32767.0) as i16)
}

/// A residual from a whole number.
pub(super) fn residual_of(steps: Option<i16>) -> f32 {
    steps.map_or(f32::NAN, |steps| f32::from(steps) / STEPS)
}

/// r1 to r4 from whole numbers; none known: `None`.
pub(super) fn residuals_of(steps: [Option<i16>; 4]) -> Option<[f32; 4]> {
    steps
        .iter()
        .any(Option::is_some)
        .then(|| steps.map(residual_of))
}

/// r1 to r4 as whole numbers.
pub(super) fn all_steps(second: &Second) -> [Option<i16>; 4] {
    second.residuals.map_or([None; 4], |all| all.map(steps_of))
}

/// A value that is a number; SQLite keeps no NaN.
fn known(value: Option<f32>) -> Value {
    value
        .filter(|x| !x.is_nan())
        .map_or(Value::Null, |x| Value::Real(f64::from(x)))
}

/// The values of the columns.
pub(super) fn values_of(second: &Second) -> [Value; WIDTH] {
    let whole = |x: u32| Value::Integer(i64::from(x));
    let [r1, r2, r3, r4] =
        all_steps(second).map(|r| r.map_or(Value::Null, |r| Value::Integer(i64::from(r))));
    [
        whole(second.start),
        whole(second.number),
        Value::Integer(second.time_ms),
        whole(second.lamps),
        whole(second.windows.into()),
        whole(second.judged.into()),
        whole(second.not_judged.into()),
        whole(second.fault.into()),
        r1,
        r2,
        r3,
        r4,
        known(second.voltage_v),
        known(second.current_a),
        known(second.frequency_hz),
        known(second.speed_rpm),
    ]
}

/// The second that stands in a row from column `at` on.
pub(super) fn second_of(row: &Row<'_>, at: usize) -> rusqlite::Result<Second> {
    Ok(Second {
        start: row.get(at)?,
        number: row.get(at + 1)?,
        time_ms: row.get(at + 2)?,
        lamps: row.get(at + 3)?,
        windows: row.get(at + 4)?,
        judged: row.get(at + 5)?,
        not_judged: row.get(at + 6)?,
        fault: row.get(at + 7)?,
        residuals: residuals_of([
            row.get(at + 8)?,
            row.get(at + 9)?,
            row.get(at + 10)?,
            row.get(at + 11)?,
        ]),
        voltage_v: row.get(at + 12)?,
        current_a: row.get(at + 13)?,
        frequency_hz: row.get(at + 14)?,
        speed_rpm: row.get(at + 15)?,
    })
}

/// Parameters of a statement: some keys, then the columns.
pub(super) fn params<'a>(keys: &'a [i64], columns: &'a [Value; WIDTH]) -> Vec<&'a dyn ToSql> {
    let keys = keys.iter().map(|key| key as &dyn ToSql);
    keys.chain(columns.iter().map(|value| value as &dyn ToSql))
        .collect()
}
