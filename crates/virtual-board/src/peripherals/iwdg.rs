//! The independent watchdog on its own 32 kHz oscillator.

use crate::CORE_HZ;
use crate::peripherals::registers::Unmodelled;

const LSI_HZ: u64 = 32_000;

/// State; once started only a reset stops it.
#[derive(Clone, Debug)]
pub struct Iwdg {
    writable: bool,
    prescaler: u32,
    reload: u32,
    deadline: Option<u64>,
}

impl Iwdg {
    /// After reset.
    pub fn new() -> Self {
        Iwdg {
            writable: false,
            prescaler: 0,
            reload: 0xFFF,
            deadline: None,
        }
    }

    /// Cycle at which it resets the chip.
    pub fn deadline(&self) -> Option<u64> {
        self.deadline
    }

    fn period(&self) -> u64 {
        let ticks = (u64::from(self.reload) + 1) << (2 + self.prescaler.min(6));
        ticks * CORE_HZ / LSI_HZ
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            0x4 => Ok(self.prescaler),
            0x8 => Ok(self.reload),
            0xC => Ok(0),
            _ => Err(unmodelled("read".into(), offset)),
        }
    }

    /// A bus write at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<(), Unmodelled> {
        match (offset, value) {
            (0x0, 0x5555) => self.writable = true,
            (0x0, 0xAAAA) => self.deadline = self.deadline.map(|_| now + self.period()),
            (0x0, 0xCCCC) => {
                self.writable = false;
                self.deadline = Some(now + self.period());
            }
            (0x4, _) if self.writable => self.prescaler = value & 7,
            (0x8, _) if self.writable => self.reload = value & 0xFFF,
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
