//! Gains and delays of the analogue channels against each other, from recordings in which all of them see one signal: the
//! voltage inputs in parallel on one phase, its current through all transducers in series into a resistive load.
//!
//! What a running motor cannot tell (a delay of the currents looks like stator resistance) this can. All channels share what
//! cannot be seen: a delay common to all of them, and the scale of the voltages and of the currents without a meter.

mod blocks;
mod combine;
mod refuse;
#[cfg(test)]
mod tests;

use recording::Recording;

use crate::calibrate::Refusal;
use blocks::Sine;
pub use combine::{Estimate, Found};

/// Voltages a, b, c, then currents a, b, c.
pub const CHANNELS: usize = 6;
/// Names of the channels in this order, as recordings have them.
pub const NAMES: [&str; CHANNELS] = ["va", "vb", "vc", "ia", "ib", "ic"];

/// What is known besides the recordings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setup {
    /// Root mean square of the voltage by a meter, V; without it the mean gain of the voltages stays.
    pub true_volt: Option<f64>,
    /// Root mean square of the current by a meter, A; without it the mean gain of the currents stays.
    pub true_amp: Option<f64>,
    /// L/R of the load, s: by how much its current is later than its voltage.
    pub load_time_constant_s: f64,
    /// Roll-off that the recorder's channels are known to have and a recording still shows, s.
    pub roll_off_s: f64,
}

/// Finds the channels' gains and delays.
///
/// # Errors
/// A recording that shows no such set-up (three-phase signals, a channel the other way round, a load that is not
/// resistive), is clipped, too short or too noisy, or contradicts another.
pub fn find(recordings: &[Recording], setup: &Setup) -> Result<Found, Refusal> {
    let mut sines = Vec::with_capacity(recordings.len());
    for recording in recordings {
        let sine = blocks::sine(recording)?;
        refuse::wrong_set_up(recording, &sine)?;
        sines.push(sine);
    }
    let names: Vec<&str> = recordings.iter().map(Recording::name).collect();
    let found = combine::combine(&sines, setup);
    refuse::contradictions(&names, &sines, setup)?;
    refuse::imprecise(&names, &found)?;
    Ok(found)
}
