//! The six values in which motors of all sizes are alike, as logarithms.

use nalgebra::SVector;

use crate::fit::Targets;

/// How many values there are.
pub const VALUES: usize = 6;

/// Logarithms of the values over their references, in the order of [`Value`].
pub type Values = SVector<f64, VALUES>;

/// One of the six values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Value {
    /// `ln(s / 0.03)`.
    Slip,
    /// `ln((1 - efficiency) / 0.1)`.
    Loss,
    /// `ln(tan(phi) / 0.65)`.
    TanPhi,
    /// `ln(T_b / T_n)`.
    Breakdown,
    /// `ln(T_LR / T_n)`.
    LockedRotorTorque,
    /// `ln(I_LR / I_n)`.
    LockedRotorCurrent,
}

const SLIP: f64 = 0.03;
const LOSS: f64 = 0.1;
const TAN_PHI: f64 = 0.65;

/// Logarithm of a slip.
pub(super) fn of_slip(slip: f64) -> f64 {
    (slip / SLIP).ln()
}

/// Logarithm of the loss of an efficiency.
pub(super) fn of_efficiency(efficiency: f64) -> f64 {
    ((1.0 - efficiency) / LOSS).ln()
}

/// Logarithm of the tangent of a power factor.
pub(super) fn of_power_factor(power_factor: f64) -> f64 {
    ((1.0 - power_factor * power_factor).sqrt() / power_factor / TAN_PHI).ln()
}

/// Efficiency of the logarithm of its loss.
pub(super) fn efficiency(loss: f64) -> f64 {
    1.0 - LOSS * loss.exp()
}

/// Power factor of the logarithm of its tangent.
pub(super) fn power_factor(tan_phi: f64) -> f64 {
    1.0 / (TAN_PHI * tan_phi.exp()).hypot(1.0)
}

impl Targets {
    /// The same motor with other values.
    pub fn with_values(&self, values: &Values) -> Targets {
        Targets {
            slip: SLIP * values[Value::Slip as usize].exp(),
            efficiency: efficiency(values[Value::Loss as usize]),
            power_factor: power_factor(values[Value::TanPhi as usize]),
            breakdown_torque_ratio: values[Value::Breakdown as usize].exp(),
            locked_rotor_torque_ratio: values[Value::LockedRotorTorque as usize].exp(),
            locked_rotor_current_ratio: values[Value::LockedRotorCurrent as usize].exp(),
            ..*self
        }
    }

    /// The six values of these targets.
    pub fn values(&self) -> Values {
        Values::from([
            of_slip(self.slip),
            of_efficiency(self.efficiency),
            of_power_factor(self.power_factor),
            self.breakdown_torque_ratio.ln(),
            self.locked_rotor_torque_ratio.ln(),
            self.locked_rotor_current_ratio.ln(),
        ])
    }
}
