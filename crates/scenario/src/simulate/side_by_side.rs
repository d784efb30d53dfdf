//! The published experiment: a healthy and a faulty motor side by side, d-q data at intervals.

use super::{SimSample, Simulation, SimulationError};
use crate::Scenario;

/// One datum of both motors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DataPair {
    /// The motor without faults.
    pub healthy: SimSample,
    /// The motor with the scenario's faults, on the same supply and load and with the same noise.
    pub faulty: SimSample,
}

/// Runs a scenario with and without its faults; yields one pair every `data_interval_s` from
/// `record_from_s` on.
#[derive(Debug)]
pub struct SideBySide {
    healthy: Simulation,
    faulty: Simulation,
    stride: usize,
}

impl SideBySide {
    /// Prepares both motors.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn new(scenario: &Scenario) -> Result<SideBySide, SimulationError> {
        let stride = (scenario.data_interval_s * scenario.sample_rate_hz).round();
        Ok(SideBySide {
            healthy: Simulation::new(&scenario.healthy())?,
            faulty: Simulation::new(scenario)?,
            // At most an hour of samples at 1 MHz.
            stride: stride.max(1.0) as usize,
        })
    }
}

impl Iterator for SideBySide {
    type Item = DataPair;

    fn next(&mut self) -> Option<DataPair> {
        let pair = DataPair {
            healthy: self.healthy.next()?,
            faulty: self.faulty.next()?,
        };
        // The samples in between are simulated and left out.
        for _ in 1..self.stride {
            let _ = (self.healthy.next(), self.faulty.next());
        }
        Some(pair)
    }
}
