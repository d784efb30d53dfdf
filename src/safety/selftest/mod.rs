//! Tests of the board by itself: at the start, and slice by slice while it runs (docs/firmware.md, "Tests of itself").

mod clock;
mod flash;
mod processor;
mod ram;
mod settings;

use board::{Doubt, Doubts};

use super::marks::{self, Mark};
use super::{faults, seal};
use clock::Calendar;
use flash::FlashTest;
use ram::RamTest;
use settings::Settings;

/// Steps between two looks of once a second: a block of 3.2 ms each, but for those in which a window ended.
const SECOND: u32 = 250;

/// What has been tested how far.
pub struct SelfTest {
    flash: FlashTest,
    ram: RamTest,
    settings: Option<Settings>,
    calendar: Calendar,
    doubts: Doubts,
    steps: u32,
}

impl SelfTest {
    /// Tests processor and flash as a whole; the RAM was tested before anything else. Takes some 20 ms.
    pub fn at_start() -> Self {
        let mut doubts = Doubts::default();
        doubts.set(Doubt::Processor, !processor::passes());
        let sealed = seal::read();
        doubts.set(Doubt::Unsealed, sealed.is_none());
        let mut flash = FlashTest::new(sealed);
        doubts.set(Doubt::Program, flash.whole().is_err());
        SelfTest {
            flash,
            ram: RamTest::default(),
            settings: None,
            calendar: Calendar::default(),
            doubts,
            steps: 0,
        }
    }

    /// What the tests have found so far.
    pub fn doubts(&self) -> Doubts {
        self.doubts
    }

    /// Remembers the settings of the peripherals that are meant to hold from now on.
    pub fn remember_settings(&mut self) {
        let now = self
            .settings
            .map_or_else(Settings::read, Settings::read_after);
        self.settings = Some(now);
    }

    /// Time is not counted over a pause.
    pub fn resume(&mut self) {
        self.calendar = Calendar::default();
    }

    /// One slice, after block number `block`; none where that block had a window to compute. A slice takes some thousand cycles
    /// at most.
    #[inline(never)]
    pub fn step(&mut self, block: u32, is_busy: bool) {
        if !is_busy {
            self.steps = self.steps.wrapping_add(1);
            self.slice(block);
        }
        marks::leave(Mark::SelfTest);
    }

    fn slice(&mut self, block: u32) {
        match self.steps % SECOND {
            0 => self.look_at_clock(block),
            1 => self.look_at_settings(),
            2 => {
                if !processor::passes() {
                    faults::end_untrusted();
                }
            }
            3 => {
                let sound = self.ram.slice();
                self.doubts
                    .set(Doubt::Ram, self.doubts.has(Doubt::Ram) || !sound);
            }
            slice if slice.is_multiple_of(9) => {
                if let Some(sound) = self.flash.slice() {
                    self.doubts.set(Doubt::Program, !sound);
                }
            }
            _ => {}
        }
    }

    fn look_at_clock(&mut self, block: u32) {
        let Some(found) = self.calendar.look(block) else {
            return;
        };
        self.doubts.set(Doubt::ClockRatio, !found.clock_is_sound);
        self.doubts.set(Doubt::Blocks, !found.blocks_are_sound);
    }

    fn look_at_settings(&mut self) {
        let changed = self
            .settings
            .is_some_and(|settings| settings != Settings::read());
        self.doubts.set(Doubt::Settings, changed);
    }
}
