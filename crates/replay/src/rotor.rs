//! What a whole replay says about the rotor's bars.

use monitor::{Cage, CageLimits, RotorReading, Sidebands};
use schemars::JsonSchema;
use serde::Serialize;

/// The answer about the cage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub enum RotorCage {
    /// No block was measured.
    #[default]
    #[serde(rename = "not tested")]
    NotTested,
    /// Sidebands as whole cages leave them.
    #[serde(rename = "whole")]
    Whole,
    /// Most blocks show more than most whole cages leave, or than this one left at its calibration; no FAULT.
    #[serde(rename = "doubtful")]
    Doubtful,
    /// Bars counted as broken at some time.
    #[serde(rename = "broken")]
    Broken,
}

/// Sidebands of the current at twice the slip frequency, over a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct RotorSummary {
    /// The answer.
    pub state: RotorCage,
    /// Blocks that were measured, each four turns of twice the slip angle, without those that a load step or something else
    /// shook more; 0: not testable.
    pub blocks: u64,
    /// Blocks in which the load swung at twice the slip frequency, as broken bars make the speed swing: they say nothing about the cage.
    pub swinging_blocks: u64,
    /// Mean amplitude at (1 - 2 s) times the supply's frequency, percent of the active current.
    pub lower_sideband_percent: Option<f64>,
    /// Mean amplitude at (1 + 2 s) times the supply's frequency, percent of the active current.
    pub upper_sideband_percent: Option<f64>,
    /// Mean of the lines beside the lower sideband, percent of the active current: the motor's own unrest.
    pub beside_percent: Option<f64>,
    /// Lower sideband from which on the cage is doubtful, percent of the active current, at the mean load of the blocks.
    pub doubtful_from_percent: f64,
    /// Lower sideband from which on bars count as broken, percent of the active current, at the mean load of the blocks.
    pub broken_from_percent: f64,
    /// Lower sideband of the calibrated motor at the same load, percent of the active current; absent without a calibration.
    pub at_calibration_percent: Option<f64>,
    /// Whether bars counted as broken at any time.
    pub broken: bool,
}

impl RotorSummary {
    /// Whether the sidebands are as large as broken bars make them, in fewer blocks than it takes to be sure.
    pub fn is_suspected(&self) -> bool {
        let is_large = |lower: f64| lower >= self.broken_from_percent;
        self.state == RotorCage::Doubtful && self.lower_sideband_percent.is_some_and(is_large)
    }

    /// The lower sideband over that at calibration, where both are known and the latter can be divided by.
    pub fn growth(&self) -> Option<f64> {
        let before = self.at_calibration_percent.filter(|x| *x >= LEAST_BEFORE)?;
        Some(self.lower_sideband_percent? / before)
    }
}

/// Sideband, percent, below which a ratio to it says nothing.
const LEAST_BEFORE: f64 = 0.02;

/// Sums over the blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorHistory {
    blocks: u64,
    doubtful_blocks: u64,
    swinging_blocks: u64,
    lower: f64,
    upper: f64,
    beside: f64,
    doubtful_from: f64,
    broken_from: f64,
    healthy: Option<f64>,
    broken: bool,
}

impl RotorHistory {
    /// Adds one report's reading.
    pub fn add(&mut self, reading: &RotorReading) {
        self.broken |= reading.is_broken;
        let (Some(sidebands), Some(limits)) = (&reading.sidebands, &reading.limits) else {
            return;
        };
        if limits.is_hidden(sidebands) {
            self.swinging_blocks += 1;
        } else if !limits.normalised(sidebands).is_nan() {
            self.add_block(sidebands, limits);
        }
    }

    fn add_block(&mut self, sidebands: &Sidebands, limits: &CageLimits) {
        self.blocks += 1;
        self.doubtful_blocks += u64::from(limits.raises_doubt(sidebands));
        self.lower += f64::from(sidebands.lower);
        self.upper += f64::from(sidebands.upper);
        self.beside += f64::from(sidebands.beside);
        self.doubtful_from += f64::from(limits.doubtful);
        self.broken_from += f64::from(limits.broken);
        if let Some(healthy) = limits.healthy {
            *self.healthy.get_or_insert(0.0) += f64::from(healthy);
        }
    }

