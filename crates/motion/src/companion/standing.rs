//! What is said in motion, window by window, beside the windows at rest.

use monitor::{Moving, MovingFault, NotJudged, Report};

use crate::gate::NotInMotion;
use crate::{MotionCycle, Named};

/// Which alarm counts in motion, and what stands of it. An alarm that comes in a window that is judged at rest is that window's affair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Why the latest cycle was not judged.
    not_judged: Option<NotInMotion>,
    /// Whether the latest window was left to motion.
    moves: bool,
    /// Whether the alarm that is on came in motion.
    counts: bool,
    named: Option<Named>,
    /// Whether nothing but a dead sensor is called a fault.
    is_doubted: bool,
}

impl Standing {
    /// Before the first sample. `is_doubted`: the motor in good order was never seen in motion, and what departs may be what its
    /// file lacks.
    pub fn new(is_doubted: bool) -> Self {
        Standing {
            not_judged: Some(NotInMotion::FluxUnknown),
            moves: true,
            counts: false,
            named: None,
            is_doubted,
        }
    }

    /// Takes a cycle.
    pub fn cycle(&mut self, cycle: &MotionCycle) {
        self.not_judged = cycle.not_judged;
        if let Some(alarm) = &cycle.alarm {
            match alarm.named {
                None => self.counts = self.moves,
                named => self.named = named,
            }
        }
        if !cycle.is_alarmed {
            (self.counts, self.named) = (false, None);
        }
    }

    /// Whether the alarm that is on came in motion.
    pub fn counts(&self) -> bool {
        self.counts
    }

    /// Takes the window that ends. Of one that is left to motion: why it was not judged there either.
    pub fn window(&mut self, report: &Report) -> Option<Result<(), NotInMotion>> {
        self.moves = report.not_judged.is_some_and(NotJudged::is_motion);
        self.moves.then(|| self.not_judged.map_or(Ok(()), Err))
    }

    /// What is said with the latest window.
    pub fn moving(&self) -> Moving {
        let named = self.named.filter(|_| self.counts);
        let is_sure = |fault: &MovingFault| {
            !self.is_doubted || matches!(fault.cause, monitor::MovingCause::Dead(_))
        };
        let fault = match named {
            Some(Named::Fault(fault)) => Some(fault).filter(is_sure),
            Some(Named::Untold) | None => None,
        };
        Moving {
            is_judged: self.moves && self.not_judged.is_none(),
            fault,
            is_unexplained: named.is_some() && fault.is_none(),
        }
    }
}
