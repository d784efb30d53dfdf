//! What all checks look at.

use crate::expectation::Expectation;
use crate::levels::clipped::{Clipped, clipped};
use crate::measure::blocks::{Block, Three, blocks};
use crate::measure::statistics::median;
use num_complex::Complex64;
use recording::{Channel, Recording};
use std::collections::BTreeSet;

/// A recording with what has been found in it so far.
pub(super) struct Context<'r> {
    pub recording: &'r Recording,
    pub expectation: &'r Expectation,
    pub blocks: Vec<Block>,
    pub clipped: Vec<Clipped>,
    /// Channels whose phasors mean nothing: dead, effective values, of unknown polarity.
    pub unsound: BTreeSet<Channel>,
}

/// Share of the largest amplitude from which on a block's phasors are taken seriously.
const SIGNIFICANT: f64 = 0.05;
/// Fewer steady blocks than this are no basis; all blocks are used then.
const FEWEST_STEADY: usize = 3;

impl<'r> Context<'r> {
    pub fn new(recording: &'r Recording, expectation: &'r Expectation) -> Context<'r> {
        let blocks = blocks(recording);
        let omega = median(blocks.iter().map(|block| block.omega)).or(expectation.omega());
        Context {
            recording,
            expectation,
            clipped: clipped(recording, omega),
            blocks,
            unsound: BTreeSet::new(),
        }
    }

    /// Whether three channels exist and their phasors can be trusted.
    pub fn sound(&self, three: [Channel; 3]) -> bool {
        three.iter().all(|channel| {
            self.recording.channel(*channel).is_some() && !self.unsound.contains(channel)
        })
    }

    /// Blocks without clipping in which three channels carry a significant fundamental.
    pub fn alive(&self, three: [Channel; 3]) -> Vec<(&Block, &Three)> {
        let found: Vec<(&Block, &Three)> = self
            .blocks
            .iter()
            .filter(|block| !self.is_clipped(block, three))
            .filter_map(|block| Some((block, block.three(three)?)))
            .collect();
        let largest = found
            .iter()
            .map(|(_, three)| three.amplitude())
            .fold(0.0, f64::max);
        let significant = |(_, three): &(&Block, &Three)| three.amplitude() > SIGNIFICANT * largest;
        found.into_iter().filter(significant).collect()
    }

    /// The steady ones of [`Context::alive`], or all if hardly any is steady.
    pub fn settled(&self, three: [Channel; 3]) -> Vec<(&Block, &Three)> {
        let alive = self.alive(three);
        let steady: Vec<_> = alive
            .iter()
            .filter(|(block, _)| block.steady)
            .copied()
            .collect();
        if steady.len() >= FEWEST_STEADY {
            steady
        } else {
            alive
        }
    }

    /// Zero and counter sequence over the main one, each block's in the phase of its main sequence; of phases that follow each
    /// other as a, c, b conjugated, so that channels b and c stand where they do otherwise.
    pub fn ratios(&self, three: [Channel; 3]) -> Vec<(Complex64, Complex64)> {
        let ratio = |(_, three): &(&Block, &Three)| {
            let sequence = three.sequence();
            let over_main = |x: Complex64| match sequence.is_positive() {
                true => x / sequence.main(),
                false => (x / sequence.main()).conj(),
            };
            (over_main(sequence.zero), over_main(sequence.counter()))
        };
        self.settled(three).iter().map(ratio).collect()
    }

    /// Median frequency of the fundamental, rad/s.
    pub fn omega(&self) -> Option<f64> {
        median(self.blocks.iter().map(|block| block.omega))
    }

    fn is_clipped(&self, block: &Block, three: [Channel; 3]) -> bool {
        self.clipped
            .iter()
            .filter(|clipped| three.contains(&clipped.channel))
            .any(|clipped| clipped.touches(&block.range))
    }
}
