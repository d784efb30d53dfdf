//! The address map: which peripheral answers where, and that its clock runs.

use crate::machine::{Machine, TS_CAL_30, TS_CAL_130, VREFINT_CAL};
use crate::peripherals::rcc::{AHB1ENR, AHB2ENR, APB1ENR1, APB1ENR2, APB2ENR};
use crate::peripherals::registers::Unmodelled;

#[derive(Clone, Copy, Debug)]
enum Block {
    Tim3,
    Tim4,
    Tim15,
    Usart1,
    Lpuart1,
    Pwr,
    Iwdg,
    Tamp,
    Rtc,
    Syscfg,
    Exti,
    Dma1,
    Dmamux,
    Rcc,
    Flash,
    Gpio(usize),
    Adc1,
    Adc5,
    AdcCommon(usize),
    Dbgmcu,
    System,
}

/// Register and bit in RCC that let a block answer.
type Enable = (u32, u32);

/// Block, first address, size, and the clock enable that it needs.
const MAP: &[(Block, u32, u32, Option<Enable>)] = &[
    (Block::Tim3, 0x4000_0400, 0x400, Some((APB1ENR1, 1))),
    (Block::Tim4, 0x4000_0800, 0x400, Some((APB1ENR1, 2))),
    (Block::Tamp, 0x4000_2400, 0x400, Some((APB1ENR1, 10))),
    (Block::Rtc, 0x4000_2800, 0x400, Some((APB1ENR1, 10))),
    (Block::Iwdg, 0x4000_3000, 0x400, None),
    (Block::Pwr, 0x4000_7000, 0x400, Some((APB1ENR1, 28))),
    (Block::Lpuart1, 0x4000_8000, 0x400, Some((APB1ENR2, 0))),
    (Block::Syscfg, 0x4001_0000, 0x30, Some((APB2ENR, 0))),
    (Block::Exti, 0x4001_0400, 0x400, None),
    (Block::Usart1, 0x4001_3800, 0x400, Some((APB2ENR, 14))),
    (Block::Tim15, 0x4001_4000, 0x400, Some((APB2ENR, 16))),
    (Block::Dma1, 0x4002_0000, 0x400, Some((AHB1ENR, 0))),
    (Block::Dmamux, 0x4002_0800, 0x400, Some((AHB1ENR, 2))),
    (Block::Rcc, 0x4002_1000, 0x400, None),
    (Block::Flash, 0x4002_2000, 0x400, None),
    (Block::Gpio(0), 0x4800_0000, 0x400, Some((AHB2ENR, 0))),
    (Block::Gpio(1), 0x4800_0400, 0x400, Some((AHB2ENR, 1))),
    (Block::Gpio(2), 0x4800_0800, 0x400, Some((AHB2ENR, 2))),
    (Block::Gpio(3), 0x4800_0C00, 0x400, Some((AHB2ENR, 3))),
    (Block::Gpio(4), 0x4800_1000, 0x400, Some((AHB2ENR, 4))),
    (Block::Gpio(5), 0x4800_1400, 0x400, Some((AHB2ENR, 5))),
    (Block::Gpio(6), 0x4800_1800, 0x400, Some((AHB2ENR, 6))),
    (Block::Adc1, 0x5000_0000, 0x100, Some((AHB2ENR, 13))),
    (Block::AdcCommon(0), 0x5000_0300, 0x100, Some((AHB2ENR, 13))),
    (Block::Adc5, 0x5000_0600, 0x100, Some((AHB2ENR, 14))),
    (Block::AdcCommon(1), 0x5000_0700, 0x100, Some((AHB2ENR, 14))),
    (Block::System, 0xE000_E000, 0x1000, None),
    (Block::Dbgmcu, 0xE004_2000, 0x400, None),
];

/// Factory constants live in a page of read-only memory.
pub(crate) const FACTORY_VALUES: [(u32, u16); 9] = [
    // The serial number, lowest word first.
    (0x1FFF_7590, 0x0007),
    (0x1FFF_7592, 0x0042),
    (0x1FFF_7594, 0x5101),
    (0x1FFF_7596, 0x3033),
    (0x1FFF_7598, 0x3936),
    (0x1FFF_759A, 0x2036),
    (0x1FFF_75AA, VREFINT_CAL),
    (0x1FFF_75A8, TS_CAL_30),
    (0x1FFF_75CA, TS_CAL_130),
];

impl Machine {
    fn locate(&self, address: u32) -> Result<(Block, u32), Unmodelled> {
        let missing = |access: &str| Unmodelled {
            block: "the chip",
            access: access.into(),
            offset: address,
        };
        let found = MAP
            .iter()
            .find(|(_, first, size, _)| (*first..first + size).contains(&address));
        let &(block, first, _, clock) = found.ok_or_else(|| missing("anything"))?;
        match clock {
            Some(enable) if !self.rcc.is_enabled(enable) => {
                Err(missing("access without its clock"))
            }
            _ => Ok((block, address - first)),
        }
    }

    /// A read of the word, half-word or byte at `address`.
    pub fn read(&mut self, address: u32) -> Result<u32, Unmodelled> {
        self.make_up_for(address)?;
        self.read_as_it_is(address)
    }

