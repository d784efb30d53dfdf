//! What makes a defective board say so: its start, its tests of itself, and what remains of a crash.

pub mod clock;
pub mod faults;
pub mod marks;
pub mod options;
pub mod protection;
pub mod retained;
mod seal;
pub mod selftest;
mod start;
pub mod watchdog;

use board::{FaultCause, FaultRecord};

use crate::hardware::housekeeping::ResetCause;

/// How the program came to run.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Why the chip was reset.
    pub cause: ResetCause,
    /// The crash that led to it.
    pub crash: Option<FaultRecord>,
    /// Crashes without a quiet minute between them.
    pub crashes: u32,
    /// There were too many.
    pub gives_up: bool,
}

impl Start {
    /// Reads flags and record, and clears them for the next time.
    pub fn take() -> Self {
        retained::open();
        let cause = ResetCause::take();
        let crash = retained::take(cause == ResetCause::Watchdog);
        if crash.is_some() {
            retained::count_crash();
        }
        Start {
            cause,
            crash,
            crashes: retained::crashes(),
            gives_up: retained::are_too_many(),
        }
    }

    /// Whether the crystal did not stop just before.
    pub fn trusts_crystal(&self) -> bool {
        let stopped = |crash: FaultRecord| crash.cause == FaultCause::ClockFailure;
        !self.crash.is_some_and(stopped)
    }
}

/// Length and checksum that the program was sealed with.
pub fn program() -> Option<(u32, u32)> {
    seal::read()
}