    /// Whether bars counted as broken at any time.
    pub fn is_broken(&self) -> bool {
        self.broken
    }

    fn state(&self) -> RotorCage {
        match self.blocks {
            _ if self.broken => RotorCage::Broken,
            0 => RotorCage::NotTested,
            blocks if 2 * self.doubtful_blocks > blocks => RotorCage::Doubtful,
            _ => RotorCage::Whole,
        }
    }

    /// The means.
    pub fn summary(&self) -> RotorSummary {
        let mean = |sum: f64| (self.blocks > 0).then(|| 100.0 * sum / self.blocks as f64);
        let or_usual = |sum, usual| mean(sum).unwrap_or(100.0 * f64::from(usual));
        RotorSummary {
            state: self.state(),
            blocks: self.blocks,
            swinging_blocks: self.swinging_blocks,
            lower_sideband_percent: mean(self.lower),
            upper_sideband_percent: mean(self.upper),
            beside_percent: mean(self.beside),
            doubtful_from_percent: or_usual(self.doubtful_from, Cage::DOUBTFUL),
            broken_from_percent: or_usual(self.broken_from, Cage::BROKEN),
            at_calibration_percent: self.healthy.and_then(mean),
            broken: self.broken,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(cage: &Cage, lower_percent: &[f32]) -> RotorHistory {
        let mut history = RotorHistory::default();
        for lower in lower_percent {
            let sidebands = Sidebands {
                lower: 0.01 * lower,
                upper: 0.002,
                from_speed: 0.002,
                from_cage: 0.01 * lower,
                beside: 0.0005,
                active: 3.0,
            };
            history.add(&RotorReading {
                sidebands: Some(sidebands),
                limits: Some(cage.limits(0.75, 2.0)),
                is_broken: false,
            });
        }
        history
    }

    #[test]
    fn the_answer_follows_most_blocks() {
        let state = |blocks: &[f32]| history(&Cage::UNKNOWN, blocks).summary().state;
        assert_eq!(state(&[]), RotorCage::NotTested);
        assert_eq!(state(&[0.3, 0.6]), RotorCage::Whole);
        assert_eq!(state(&[0.6, 0.3, 0.6]), RotorCage::Doubtful);
        let mut broken = history(&Cage::UNKNOWN, &[0.3]);
        broken.add(&RotorReading {
            is_broken: true,
            ..RotorReading::default()
        });
        assert_eq!(broken.summary().state, RotorCage::Broken);
    }

    #[test]
    fn a_swinging_load_says_nothing_about_the_cage() {
        let mut history = history(&Cage::UNKNOWN, &[]);
        let sidebands = Sidebands {
            lower: 0.02,
            upper: 0.018,
            from_speed: 0.019,
            from_cage: 0.002,
            beside: 0.0005,
            active: 3.0,
        };
        history.add(&RotorReading {
            sidebands: Some(sidebands),
            limits: Some(Cage::UNKNOWN.limits(0.75, 2.0)),
            is_broken: false,
        });
        let summary = history.summary();
        assert_eq!(
            (summary.state, summary.swinging_blocks),
            (RotorCage::NotTested, 1)
        );
        let told = crate::words::rotor(&summary);
        assert!(
            told.contains("in 1 block the load swings at twice the slip frequency"),
            "{told}"
        );
    }

    #[test]
    fn a_calibrated_cage_is_compared_with_itself() {
        let cage = Cage {
            healthy: Some(monitor::HealthySidebands {
                at: [0.5, 1.0],
                lower: [0.003, 0.005],
                scatter: 0.0,
            }),
            ..Cage::UNKNOWN
        };
        let summary = history(&cage, &[0.8; 4]).summary();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
        close(summary.at_calibration_percent.unwrap(), 0.4);
        close(summary.growth().unwrap(), 2.0);
        close(summary.broken_from_percent, 0.65);
        close(summary.doubtful_from_percent, 0.525);
        let unknown = history(&Cage::UNKNOWN, &[0.8; 4]).summary();
        assert_eq!(
            (unknown.at_calibration_percent, unknown.growth()),
            (None, None)
        );
        close(unknown.broken_from_percent, 1.25);
    }
}
