//! Levenberg-Marquardt on the logarithms of the unknowns, with bounds and the prior.
//!
//! Source: Marquardt, J. SIAM 11(2), 1963, doi:10.1137/0111030; an unknown at a bound that the gradient pushes outwards is
//! frozen for the step.

use nalgebra::{SMatrix, SVector};

use super::misfit::{MISFITS, Misfits, Targets};
use super::start::{bounds, prior_spread, start};
use crate::circuit::{Circuit, Logs, PARAMETERS, breakdown_slip};

/// Derivatives of the misfits by the logarithms of the unknowns.
pub(super) type Jacobian = SMatrix<f64, MISFITS, PARAMETERS>;
type Normal = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Step of the differences, in logarithms.
const STEP: f64 = 1e-6;
/// Iterations at most; a hard motor takes thirty.
const ITERATIONS: usize = 60;
/// Attempts to find a damping that lowers the cost.
const ATTEMPTS: usize = 8;
/// Longest step of one logarithm.
const LONGEST: f64 = 1.5;
/// Relative gain below which an iteration counts as small; two of them in a row end the descent.
const SMALL_GAIN: f64 = 1e-5;

/// The circuit found, and how well it meets its targets.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The circuit.
    pub circuit: Circuit,
    /// Relative errors, in the order of [`super::Misfit`].
    pub misfits: Misfits,
    /// Greatest absolute relative error among the values to be met.
    pub worst: f64,
    /// Slip of the greatest torque.
    pub breakdown_slip: f64,
    pub(crate) cost: f64,
}

/// Targets, how closely each is to be met, prior and bounds.
pub(super) struct Problem<'t> {
    targets: &'t Targets,
    meets: Misfits,
    pub(super) centre: Logs,
    bounds: [Logs; 2],
    pub(super) spread: Logs,
}

/// One circuit with everything that the descent asks of it.
struct Trial {
    logs: Logs,
    circuit: Circuit,
    breakdown_slip: f64,
    misfits: Misfits,
    cost: f64,
}

impl<'t> Problem<'t> {
    pub(super) fn new(targets: &'t Targets, meets: &Misfits) -> Self {
        let mut problem = Problem {
            targets,
            meets: *meets,
            centre: start(targets).logs(),
            bounds: bounds(targets),
            spread: prior_spread(targets),
        };
        problem.centre = problem.inside(problem.centre);
        problem
    }

    /// The nearest place inside the bounds.
    pub(super) fn inside(&self, logs: Logs) -> Logs {
        logs.sup(&self.bounds[0]).inf(&self.bounds[1])
    }

    /// The local minimum downhill from `from`.
    pub(super) fn descend(&self, from: &Logs) -> Fit {
        let mut here = self.trial(*from);
        let (mut damping, mut small_gains) = (1e-3, 0);
        for _ in 0..ITERATIONS {
            let (normal, gradient) = self.normal_equations(&here);
            let Some(better) = self.lower(&here, &normal, &gradient, &mut damping) else {
                break;
            };
            let gain = (here.cost - better.cost) / here.cost;
            here = better;
            small_gains = if gain < SMALL_GAIN {
                small_gains + 1
            } else {
                0
            };
            if small_gains >= 2 {
                break;
            }
        }
        self.finished(here)
    }

    fn finished(&self, trial: Trial) -> Fit {
        let worst = |worst: f64, k: usize| {
            if self.meets[k] > 10.0 * super::MEETS {
                worst
            } else {
                worst.max(trial.misfits[k].abs())
            }
        };
        Fit {
            circuit: trial.circuit,
            misfits: trial.misfits,
            worst: (0..MISFITS).fold(0.0, worst),
            breakdown_slip: trial.breakdown_slip,
            cost: trial.cost,
        }
    }

