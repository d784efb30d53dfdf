//! What runs how fast: every clock follows from the switch, the dividers and the oscillators that are steady.

use super::Machine;
use crate::TICK_HZ;
use crate::peripherals::registers::Unmodelled;

/// Hz; above it the core's supply has to be boosted, and below it no step in between is needed.
const MOST_UNBOOSTED_HZ: u64 = 150_000_000;
const STEP_FROM_HZ: u64 = 80_000_000;
/// Hz that one wait state of the flash is good for, boosted and not.
const PER_STATE_HZ: [u64; 2] = [30_000_000, 34_000_000];
/// PWR_CR5, its reset value's bit: not boosted. PWR_CR2 and PWR_SR2: the programmable voltage detector.
const CR5: u32 = 0x80;
const NOT_BOOSTED: u32 = 1 << 8;
const CR2: u32 = 0x04;
const SR2: u32 = 0x14;
const DETECTOR_OUTPUT: u32 = 1 << 11;
/// mV; thresholds of the voltage detector by its level (data sheet, typical).
const DETECTOR_MILLIVOLT: [u32; 8] = [2_000, 2_200, 2_400, 2_500, 2_600, 2_800, 2_900, 0];

impl Machine {
    /// Takes over what was written to anything that decides about clocks.
    pub(super) fn follow_clocks(&mut self) -> Result<(), Unmodelled> {
        let before = self.cycle.map_or(0, |cycle| TICK_HZ / cycle);
        self.set_clocks();
        let Some(now) = self.cycle.map(|cycle| TICK_HZ / cycle) else {
            return Ok(());
        };
        let boosted = self.pwr.get(CR5) & NOT_BOOSTED == 0;
        let states = self.flash.wait_states() + 1;
        let refuse = |what: &str| {
            Err(Unmodelled {
                block: "RCC",
                access: format!("{} MHz {what}", now / 1_000_000),
                offset: 0x08,
            })
        };
        match () {
            () if now > MOST_UNBOOSTED_HZ && !boosted => refuse("without the boost of the supply"),
            () if now > states * PER_STATE_HZ[usize::from(boosted)] => {
                refuse("with too few wait states of the flash")
            }
            () if now > STEP_FROM_HZ && now > before + before / 2 && before > 0 => {
                refuse("at once: above 80 MHz half the frequency comes in between")
            }
            () => Ok(()),
        }
    }

    /// Gives every block the clock that it has now.
    pub(super) fn set_clocks(&mut self) {
        let hz = self.rcc.core_hz(self.now);
        self.cycle = hz.map(|hz| TICK_HZ / hz);
        // A stopped clock counts nothing: the next edge is beyond all time that is emulated.
        let cycle = self.cycle.unwrap_or(u64::MAX >> 24);
        for timer in [&mut self.tim3, &mut self.tim4, &mut self.tim15] {
            timer.set_clock(cycle, self.now);
        }
        self.usart1.clock = cycle;
        self.lpuart1.clock = cycle;
        let dividers = [0, 1].map(|k| converter_divider(self.common[k].get(0x08)));
        for (adc, divider) in [&mut self.adc1, &mut self.adc5].into_iter().zip(dividers) {
            adc.clock = cycle.saturating_mul(divider);
        }
    }

    /// The outside world has changed an oscillator.
    pub fn change_clocks(&mut self) {
        self.set_clocks();
        self.next_event = self.now;
    }

    /// Takes over what was written to the backup domain's control.
    pub(super) fn follow_backup(&mut self) {
        if self.rcc.resets_backup() {
            self.backup.clear();
        }
        self.backup
            .drive_calendar(self.rcc.drives_calendar(), self.now);
    }

    /// Status bits that the supply sets in a register of PWR.
    pub(super) fn power_flags(&self, offset: u32) -> u32 {
        let control = self.pwr.get(CR2);
        let level = DETECTOR_MILLIVOLT[(control >> 1 & 7) as usize];
        let supply = self.detector_millivolt.unwrap_or(self.vdda_millivolt);
        let low = control & 1 == 1 && supply < level;
        if offset == SR2 && low {
            DETECTOR_OUTPUT
        } else {
            0
        }
    }
}

/// Core cycles per cycle of a converter, from the common control register.
fn converter_divider(control: u32) -> u64 {
    const PRESCALERS: [u64; 16] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256, 1, 1, 1, 1];
    match control >> 16 & 3 {
        0 => PRESCALERS[(control >> 18 & 0xF) as usize],
        1 => 1,
        synchronous => 1 << (synchronous - 1),
    }
}
