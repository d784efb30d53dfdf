//! Clocks and reset flags: oscillators that take their time and may fail, the switch between them, the clock security
//! system; enables are enforced elsewhere.

use crate::TICK_HZ;
use crate::peripherals::registers::{Registers, Unmodelled};

const CR: u32 = 0x00;
const CFGR: u32 = 0x08;
const PLLCFGR: u32 = 0x0C;
const CIFR: u32 = 0x1C;
const CICR: u32 = 0x20;
const BDCR: u32 = 0x90;
const CSR: u32 = 0x94;
const CRRCR: u32 = 0x98;
/// CR.
const HSI_ON: u32 = 1 << 8;
const HSE_ON: u32 = 1 << 16;
const SECURITY_ON: u32 = 1 << 19;
const PLL_ON: u32 = 1 << 24;
const READY_FLAGS: u32 = 1 << 10 | 1 << 17 | 1 << 25;
/// CIFR and CICR.
const SECURITY: u32 = 1 << 8;
/// CFGR: the two codes of the switch, and of what it says.
const BY_HSI: u32 = 1;
const BY_HSE: u32 = 2;
const BY_PLL: u32 = 3;
const HSI_HZ: u64 = 16_000_000;
/// The crystal of docs/wiring.md.
const HSE_HZ: u64 = 24_000_000;
/// What a crystal and the loop take to be steady: the usual figures of data sheets.
const HSE_TICKS: u64 = 2 * TICK_HZ / 1_000;
const PLL_TICKS: u64 = 40 * TICK_HZ / 1_000_000;

/// Why the chip was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Power came: the supply was absent or too low.
    Power,
    /// The watchdog.
    Watchdog,
    /// The program.
    Software,
    /// Option bytes were loaded.
    OptionBytes,
}

impl Cause {
    /// Flags in RCC_CSR; the pin is pulled by every internal reset.
    pub(crate) fn flags(self) -> u32 {
        1 << 26
            | match self {
                Cause::Power => 1 << 27,
                Cause::Watchdog => 1 << 29,
                Cause::Software => 1 << 28,
                Cause::OptionBytes => 1 << 25,
            }
    }
}

/// Peripheral clock enables.
pub const AHB1ENR: u32 = 0x48;
/// See [`AHB1ENR`].
pub const AHB2ENR: u32 = 0x4C;
/// See [`AHB1ENR`].
pub const APB1ENR1: u32 = 0x58;
/// See [`AHB1ENR`].
pub const APB1ENR2: u32 = 0x5C;
/// See [`AHB1ENR`].
pub const APB2ENR: u32 = 0x60;
const RESET: &[(u32, u32)] = &[
    (CR, 0x0000_0500),
    (0x04, 0x4000_0000), // ICSCR
    (CFGR, 0x5),
    (PLLCFGR, 0x0000_1000),
    (0x18, 0), // CIER
    (CIFR, 0),
    (CICR, 0),
    (0x28, 0), // AHB1RSTR
    (0x2C, 0),
    (0x30, 0),
    (0x38, 0),
    (0x3C, 0),
    (0x40, 0),
    (AHB1ENR, 0x100),
    (AHB2ENR, 0),
    (0x50, 0),
    (APB1ENR1, 0x400),
    (APB1ENR2, 0),
    (APB2ENR, 0),
    (0x88, 0), // CCIPR
    (BDCR, 0),
    (CSR, 0),
    (CRRCR, 0),
    (0x9C, 0), // CCIPR2
];

/// Reset and clock control.
#[derive(Clone, Debug)]
pub struct Rcc {
    registers: Registers,
    /// When the crystal and the loop are steady.
    hse_at: u64,
    pll_at: u64,
    /// The crystal oscillates where it is switched on.
    crystal: bool,
}

impl Rcc {
    /// After power came.
    pub fn new() -> Self {
        let mut rcc = Rcc {
            registers: Registers::new("RCC", RESET),
            hse_at: 0,
            pll_at: 0,
            crystal: true,
        };
        rcc.registers.set(CSR, Cause::Power.flags());
        rcc
    }

    /// A reset for `cause`: flags of earlier ones stay until they are cleared, and so does the backup domain, unless power
    /// was away.
    pub fn reset(&mut self, cause: Cause) {
        let (flags, backup) = match cause {
            Cause::Power => (0, 0),
            _ => (self.flags(), self.registers.get(BDCR)),
        };
        self.registers.reset();
        self.registers.set(CSR, flags | cause.flags());
        self.registers.set(BDCR, backup);
    }

    fn flags(&self) -> u32 {
        self.registers.get(CSR) & 0xFE00_0000
    }

    /// Whether the enable bit of a peripheral is set.
    pub fn is_enabled(&self, (register, bit): (u32, u32)) -> bool {
        self.registers.get(register) >> bit & 1 == 1
    }

    /// Which reset lines of a register are held.
    pub fn held_in_reset(&self, register: u32) -> u32 {
        self.registers.get(register)
    }

    /// Whether the real-time clock runs, from the low-speed oscillator.
    pub fn drives_calendar(&self) -> bool {
        let bdcr = self.registers.get(BDCR);
        bdcr >> 15 & 1 == 1 && bdcr >> 8 & 3 == 2 && self.registers.get(CSR) & 1 == 1
    }

    /// Whether the backup domain is held in reset.
    pub fn resets_backup(&self) -> bool {
        self.registers.get(BDCR) >> 16 & 1 == 1
    }

