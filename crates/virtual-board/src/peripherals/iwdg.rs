//! The independent watchdog on its own oscillator of some 32 kHz.

use crate::TICK_HZ;
use crate::peripherals::registers::Unmodelled;

/// State; once started only a reset stops it.
#[derive(Clone, Debug)]
pub struct Iwdg {
    writable: bool,
    prescaler: u32,
    reload: u32,
    window: u32,
    /// When it was fed last, and when it resets the chip; `None` before the start.
    running: Option<(u64, u64)>,
    /// It was fed before its window opened: the chip is reset now.
    fed_too_early: bool,
}

impl Iwdg {
    /// After reset. An option byte may have hardware start it at once, with its longest time at the smallest prescaler.
    pub fn new(by_hardware: bool, now: u64, lsi_hz: u64) -> Self {
        let mut watchdog = Iwdg {
            writable: false,
            prescaler: 0,
            reload: 0xFFF,
            window: 0xFFF,
            running: None,
            fed_too_early: false,
        };
        if by_hardware {
            watchdog.reload(now, lsi_hz);
        }
        watchdog
    }

    /// When it resets the chip.
    pub fn deadline(&self) -> Option<u64> {
        self.running
            .map(|(fed, at)| if self.fed_too_early { fed } else { at })
    }

    fn ticks(&self, counts: u32, lsi_hz: u64) -> u64 {
        (u64::from(counts) << (2 + self.prescaler.min(6))) * TICK_HZ / lsi_hz
    }

    fn reload(&mut self, now: u64, lsi_hz: u64) {
        self.running = Some((now, now + self.ticks(self.reload + 1, lsi_hz)));
    }

    fn feed(&mut self, now: u64, lsi_hz: u64) {
        let Some((fed, _)) = self.running else {
            return;
        };
        let closed = self.reload.saturating_sub(self.window);
        self.fed_too_early |= now < fed + self.ticks(closed, lsi_hz);
        if !self.fed_too_early {
            self.reload(now, lsi_hz);
        }
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            0x4 => Ok(self.prescaler),
            0x8 => Ok(self.reload),
            // Updates take effect at once.
            0xC => Ok(0),
            0x10 => Ok(self.window),
            _ => Err(unmodelled("read".into(), offset)),
        }
    }

    /// A bus write.
    pub fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: u64,
        lsi_hz: u64,
    ) -> Result<(), Unmodelled> {
        match (offset, value) {
            (0x0, 0x5555) => self.writable = true,
            (0x0, 0xAAAA) => self.feed(now, lsi_hz),
            (0x0, 0xCCCC) => {
                self.writable = false;
                if self.running.is_none() {
                    self.reload(now, lsi_hz);
                }
            }
            (0x4, _) if self.writable => self.prescaler = value & 7,
            (0x8, _) if self.writable => self.reload = value & 0xFFF,
            (0x10, _) if self.writable => {
                self.window = value & 0xFFF;
                if self.running.is_some() {
                    self.reload(now, lsi_hz);
                }
            }
            _ => return Err(unmodelled(format!("write of {value:#x}"), offset)),
        }
        Ok(())
    }
}

fn unmodelled(access: String, offset: u32) -> Unmodelled {
    Unmodelled {
        block: "IWDG",
        access,
        offset,
    }
}
