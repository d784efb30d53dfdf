//! The clock of a recording: the `t` column, or a declared sampling rate.

use crate::read::Raw;
use recording::{Error, Mapping, Target};

/// Takes the clock out of the raw columns, in seconds, strictly rising.
pub(in crate::read) fn clock(
    file: &str,
    raw: &mut Raw,
    mapping: &Mapping,
) -> Result<Vec<f64>, Error> {
    let column = raw.columns.remove(&Target::Time);
    let rows = raw.lines.len();
    if rows < 2 {
        let message = match rows {
            0 => "holds a header, but no samples".to_owned(),
            _ => "holds a single sample; at least 2 are needed".to_owned(),
        };
        return Err(Error::bad(file, message, "record several supply periods"));
    }
    if let Some(rate_hz) = mapping.sample_rate_hz {
        #[allow(clippy::cast_precision_loss)]
        let seconds = |number: &u64| *number as f64 / rate_hz;
        return Ok(raw.numbers.iter().map(seconds).collect());
    }
    let map = mapping
        .columns
        .get(&Target::Time)
        .cloned()
        .unwrap_or_default();
    let quantity = Target::Time.quantity();
    let t: Vec<f64> = column
        .unwrap_or_default()
        .into_iter()
        .map(|x| map.to_si(quantity, x))
        .collect();
    rises(file, &t, &raw.lines)?;
    Ok(t)
}

fn rises(file: &str, t: &[f64], lines: &[u64]) -> Result<(), Error> {
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
    Err(Error::at(file, lines[k], "t", message, remedy))
}
