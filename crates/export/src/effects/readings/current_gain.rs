//! All current channels show `gain` times the truth.

use crate::effects::{Equations, Own, Shown};

/// Gain of all current channels.
pub struct CurrentGain;

impl Equations for CurrentGain {
    fn outputs(&self, own: &Own, shown: &mut Shown) {
        shown.i = shown.i.each_ref().map(|i| i * (1.0 + &own.p[0]));
    }
}
