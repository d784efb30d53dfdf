//! What the supply looks like: the LINE lamp.

use crate::window::Window;
use frames::magnitude;

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

#[cfg(test)]
mod tests {
    use num_complex::Complex32;

    use super::*;
    use frames::Sequence;

    const CONFIG: SupplyConfig = SupplyConfig {
        rated_voltage: 300.0,
        rated_omega: 314.0,
        voltage_range: [0.75, 1.2],
        max_unbalance: 0.03,
    };

    /// Finding for amplitudes of positive and negative sequence, V, and a frequency, rad/s.
    fn found(positive: f32, negative: f32, omega_sync: f32) -> Option<SupplyFinding> {
        let u_s = Sequence {
            positive: Complex32::from_polar(positive, 0.3),
            negative: Complex32::from_polar(negative, -1.2),
            zero: Complex32::ZERO,
        };
        CONFIG.check(&Window {
            u_s,
            omega_sync,
            ..Window::default()
        })
    }

    #[test]
    fn a_supply_within_its_limits_is_no_finding() {
        for positive in [226.0, 300.0, 359.0] {
            assert_eq!(found(positive, 0.029 * positive, 314.0), None);
        }
    }

    #[test]
    fn voltage_beyond_either_limit_is_found_at_rated_frequency() {
        for positive in [224.0, 361.0] {
            for omega in [314.0, 0.91 * 314.0, 1.09 * 314.0] {
                assert_eq!(found(positive, 0.0, omega), Some(SupplyFinding::Voltage));
            }
        }
    }

    /// An inverter lowers voltage and frequency together.
    #[test]
    fn voltage_is_no_finding_far_from_rated_frequency() {
        for omega in [0.89 * 314.0, 1.11 * 314.0, 31.4] {
            assert_eq!(found(100.0, 0.0, omega), None);
        }
    }

    #[test]
    fn unbalance_is_found_within_the_voltage_range() {
        assert_eq!(found(300.0, 9.1, 314.0), Some(SupplyFinding::Unbalance));
        // Half a voltage is first of all too little of it.
        assert_eq!(found(150.0, 149.0, 314.0), Some(SupplyFinding::Voltage));
    }
}
