//! How many rows a channel keeps its value for, where it is refreshed more slowly than rows are written.

use crate::measure::statistics::quantile;

/// Rows from which on a value counts as held: shorter holds do no harm to a channel that is looked at period by period, ...
const FEWEST_ROWS: f64 = 10.0;
/// ... and those from which on they are seen sample by sample. Fewer may be a converter's resolution.
const FEWEST_SEEN: f64 = 4.0;
/// Refreshes that must be seen.
const FEWEST_REFRESHES: usize = 20;
/// Share of the refreshes that must come after whole multiples of the same number of rows.
const REGULAR: f64 = 0.9;
/// Deviation from a whole multiple that still counts, as a share of it, and in rows.
const OFF_SHARE: f64 = 0.1;
const OFF_ROWS: f64 = 1.0;
/// Share of the refreshes that must be larger than the smallest change: a slow drift goes on step by step.
const LARGER: f64 = 0.2;

/// The number of rows for which a channel keeps its value, where it is refreshed regularly and slowly.
pub(crate) fn rows(x: &[f64]) -> Option<f64> {
    let rows = rows_between(&refreshes(x)?, x);
    rows.filter(|rows| *rows >= FEWEST_ROWS)
}

/// Rows at which a channel that keeps its values for several rows is refreshed, those between where nothing changed included: a
/// counter of pulses, a bus. `None` of a channel that shows something new in every row.
pub fn refreshed_at(x: &[f64]) -> Option<Vec<usize>> {
    let changes = refreshes(x)?;
    let rows = rows_between(&changes, x).filter(|rows| *rows >= FEWEST_SEEN)?;
    let ends = changes.iter().skip(1).copied().chain([x.len()]);
    let held = changes.iter().zip(ends).flat_map(|(&from, to)| {
        let number = ((to - from) as f64 / rows).round().max(1.0);
        (0..number as usize).map(move |k| from + (k as f64 * rows).round() as usize)
    });
    Some(held.collect())
}

/// Rows from one refresh to the next, where the changes of a channel are regular.
fn rows_between(changes: &[usize], x: &[f64]) -> Option<f64> {
    let waits = || changes.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    let rows = quantile(waits(), 0.1)?;
    let whole = |wait: &f64| {
        let multiple = (wait / rows).round().max(1.0);
        (wait - multiple * rows).abs() <= (OFF_SHARE * rows).max(OFF_ROWS * multiple.min(4.0))
    };
    let regular = waits().filter(whole).count() as f64;
    let sizes = || changes.iter().map(|k| (x[*k] - x[k - 1]).abs());
    let smallest = sizes().fold(f64::INFINITY, f64::min);
    let larger = sizes().filter(|size| *size > 1.5 * smallest).count() as f64;
    let count = changes.len() as f64;
    (regular >= REGULAR * (count - 1.0) && larger >= LARGER * count).then_some(rows)
}

/// Where a channel changes: one or two rows in a row, the second where the change was interpolated; `None` where it changes
/// too rarely or row by row.
fn refreshes(x: &[f64]) -> Option<Vec<usize>> {
    let mut first: Vec<usize> = Vec::new();
    let (mut last, mut rows) = (0, 0_usize);
    for k in (1..x.len()).filter(|k| x[*k] != x[k - 1]) {
        if last == 0 || k > last + 1 {
            first.push(k);
        }
        (last, rows) = (k, rows + 1);
        // Every second of the rows to come may add to `first`, no more: mostly a third of all shows what becomes of them.
        if rows > 2 * first.len() + (x.len() - k) / 2 + 2 {
            return None;
        }
    }
    (first.len() >= FEWEST_REFRESHES && rows <= 2 * first.len()).then_some(first)
}
