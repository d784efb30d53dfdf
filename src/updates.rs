//! A new program over the line: its pieces go to flash between two blocks, the loader is asked, and a new one is on trial.

use board::modbus::UpdateStatus;
use board::{Doubts, EventCause};
use update::{Due, News, Refusal, UpdateState, Updater, Version};

use crate::hardware::flash_store::GuardedFlash;
use crate::hardware::serial;
use crate::safety;

/// Steps until masters have read that the board starts again, 0.1 s.
const ANSWER_STEPS: u32 = 32;
/// Version of this program.
pub const VERSION: Version = Version::parse(env!("CARGO_PKG_VERSION"));

/// What is known of updates; nothing on a chip whose banks are joined.
pub struct Updates {
    updater: Option<Updater<GuardedFlash>>,
    asked: u32,
    due: Option<Due>,
}

impl Updates {
    /// Takes no pieces before the first step.
    pub fn new(updater: Option<Updater<GuardedFlash>>) -> Self {
        Updates {
            updater,
            asked: 0,
            due: None,
        }
    }

    /// A short piece of work, with which 0.4 ms pass at most.
    #[inline(never)]
    pub fn step(&mut self, obstacle: Option<Refusal>) {
        let Some(updater) = &mut self.updater else {
            return;
        };
        let open = updater.is_open();
        let portion = serial::with_tray(|tray| {
            tray.set_open(open);
            tray.portion()
        });
        let settled = updater.step(portion.flatten().as_ref());
        serial::with_tray(|tray| tray.follow(settled));
        if updater.state() != UpdateState::Asked {
            self.asked = 0;
            return;
        }
        self.asked += 1;
        if self.asked == ANSWER_STEPS && updater.ask(obstacle) {
            defmt::info!("starting again for a new program");
            cortex_m::peripheral::SCB::sys_reset();
        }
    }

    /// A master wants what was received.
    #[inline(never)]
    pub fn install(&mut self, obstacle: Option<Refusal>) {
        if let Some(updater) = &mut self.updater {
            updater.install(obstacle);
        }
    }

    /// A second of sampling has passed.
    pub fn second(&mut self, doubts: Doubts) {
        let updater = self.updater.as_mut();
        self.due = updater.and_then(|updater| updater.second(doubts.stop_judging()));
    }

    /// Samples were missing.
    pub fn disturb(&mut self) {
        if let Some(updater) = &mut self.updater {
            updater.disturb();
        }
    }

    /// Whether [`Updates::settle`] has something to do.
    pub fn is_due(&self) -> bool {
        self.due.is_some()
    }

    /// Ends a trial, while nothing is sampled: flash of the program's own bank may be erased, in which 22 ms pass.
    #[inline(never)]
    pub fn settle(&mut self) {
        match self.due.take() {
            Some(Due::Confirm) => {
                if let Some(updater) = &mut self.updater {
                    updater.confirm();
                }
            }
            Some(Due::GiveUp) => {
                defmt::error!("this program gives itself up");
                cortex_m::peripheral::SCB::sys_reset();
            }
            None => {}
        }
    }

    /// What happened since the last look.
    pub fn take_event(&mut self) -> Option<(EventCause, [u32; 2])> {
        let news = self.updater.as_mut()?.take_news()?;
        let (_, checksum) = safety::program().unwrap_or_default();
        let program = [VERSION.0, checksum];
        Some(match news {
            News::Installed => (EventCause::UpdateInstalled, program),
            News::Confirmed => (EventCause::UpdateConfirmed, program),
            News::BroughtBack => (EventCause::UpdateReverted, program),
            News::Refused(refusal) => (EventCause::UpdateRefused, [refusal as u32, 0]),
        })
    }

    /// What Modbus tells about it.
    pub fn status(&self) -> UpdateStatus {
        let Some(updater) = &self.updater else {
            return UpdateStatus::default();
        };
        UpdateStatus {
            state: updater.state(),
            refused: updater.refused(),
            bytes: updater.received(),
            trial_s: updater.seconds_left().unwrap_or(0),
        }
    }
}
