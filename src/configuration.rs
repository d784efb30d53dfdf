//! Configurations from the line: checked, on trial, confirmed or given up.

use board::modbus::{BoardStatus, Command};
use board::{Compiled, Configuration, ConfigurationStore, Configurator};
use embassy_time::Instant;
use static_cell::ConstStaticCell;

use crate::hardware::flash_store::GuardedFlash;
use crate::hardware::serial;

/// What a command or the time has changed, for which judging stops for a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Another configuration holds.
    Holds,
    /// A trial was given up, and what held before holds again.
    HoldsAgain,
    /// What is on trial has to be stored.
    Confirm,
}

/// Too large for the stack.
static HOLDS: ConstStaticCell<Configuration> = ConstStaticCell::new(Configuration::BLANK);

/// What holds, and what is on trial.
pub struct Settings {
    configurator: Configurator<GuardedFlash>,
    holds: &'static mut Configuration,
}

fn now_s() -> u32 {
    Instant::now().as_secs() as u32
}

impl Settings {
    /// Looks up what holds at the start.
    pub fn new(
        compiled: Compiled,
        store: Option<ConfigurationStore<GuardedFlash>>,
        factory_line: bool,
    ) -> Self {
        let (mut configurator, holds) = (
            Configurator::new(compiled, store, factory_line),
            HOLDS.take(),
        );
        configurator.standing(holds);
        Settings {
            configurator,
            holds,
        }
    }

    /// The configuration that holds.
    pub fn holds(&self) -> &Configuration {
        self.holds
    }

    /// What a master's command changes.
    #[inline(never)]
    pub fn obey(&mut self, command: Command) -> Option<Change> {
        match command {
            Command::Commit => self.commit(),
            Command::CommitCompiled => {
                self.configurator.commit_compiled(self.holds, now_s());
                Some(Change::Holds)
            }
            Command::Confirm => {
                let awaited = self.configurator.awaits_confirmation();
                awaited.then_some(Change::Confirm)
            }
            Command::Discard => {
                let ended = self.configurator.discard(self.holds);
                ended.then_some(Change::HoldsAgain)
            }
            Command::Acknowledge
            | Command::Learn
            | Command::Prepare
            | Command::ReleaseCapture
            | Command::Install => None,
        }
    }

    /// Takes what a master has written, and puts back what holds where it is refused.
    fn commit(&mut self) -> Option<Change> {
        serial::copy_staged(self.holds);
        let taken = self.configurator.commit(self.holds, now_s());
        if !taken {
            serial::copy_active(self.holds);
        }
        taken.then_some(Change::Holds)
    }

    /// What the time changes.
    pub fn look(&mut self) -> Option<Change> {
        let ended = self.configurator.look(now_s(), self.holds);
        ended.then_some(Change::HoldsAgain)
    }

    /// Stores what is on trial; whether it is stored.
    pub fn confirm(&mut self) -> bool {
        self.configurator.confirm(self.holds)
    }

    /// Whether a configuration is on trial.
    pub fn is_on_trial(&self) -> bool {
        self.configurator.seconds_left(now_s()).is_some()
    }

    /// Writes what Modbus tells about it.
    pub fn describe(&self, status: &mut BoardStatus) {
        status.configuration = self.configurator.source();
        status.refused = self.configurator.refused();
        let left = self.configurator.seconds_left(now_s());
        status.trial_s = left.unwrap_or(0) as u16;
    }
}
