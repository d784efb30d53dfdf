//! Recordings that cannot be judged.

use recording::Recording;

/// Why a recording cannot be judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsupported {
    /// What is missing or wrong.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl Unsupported {
    /// From what is wrong and what to do about it.
    pub fn new(reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }
}

/// Refuses a recording whose samples are not one interval apart.
///
/// # Errors
/// The first time at which the interval is more than a hundredth off.
pub fn check_clock(rec: &Recording) -> Result<(), Unsupported> {
    let t_sample = rec.t_sample();
    let uneven = |pair: &[f64]| (pair[1] - pair[0] - t_sample).abs() > 0.01 * t_sample;
    match rec.t().windows(2).position(uneven) {
        None => Ok(()),
        Some(k) => Err(Unsupported::new(
            format!("the clock is not even at t = {} s", rec.t()[k]),
            "cut the recording at its gaps, or resample it",
        )),
    }
}

/// No quantity of a motor is as large, in whichever unit; squares and sums stay far from overflow.
const LARGEST: f64 = 1e12;

/// Refuses a recording with values that no motor reaches.
///
/// # Errors
/// The channel and its largest value.
pub fn check_size(rec: &Recording) -> Result<(), Unsupported> {
    let largest = |x: &[f64]| x.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let beyond = rec
        .channels()
        .map(|(channel, x)| (channel, largest(x)))
        .find(|(_, largest)| *largest > LARGEST);
    match beyond {
        None => Ok(()),
        Some((channel, largest)) => Err(Unsupported::new(
            format!("{channel} reaches {largest:.0e}, which no motor does"),
            "check which column it is and in which unit",
        )),
    }
}
