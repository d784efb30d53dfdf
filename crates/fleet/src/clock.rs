//! Time as a plant counts it: Unix milliseconds by this computer's clock.

use std::time::{SystemTime, UNIX_EPOCH};

/// Unix time now, ms; 0 before 1970.
pub fn now_ms() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        i64::try_from(since.as_millis()).unwrap_or(i64::MAX)
    })
}
