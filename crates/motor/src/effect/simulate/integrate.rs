//! A whole run, step after step.

use super::{Ready, Shown, Task};
use crate::dynamic::Hooks;
use crate::effect::Outputs;

/// Integrates over all inputs and records every step.
pub(super) struct Integrate {
    /// Steps that are taken at once; the rows between them are interpolated.
    pub at_once: usize,
}

impl Task for Integrate {
    type Result = Outputs;

    fn at_once(&self) -> usize {
        self.at_once
    }

    fn on<H: Hooks>(self, ready: &Ready<'_, H>) -> Outputs {
        let run = ready.run;
        let stride = run.between.stride();
        let rows = run.inputs.u_s.len().saturating_sub(1) / stride + 1;
        let mut out = Outputs {
            t_sample: ready.inputs.t_sample * stride as f64,
            ..Outputs::default()
        };
        out.i_s_abc.reserve(rows);
        out.omega_mech.reserve(rows);
        out.theta_mech.reserve(rows);
        let (mut state, mut cuts) = (ready.start, 0);
        let mut last = None;
        for step in 0..=ready.steps() {
            let restart = ready.restart(step, cuts);
            cuts += usize::from(restart.is_some());
            let shown = ready.pass(&mut state, step, restart);
            if let Some(last) = last.replace(shown) {
                let between = (1..self.at_once).map(|n| n as f64 / self.at_once as f64);
                between.for_each(|share| record(&mut out, &last.towards(&shown, share)));
            }
            record(&mut out, &shown);
        }
        if let Some(last) = last {
            (out.omega_mech.len()..rows).for_each(|_| record(&mut out, &last));
        }
        out.u_measured = (0..rows).map(|k| run.inputs.u_s[k * stride]).collect();
        out
    }
}

fn record(out: &mut Outputs, shown: &Shown) {
    out.i_s_abc.push(shown.i_s_abc);
    out.omega_mech.push(shown.omega_mech);
    out.theta_mech.push(shown.theta_mech);
}

impl Shown {
    /// So much of the way to what is seen next.
    fn towards(&self, next: &Self, share: f64) -> Self {
        let between = |a: f64, b: f64| a + share * (b - a);
        Self {
            i_s_abc: core::array::from_fn(|k| between(self.i_s_abc[k], next.i_s_abc[k])),
            omega_mech: between(self.omega_mech, next.omega_mech),
            theta_mech: between(self.theta_mech, next.theta_mech),
        }
    }
}