    /// Acquisition is made up for before anybody touches what belongs to it.
    fn make_up_for(&mut self, address: u32) -> Result<(), Unmodelled> {
        match self.locate(address) {
            Ok((
                Block::Pwr
                | Block::Flash
                | Block::AdcCommon(_)
                | Block::Tim3
                | Block::Tim4
                | Block::Adc1
                | Block::Dma1
                | Block::Dmamux
                | Block::Rcc,
                _,
            )) => self.catch_up(),
            _ => Ok(()),
        }
    }

    /// A read that finds everything as it was left.
    pub(super) fn read_as_it_is(&mut self, address: u32) -> Result<u32, Unmodelled> {
        let now = self.now;
        let (block, offset) = self.locate(address)?;
        match block {
            Block::Tim3 => self.tim3.read(offset, now),
            Block::Tim4 => self.tim4.read(offset, now),
            Block::Tim15 => self.tim15.read(offset, now),
            Block::Usart1 => self.usart1.read(offset),
            Block::Lpuart1 => self.lpuart1.read(offset),
            Block::Pwr => Ok(self.pwr.read(offset)? | self.power_flags(offset)),
            Block::Tamp => self.backup.read(offset),
            Block::Rtc => self.backup.read_calendar(offset, now, self.lsi_hz),
            Block::Iwdg => self.iwdg.read(offset),
            Block::Syscfg => {
                let parity = u32::from(offset == 0x1C && self.parity_failed) << 8;
                Ok(self.syscfg.read(offset)? | parity)
            }
            Block::Exti => self.exti.read(offset),
            Block::Dma1 => self.dma.read(offset),
            Block::Dmamux => self.dma.read_multiplexer(offset),
            Block::Rcc => self.rcc.read(offset, now),
            Block::Flash => self.flash.read(offset, now),
            Block::Gpio(port) => {
                self.apply_contact();
                self.ports[port].read(offset)
            }
            Block::Adc1 => self.adc1.read(offset),
            Block::Adc5 => self.adc5.read(offset),
            Block::AdcCommon(k) => self.common[k].read(offset),
            Block::Dbgmcu => self.dbgmcu.read(offset),
            Block::System => self.nvic.read(offset),
        }
    }

    /// A write. Returns the offset of a flash page to be erased.
    pub fn write(&mut self, address: u32, value: u32) -> Result<Option<u32>, Unmodelled> {
        self.make_up_for(address)?;
        let now = self.now;
        let (block, offset) = self.locate(address)?;
        match block {
            Block::Tim3 => self.tim3.write(offset, value, now)?,
            Block::Tim4 => self.tim4.write(offset, value, now)?,
            Block::Tim15 => self.tim15.write(offset, value, now)?,
            Block::Usart1 => self.usart1.write(offset, value, now)?,
            Block::Lpuart1 => self.lpuart1.write(offset, value, now)?,
            Block::Pwr => {
                self.pwr.write(offset, value)?;
                self.follow_clocks()?;
            }
            Block::Iwdg => self.iwdg.write(offset, value, now, self.lsi_hz)?,
            Block::Tamp => {
                let protected = self.pwr.get(0) >> 8 & 1 == 0;
                self.backup.write(offset, value, protected)?;
            }
            Block::Rtc => {
                return Err(Unmodelled {
                    block: "RTC",
                    access: format!("write of {value:#x}"),
                    offset,
                });
            }
            Block::Syscfg => {
                if offset == 0x1C && value >> 8 & 1 == 1 {
                    self.parity_failed = false;
                }
                self.syscfg.write(offset, value & !(1 << 8))?;
            }
            Block::Exti => self.exti.write(offset, value)?,
            Block::Dma1 => self.dma.write(offset, value)?,
            Block::Dmamux => self.dma.write_multiplexer(offset, value)?,
            Block::Rcc => {
                self.rcc.write(offset, value, now)?;
                self.hold_in_reset(offset);
                self.follow_backup();
                self.follow_clocks()?;
            }
            Block::Flash => {
                let erased = self.flash.write(offset, value, now)?;
                self.follow_clocks()?;
                return Ok(erased);
            }
            Block::Gpio(port) => {
                self.ports[port].write(offset, value)?;
                self.follow_relay();
            }
            Block::Adc1 => {
                if self.adc1.write(offset, value, now)? {
                    self.begin_sample();
                }
            }
            Block::Adc5 => {
                self.adc5.write(offset, value, now)?;
            }
            Block::AdcCommon(k) => {
                self.common[k].write(offset, value)?;
                self.follow_clocks()?;
            }
            Block::Dbgmcu => self.dbgmcu.write(offset, value)?,
            Block::System => self.nvic.write(offset, value)?,
        }
        self.update_lines();
        Ok(None)
    }

    /// Reset lines in RCC that this board uses.
    fn hold_in_reset(&mut self, register: u32) {
        let held = self.rcc.held_in_reset(register);
        let is_held = |bit: u32| held >> bit & 1 == 1;
        match register {
            0x2C => {
                if is_held(13) {
                    self.adc1.reset();
                    self.common[0].reset();
                }
                if is_held(14) {
                    self.adc5.reset();
                    self.common[1].reset();
                }
            }
            0x38 => {
                if is_held(1) {
                    self.tim3.reset();
                }
                if is_held(2) {
                    self.tim4.reset();
                }
            }
            0x3C if is_held(0) => self.lpuart1.reset(),
            0x40 => {
                if is_held(14) {
                    self.usart1.reset();
                }
                if is_held(16) {
                    self.tim15.reset();
                }
            }
            _ => {}
        }
    }
}
