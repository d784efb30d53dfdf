//! The clock of a recording: the `t` column, or a declared sampling rate.

use crate::read::samples::{Raw, Rows};
use recording::{Column, Error, Mapping, Target, rounded};

/// When the samples were taken.
pub(in crate::read) struct Clock {
    /// In seconds, strictly rising.
    pub t: Column,
    /// What was assumed to read it.
    pub assumption: Option<String>,
}

/// Takes the clock out of the raw columns.
pub(in crate::read) fn clock(file: &str, raw: &mut Raw, mapping: &Mapping) -> Result<Clock, Error> {
    let column = raw.columns.remove(&Target::Time);
    let rows = raw.rows.len();
    if rows < 2 {
        let message = match rows {
            0 if raw.skipped > 0 => format!(
                "all {} rows were left out: each has an empty or NaN cell (--skip-missing)",
                raw.skipped
            ),
            0 => "holds a header, but no samples".to_owned(),
            _ => "holds a single sample; at least 2 are needed".to_owned(),
        };
        return Err(Error::bad(file, message, "record several supply periods"));
    }
    if let Some(rate_hz) = mapping.sample_rate_hz {
        #[allow(clippy::cast_precision_loss)]
        let seconds = |k: usize| raw.rows.number(k) as f64 / rate_hz;
        return Ok(Clock {
            t: (0..rows).map(seconds).collect::<Vec<f64>>().into(),
            assumption: None,
        });
    }
    let map = mapping
        .columns
        .get(&Target::Time)
        .cloned()
        .unwrap_or_default();
    let quantity = Target::Time.quantity();
    let mut t = column.unwrap_or_else(|| Vec::new().into());
    if !map.is_plain(quantity) {
        let readings = t.to_mut().iter_mut();
        readings.for_each(|x| *x = map.to_si(quantity, *x));
    }
    let even = rounded::even(&t);
    let assumption = even.as_ref().map(rounded::Even::told);
    let t = even.map_or(t, |even| even.t.into());
    rises(file, &t, &raw.rows)?;
    Ok(Clock { t, assumption })
}

fn rises(file: &str, t: &[f64], rows: &Rows) -> Result<(), Error> {
    let Some(k) = (1..t.len()).find(|&k| t[k] <= t[k - 1]) else {
        return Ok(());
    };
    let (message, remedy) = if t[k] == t[k - 1] {
        (
            format!("the time {} s appears twice", t[k]),
            "write t with more decimals, declare --sample-rate HZ, or remove the duplicate",
        )
    } else {
        (
            format!("the time falls from {} s to {} s", t[k - 1], t[k]),
            "sort the samples by time, or cut the file where the clock restarts",
        )
    };
    Err(Error::at(file, rows.line(k), "t", message, remedy))
}