    /// The crystal oscillates from now on, or stops. A stopped one that is watched is left by hardware: the internal
    /// oscillator runs the chip, the loop is off, and the non-maskable interrupt comes until it is cleared.
    pub fn set_crystal(&mut self, oscillates: bool, now: u64) {
        let was_ready = self.is_ready(HSE_ON, now);
        self.crystal = oscillates;
        self.hse_at = now + HSE_TICKS;
        let cr = self.registers.get(CR);
        if oscillates || !was_ready || cr & SECURITY_ON == 0 {
            return;
        }
        self.registers.set(CIFR, SECURITY);
        let used = self.switch() == BY_HSE || (self.switch() == BY_PLL && self.loop_on_crystal());
        let off = if used { HSE_ON | PLL_ON } else { HSE_ON };
        self.registers.set(CR, (cr | HSI_ON) & !off);
        if used {
            let cfgr = self.registers.get(CFGR);
            self.registers.set(CFGR, cfgr & !0xF | BY_HSI << 2 | BY_HSI);
        }
    }

    /// Whether the clock security system asserts the non-maskable interrupt.
    pub fn interrupt(&self) -> bool {
        self.registers.get(CIFR) & SECURITY != 0
    }

    fn switch(&self) -> u32 {
        self.registers.get(CFGR) & 3
    }

    fn loop_on_crystal(&self) -> bool {
        self.registers.get(PLLCFGR) & 3 == 3
    }

    fn is_ready(&self, switch: u32, now: u64) -> bool {
        let on = self.registers.get(CR) & switch != 0;
        let crystal = self.crystal && self.hse_at <= now;
        on && match switch {
            HSE_ON => crystal,
            PLL_ON => self.pll_at <= now && (!self.loop_on_crystal() || crystal),
            _ => true,
        }
    }

    /// Frequency of the bus and the core, Hz; `None` where the oscillator behind it has stopped.
    pub fn core_hz(&self, now: u64) -> Option<u64> {
        let source = match self.switch() {
            BY_PLL => self.is_ready(PLL_ON, now).then(|| self.loop_hz())?,
            BY_HSE => self.is_ready(HSE_ON, now).then_some(HSE_HZ)?,
            _ => HSI_HZ,
        };
        let divided = match self.registers.get(CFGR) >> 4 & 0xF {
            code @ 8..=11 => code - 7,
            code @ 12..=15 => code - 6,
            _ => 0,
        };
        Some(source >> divided)
    }

    fn loop_hz(&self) -> u64 {
        let word = u64::from(self.registers.get(PLLCFGR));
        let input = if self.loop_on_crystal() {
            HSE_HZ
        } else {
            HSI_HZ
        };
        let (divided, times) = ((word >> 4 & 0xF) + 1, word >> 8 & 0x7F);
        input / divided * times / (2 * ((word >> 25 & 3) + 1))
    }

    /// What a write to the backup domain's control changes: its reset clears everything, and a clock of the calendar that
    /// was chosen once stays until then.
    fn backup_control(&self, value: u32) -> u32 {
        const RESET: u32 = 1 << 16;
        const CALENDAR_CLOCK: u32 = 3 << 8;
        let chosen = self.registers.get(BDCR) & CALENDAR_CLOCK;
        match (value & RESET, chosen) {
            (0, 0) => value,
            (0, chosen) => value & !CALENDAR_CLOCK | chosen,
            _ => RESET,
        }
    }

    /// A bus read.
    pub fn read(&self, offset: u32, now: u64) -> Result<u32, Unmodelled> {
        let value = self.registers.read(offset)?;
        if offset != CR {
            return Ok(value);
        }
        let ready = |switch: u32, flag: u32| u32::from(self.is_ready(switch, now)) << flag;
        let flags = ready(HSI_ON, 10) | ready(HSE_ON, 17) | ready(PLL_ON, 25);
        Ok(value & !READY_FLAGS | flags)
    }

    /// A bus write at `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<(), Unmodelled> {
        let follow =
            |value: u32, on: u32, ready: u32| value & !(1 << ready) | (value >> on & 1) << ready;
        let value = match offset {
            CR => {
                let switched_on = value & !self.registers.get(CR);
                if switched_on & HSE_ON != 0 {
                    self.hse_at = now + HSE_TICKS;
                }
                if switched_on & PLL_ON != 0 {
                    self.pll_at = now + PLL_TICKS;
                }
                value
            }
            CFGR => {
                let ready = match value & 3 {
                    BY_PLL => self.is_ready(PLL_ON, now),
                    BY_HSE => self.is_ready(HSE_ON, now),
                    _ => true,
                };
                if !ready {
                    let access = format!("switch to a clock that is not ready ({value:#x})");
                    return Err(self.registers.unmodelled(access, offset));
                }
                value & !0xC | (value & 3) << 2
            }
            PLLCFGR if self.registers.get(CR) & PLL_ON != 0 => {
                let access = format!("write of {value:#x} while the loop is on");
                return Err(self.registers.unmodelled(access, offset));
            }
            CIFR => self.registers.get(CIFR),
            CICR => {
                let left = self.registers.get(CIFR) & !value;
                self.registers.set(CIFR, left);
                0
            }
            BDCR => follow(self.backup_control(value), 0, 1),
            CRRCR => follow(value, 0, 1),
            CSR => {
                let kept = if value >> 23 & 1 == 1 {
                    0
                } else {
                    self.flags()
                };
                follow(value, 0, 1) & 0x3 | kept
            }
            _ => value,
        };
        self.registers.write(offset, value)
    }
}