    fn trial(&self, logs: Logs) -> Trial {
        let circuit = Circuit::from_logs(&logs);
        let slip = breakdown_slip(&circuit, &self.targets.rating());
        let misfits = self.targets.misfits(&circuit, slip);
        let prior = (logs - self.centre).component_div(&self.spread);
        let cost = misfits.component_div(&self.meets).norm_squared() + prior.norm_squared();
        Trial {
            logs,
            circuit,
            breakdown_slip: slip,
            misfits,
            cost: if cost.is_finite() { cost } else { f64::MAX },
        }
    }

    /// A step that lowers the cost; adapts the damping.
    fn lower(
        &self,
        here: &Trial,
        normal: &Normal,
        gradient: &Logs,
        damping: &mut f64,
    ) -> Option<Trial> {
        for _ in 0..ATTEMPTS {
            let step = self.step(here, normal, gradient, *damping);
            let trial = self.trial(self.inside(here.logs + step));
            if trial.cost < here.cost {
                *damping = (*damping / 8.0).max(1e-12);
                return Some(trial);
            }
            *damping = (*damping * 6.0).min(1e12);
        }
        None
    }

    fn step(&self, here: &Trial, normal: &Normal, gradient: &Logs, damping: f64) -> Logs {
        let mut damped = *normal;
        let mut right = -gradient;
        for k in 0..PARAMETERS {
            damped[(k, k)] *= 1.0 + damping;
        }
        for k in (0..PARAMETERS).filter(|&k| self.held(here, gradient, k)) {
            damped.fill_row(k, 0.0);
            damped.fill_column(k, 0.0);
            damped[(k, k)] = 1.0;
            right[k] = 0.0;
        }
        let solved = damped.cholesky().map(|factor| factor.solve(&right));
        let step: SVector<f64, PARAMETERS> = solved.unwrap_or_else(Logs::zeros);
        step.map(|x| x.clamp(-LONGEST, LONGEST))
    }

    /// At a bound, and pushed outwards.
    fn held(&self, here: &Trial, gradient: &Logs, k: usize) -> bool {
        let at_low = here.logs[k] <= self.bounds[0][k] + 1e-12 && gradient[k] > 0.0;
        let at_high = here.logs[k] >= self.bounds[1][k] - 1e-12 && gradient[k] < 0.0;
        at_low || at_high
    }

    fn normal_equations(&self, here: &Trial) -> (Normal, Logs) {
        let jacobian = self.jacobian(here);
        let mut weighted = jacobian;
        for (mut row, meets) in weighted.row_iter_mut().zip(self.meets.iter()) {
            row /= meets * meets;
        }
        let mut normal = jacobian.tr_mul(&weighted);
        let mut gradient = weighted.tr_mul(&here.misfits);
        for k in 0..PARAMETERS {
            let precision = self.spread[k].powi(-2);
            normal[(k, k)] += precision;
            gradient[k] += (here.logs[k] - self.centre[k]) * precision;
        }
        (normal, gradient)
    }

    /// At a fixed breakdown slip: there torque is flat, so that its derivative needs no new search.
    fn jacobian(&self, here: &Trial) -> Jacobian {
        jacobian(
            self.targets,
            &here.logs,
            here.breakdown_slip,
            &self.bounds[1],
        )
    }
}

/// Derivatives of the misfits at `logs`, by differences that stay below `upper`.
pub(super) fn jacobian(
    targets: &Targets,
    logs: &Logs,
    breakdown_slip: f64,
    upper: &Logs,
) -> Jacobian {
    let at = |logs: &Logs| targets.misfits(&Circuit::from_logs(logs), breakdown_slip);
    let here = at(logs);
    let mut jacobian = Jacobian::zeros();
    for k in 0..PARAMETERS {
        let step = if logs[k] + STEP > upper[k] {
            -STEP
        } else {
            STEP
        };
        let mut moved = *logs;
        moved[k] += step;
        jacobian.set_column(k, &((at(&moved) - here) / step));
    }
    jacobian
}
