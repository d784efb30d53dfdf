//! What was counted of boards behind motors anywhere.

use std::fmt::{Display, Formatter, Result};

use crate::anywhere::Outcome;
use campaign::Share;

/// Boards, and those of them that were calibrated and lit a lamp.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    boards: u64,
    refused: u64,
    windows: u64,
    fault: u64,
    fault_uncalibrated: u64,
    sensor: u64,
}

impl Counts {
    /// Counts a board.
    pub fn add(&mut self, outcome: &Outcome) {
        self.boards += 1;
        self.windows += outcome.windows as u64;
        if outcome.refused {
            self.refused += 1;
            return;
        }
        self.fault += u64::from(outcome.faults > 0);
        self.fault_uncalibrated += u64::from(outcome.faults_uncalibrated > 0);
        self.sensor += u64::from(outcome.sensors > 0);
    }

    /// The table of docs/wiring.md.
    pub fn table(&self) -> String {
        let of = self.boards - self.refused;
        let row = |what: &str, count: u64| {
            let most = 100.0 * Share { count, of }.at_most();
            format!("| {what} | {count} of {of} (at most {most:.2} %, 95 %) |\n")
        };
        let rows = [
            format!("| of {} boards | |\n|---|---|\n", self.boards),
            format!("| calibration refused | {} |\n", self.refused),
            row(
                &format!("FAULT in {} judged windows, calibrated", self.windows),
                self.fault,
            ),
            row(
                "FAULT by the motor file's own thresholds",
                self.fault_uncalibrated,
            ),
            row("SENSOR", self.sensor),
        ];
        rows.concat()
    }
}

impl Display for Counts {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(
            f,
            "{} judged: {} refused, FAULT {} in {} windows, by the file's thresholds {}, SENSOR {}",
            self.boards,
            self.refused,
            self.fault,
            self.windows,
            self.fault_uncalibrated,
            self.sensor
        )
    }
}
