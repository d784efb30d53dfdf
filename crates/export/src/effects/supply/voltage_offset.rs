//! Each voltage channel is shifted by a constant.

use crate::algebra::{Body, clarke};
use crate::effects::{Equations, Given, Own};

/// Offset of each voltage channel.
pub struct VoltageOffset;

impl Equations for VoltageOffset {
    fn inputs(&self, own: &Own, body: &mut Body, given: &mut Given) {
        let offset = clarke(&[0, 1, 2].map(|k| own.p[k].clone()));
        given.u = body.vector("u_true", &(&given.u - &offset));
    }
}
