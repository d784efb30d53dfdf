//! Each current channel is shifted by a constant.

use crate::effects::{Equations, Own, Shown};

/// Offset of each current channel.
pub struct CurrentOffset;

impl Equations for CurrentOffset {
    fn outputs(&self, own: &Own, shown: &mut Shown) {
        shown.i = [0, 1, 2].map(|k| &shown.i[k] + &own.p[k]);
    }
}
