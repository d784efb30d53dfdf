//! How far a circuit is from the values that it should meet.

use crate::circuit::{Circuit, Rating, Winding};
use nalgebra::SVector;

/// How many values a circuit is compared in.
pub const MISFITS: usize = 7;

/// Relative errors in the order of [`Misfit`], or one standard deviation for each.
pub type Misfits = SVector<f64, MISFITS>;

/// The values in which a circuit is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Misfit {
    /// Shaft power at rated load.
    Power,
    /// Reactive power at rated load: a power factor near 1 says little, this does not.
    ReactivePower,
    /// Breakdown torque over rated torque.
    Breakdown,
    /// Locked-rotor torque over rated torque.
    LockedRotorTorque,
    /// Locked-rotor current over rated current.
    LockedRotorCurrent,
    /// Efficiency at rated load.
    Efficiency,
    /// Rated current.
    Current,
}

/// The values that a circuit should meet; every one is set, given or expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Targets {
    /// Rated shaft power, kW: the prior knows motors by their size.
    pub power_kw: f64,
    /// Slip of the printed speed, 0 < s < 1.
    pub slip: f64,
    /// Half a step of the printed speed, relative to the slip.
    pub slip_half_step: f64,
    /// Efficiency at rated load, 0..1.
    pub efficiency: f64,
    /// Power factor at rated load, 0..1.
    pub power_factor: f64,
    /// Breakdown torque over rated torque.
    pub breakdown_torque_ratio: f64,
    /// Locked-rotor torque over rated torque.
    pub locked_rotor_torque_ratio: f64,
    /// Locked-rotor current over rated current.
    pub locked_rotor_current_ratio: f64,
    /// Stator resistance where it was measured, warm from rated load, per unit.
    pub stator_resistance: Option<f64>,
    /// Printed current over the one that power, voltage, efficiency and power factor give.
    pub current_ratio: f64,
}

impl Targets {
    /// The rated point, per unit of the current that power, efficiency and power factor give.
    pub fn rating(&self) -> Rating {
        Rating {
            power: self.efficiency * self.power_factor,
            slip: self.slip,
        }
    }

    /// Reactive power at rated load, per unit.
    pub fn reactive(&self) -> f64 {
        (1.0 - self.power_factor * self.power_factor).sqrt()
    }

    /// Relative errors of a circuit; `breakdown_slip` is the slip of its greatest torque.
    pub fn misfits(&self, circuit: &Circuit, breakdown_slip: f64) -> Misfits {
        let rating = self.rating();
        let rated = circuit.at_rating(&rating);
        let power = rated.torque * (1.0 - rating.slip * circuit.slip_ratio);
        let breakdown = circuit.at_slip(&rating, breakdown_slip, Winding::Cold);
        let locked = circuit.at_slip(&rating, 1.0, Winding::Cold);
        let torque = rating.torque();
        let given = [
            (power, rating.power),
            (rated.reactive, self.reactive()),
            (breakdown.torque, self.breakdown_torque_ratio * torque),
            (locked.torque, self.locked_rotor_torque_ratio * torque),
            (
                locked.current / rated.current,
                self.locked_rotor_current_ratio,
            ),
            (power / rated.active, self.efficiency),
            (rated.current, self.current_ratio),
        ];
        Misfits::from_fn(|k, _| given[k].0 / given[k].1 - 1.0)
    }
}
