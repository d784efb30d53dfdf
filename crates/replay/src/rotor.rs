//! What a whole replay says about the rotor's bars.

use monitor::{RotorReading, Sidebands};
use serde::Serialize;

/// Sidebands of the current at twice the slip frequency, over a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RotorSummary {
    /// Blocks that were measured, each four turns of twice the slip angle, without those that a load step or something else
    /// shook more; 0: not testable.
    pub blocks: u64,
    /// Mean amplitude at (1 - 2 s) times the supply's frequency, percent of the active current.
    pub lower_sideband_percent: Option<f64>,
    /// Mean amplitude at (1 + 2 s) times the supply's frequency, percent of the active current.
    pub upper_sideband_percent: Option<f64>,
    /// Lower sideband from which on bars count as broken, percent of the active current.
    pub broken_from_percent: f64,
    /// Whether bars counted as broken at any time.
    pub broken: bool,
}

/// Sums over the blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorHistory {
    blocks: u64,
    lower: f64,
    upper: f64,
    broken: bool,
}

impl RotorHistory {
    /// Adds one report's reading.
    pub fn add(&mut self, reading: &RotorReading) {
        self.broken |= reading.is_broken;
        let calm = |sidebands: &&Sidebands| !sidebands.normalised().is_nan();
        if let Some(sidebands) = reading.sidebands.as_ref().filter(calm) {
            self.blocks += 1;
            self.lower += f64::from(sidebands.lower);
            self.upper += f64::from(sidebands.upper);
        }
    }

    /// Whether bars counted as broken at any time.
    pub fn is_broken(&self) -> bool {
        self.broken
    }

    /// The means.
    pub fn summary(&self) -> RotorSummary {
        let mean = |sum: f64| (self.blocks > 0).then(|| 100.0 * sum / self.blocks as f64);
        RotorSummary {
            blocks: self.blocks,
            lower_sideband_percent: mean(self.lower),
            upper_sideband_percent: mean(self.upper),
            broken_from_percent: f64::from(100.0 * Sidebands::BROKEN),
            broken: self.broken,
        }
    }
}
