//! What the supply looks like: the LINE lamp.

use crate::frames::magnitude;
use crate::window::Window;

/// Limits of a supply under which the motor may be judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplyConfig {
    /// Rated phase voltage, amplitude, V.
    pub rated_voltage: f32,
    /// Rated frequency, rad/s.
    pub rated_omega: f32,
    /// Least and greatest voltage as shares of the rated one, at rated frequency.
    pub voltage_range: [f32; 2],
    /// Greatest negative over positive sequence of the voltage.
    pub max_unbalance: f32,
}

/// What is wrong with the supply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SupplyFinding {
    /// No voltage and no current.
    Lost,
    /// The phases turn the other way round.
    NegativeOrder,
    /// Voltage outside its range.
    Voltage,
    /// Negative sequence beyond its limit.
    Unbalance,
}

/// The voltage range is judged only this close to rated frequency: an inverter lowers both.
const FREQUENCY_BAND: f32 = 0.1;

impl SupplyConfig {
    /// Checks the supply of one window that has a voltage.
    #[inline(never)]
    pub fn check(&self, window: &Window) -> Option<SupplyFinding> {
        let (positive, negative) = (
            magnitude(window.u_s.positive),
            magnitude(window.u_s.negative),
        );
        if negative > positive {
            return Some(SupplyFinding::NegativeOrder);
        }
        if self.voltage_out_of_range(positive, window.omega_sync) {
            return Some(SupplyFinding::Voltage);
        }
        (negative > self.max_unbalance * positive).then_some(SupplyFinding::Unbalance)
    }

    fn voltage_out_of_range(&self, amplitude: f32, omega: f32) -> bool {
        let [least, greatest] = self.voltage_range;
        let rated = self.rated_voltage;
        let at_rated_frequency =
            (omega - self.rated_omega).abs() < FREQUENCY_BAND * self.rated_omega;
        at_rated_frequency && !(least * rated..=greatest * rated).contains(&amplitude)
    }
}
