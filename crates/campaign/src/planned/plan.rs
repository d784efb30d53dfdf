//! What a campaign consists of: motors, blocks of conditions, faults and sizes; every run follows from its index.

use std::path::PathBuf;

use motor::MotorFile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::planned::axis::{AXES, Conditions, Grid};
use crate::planned::fault::FaultKind;
use scenario::Start;

/// A whole campaign, validated.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What it is called.
    pub name: String,
    /// Master seed.
    pub seed: u64,
    /// The motors, each run through every block.
    pub motors: Vec<MotorPair>,
    /// The blocks, one after the other.
    pub blocks: Vec<Block>,
    /// Hash of everything that decides about a run: plan, motor files, version of this program.
    pub fingerprint: u64,
}

/// What is simulated and what the monitor is told.
#[derive(Clone, Debug)]
pub struct MotorPair {
    /// Name in tables: that of the monitor's file, without its ending.
    pub name: String,
    /// The motor file that the monitor works with.
    pub monitor: MotorFile,
    /// The motor file that is simulated.
    pub plant: MotorFile,
    /// Where the two were read.
    pub files: [PathBuf; 2],
}

/// How the load is known to the monitor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadKnowledge {
    /// Friction that never changes, of the right size in the motor file: the paper's case.
    Friction,
    /// Any torque; nothing is declared.
    Free,
}

/// Runs under conditions of one kind.
#[derive(Clone, Debug)]
pub struct Block {
    /// What it is called.
    pub name: String,
    /// What the monitor knows about the load.
    pub load: LoadKnowledge,
    /// At rest, switched on at t = 0, or running.
    pub start: Start,
    /// Whether FAULT in motion counts too, as `drivemon monitor` judges; the board judges at rest alone.
    pub in_motion: bool,
    /// Healthy time before the fault, or altogether, s.
    pub healthy_s: f64,
    /// Time with the fault, s.
    pub faulty_s: f64,
    /// Values of every axis.
    pub grids: [Grid; AXES],
    /// Whether every run draws its conditions; otherwise the full product is run.
    pub drawn: bool,
    /// Draws, or repetitions of the full product.
    pub repeats: u64,
    /// Faults with their sizes; empty: healthy runs.
    pub cases: Vec<Case>,
    /// What is wanted of each fault.
    pub targets: Vec<Target>,
}

/// A fault of one size.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// What breaks.
    pub kind: &'static FaultKind,
    /// By how much, percent.
    pub percent: f64,
}

/// What is wanted of a fault, and why it may be out of reach.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema, Deserialize)]
pub struct Target {
    /// Name of the block.
    pub block: String,
    /// Name of the fault.
    pub fault: String,
    /// Size that is to be detected, percent; absent where nothing is asked.
    pub percent: Option<f64>,
    /// What limits the detection, in words.
    pub limit: String,
    /// What keeps it from being told from its rival of the paper's Table 1, in words.
    #[serde(default)]
    pub pair_limit: String,
}

/// One run's place in the plan.
#[derive(Clone, Copy, Debug)]
pub struct Place<'p> {
    /// Its motor.
    pub motor: &'p MotorPair,
    /// Its block.
    pub block: &'p Block,
    /// Its fault.
    pub case: Option<Case>,
    /// Its place in the full product.
    cell: usize,
}

impl Block {
    /// Combinations in the full product; 1 where conditions are drawn.
    pub fn cells(&self) -> u64 {
        if self.drawn {
            return 1;
        }
        self.grids.iter().map(|grid| grid.len() as u64).product()
    }

    /// Faults and sizes, the healthy motor counting as one.
    fn case_count(&self) -> u64 {
        self.cases.len().max(1) as u64
    }

    /// Runs with `motors` motors.
    pub fn runs(&self, motors: usize) -> u64 {
        self.repeats * motors as u64 * self.case_count() * self.cells()
    }

    /// Length of a run, s.
    pub fn duration_s(&self) -> f64 {
        self.healthy_s
            + if self.cases.is_empty() {
                0.0
            } else {
                self.faulty_s
            }
    }
}

impl Plan {
    /// Number of runs.
    pub fn runs(&self) -> u64 {
        self.blocks
            .iter()
            .map(|block| block.runs(self.motors.len()))
            .sum()
    }

    /// Where a run stands; `None` beyond the last. Repetitions vary slowest, so that the beginning of a campaign has
    /// seen everything once.
    pub fn place(&self, index: u64) -> Option<Place<'_>> {
        let mut rest = index;
        for block in &self.blocks {
            let runs = block.runs(self.motors.len());
            if rest >= runs {
                rest -= runs;
                continue;
            }
            let mut digit = |base: u64| {
                let digit = rest % base;
                rest /= base;
                // Below the length of something in memory.
                digit as usize
            };
            let cell = digit(block.cells());
            let case = digit(block.case_count());
            return Some(Place {
                motor: &self.motors[digit(self.motors.len() as u64)],
                block,
                case: block.cases.get(case).copied(),
                cell,
            });
        }
        None
    }
}

impl Place<'_> {
    /// The conditions, with a source of uniform random numbers that is told the axis: one is drawn for every axis, needed or
    /// not.
    pub fn conditions(&self, mut uniform: impl FnMut(usize) -> f64) -> Conditions {
        let mut cell = self.cell;
        let mut value = |axis: usize, grid: &Grid| {
            let position = cell % grid.len();
            cell /= grid.len();
            let u = uniform(axis);
            if self.block.drawn {
                grid.drawn(u)
            } else {
                grid.at(position)
            }
        };
        Conditions(std::array::from_fn(|k| value(k, &self.block.grids[k])))
    }
}
