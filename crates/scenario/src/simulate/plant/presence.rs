//! Which faults are present, and the room that they need.

use crate::{Asymmetry, Fault, Target};

/// As many states as effects may add to one motor.
pub(super) const EXTRA_STATES: usize = motor::effect::MAX_FILE_STATES;

/// Which faults are present, remembered so that the motor is rebuilt only when that changes.
#[derive(Clone, Debug, Default)]
pub(super) struct Presence(Option<Vec<bool>>);

impl Presence {
    /// The faults in force at `t`, when they are others than the last time.
    pub(super) fn changed_at<'f>(&mut self, faults: &'f [Fault], t: f64) -> Option<Vec<&'f Fault>> {
        let now = faults.iter().map(|fault| fault.is_active(t));
        if self
            .0
            .iter()
            .any(|before| now.clone().eq(before.iter().copied()))
        {
            return None;
        }
        self.0 = Some(now.collect());
        Some(faults.iter().filter(|fault| fault.is_active(t)).collect())
    }

    /// As if nothing had ever been present.
    pub(super) fn forget(&mut self) {
        self.0 = None;
    }
}

/// Resistance in series with one phase, `share` of `R_s`, drops `share/3 R_s (i + e^(2j gamma) conj(i))`, gamma being
/// the axis of the phase. This is the sum of the first terms, a higher `R_s`.
pub(super) fn common_series(faults: &[&Fault]) -> f64 {
    let series = faults
        .iter()
        .filter(|fault| matches!(fault.target, Target::Asymmetry(Asymmetry::Series(_))));
    series.map(|fault| fault.share() / 3.0).sum()
}
