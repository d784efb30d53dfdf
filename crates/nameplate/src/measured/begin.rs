//! Where the tests begin: the plate's circuit, or where no circuit has the printed values the nearest values that one has.

use super::tolerances::tolerances;
use crate::circuit::Winding;
use crate::estimate::Estimate;
use crate::fit::{Fit, MEETS, Misfit, Misfits, solve};
use crate::plate::{Completed, Value};

/// A worst error above: no circuit has these values, and a single motor has others within the tolerances.
const NOT_MET: f64 = 0.005;
/// Seed of further starts.
const SEED: u64 = 1;

/// A plate's values and the circuit that has them.
#[derive(Clone, Debug)]
pub(super) struct Begin {
    pub completed: Completed,
    pub fit: Fit,
}

impl Begin {
    pub fn of(estimate: &Estimate) -> Begin {
        let strict = solve(&estimate.completed.targets, &Misfits::repeat(MEETS), SEED);
        let begin = Begin {
            completed: estimate.completed.clone(),
            fit: strict,
        };
        match begin.fit.worst > NOT_MET {
            true => begin.relaxed(),
            false => begin,
        }
    }

    /// Power, slip and power factor are kept; efficiency and the values at breakdown and standstill move as their tolerances allow.
    fn relaxed(&self) -> Begin {
        let spread = (self.completed.covariance + tolerances(&self.completed)).diagonal();
        let deviation = |value: Value| spread[value as usize].sqrt();
        let efficiency = self.completed.targets.efficiency;
        let mut meets = Misfits::repeat(MEETS);
        meets[Misfit::Breakdown as usize] = deviation(Value::Breakdown);
        meets[Misfit::LockedRotorTorque as usize] = deviation(Value::LockedRotorTorque);
        meets[Misfit::LockedRotorCurrent as usize] = deviation(Value::LockedRotorCurrent);
        meets[Misfit::Efficiency as usize] =
            deviation(Value::Loss) * (1.0 - efficiency) / efficiency;
        meets[Misfit::Current as usize] = 1.0;
        let near = solve(&self.completed.targets, &meets, SEED);
        let values = self.values_of(&near);
        let completed = self.completed.with_values(&values);
        let fit = solve(&completed.targets, &Misfits::repeat(MEETS), SEED);
        Begin { completed, fit }
    }

    fn values_of(&self, fit: &Fit) -> crate::plate::Values {
        let targets = &self.completed.targets;
        let rating = targets.rating();
        let rated = fit.circuit.at_rating(&rating);
        let breakdown = fit
            .circuit
            .at_slip(&rating, fit.breakdown_slip, Winding::Cold);
        let locked = fit.circuit.at_slip(&rating, 1.0, Winding::Cold);
        let power = rated.torque * (1.0 - rating.slip * fit.circuit.slip_ratio);
        let mut moved = *targets;
        moved.efficiency = (power / rated.active).clamp(0.2, 0.99);
        moved.breakdown_torque_ratio = breakdown.torque / rating.torque();
        moved.locked_rotor_torque_ratio = locked.torque / rating.torque();
        moved.locked_rotor_current_ratio = locked.current / rated.current;
        moved.values()
    }
}
