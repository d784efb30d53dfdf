//! Each current channel shows its own gain times the truth.

use crate::effects::{Equations, Own, Shown};

/// Gain of each current channel.
pub struct PhaseCurrentGain;

impl Equations for PhaseCurrentGain {
    fn outputs(&self, own: &Own, shown: &mut Shown) {
        shown.i = [0, 1, 2].map(|k| &shown.i[k] * (1.0 + &own.p[k]));
    }
}
