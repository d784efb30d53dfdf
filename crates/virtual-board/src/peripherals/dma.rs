//! DMA1 and its request multiplexer: half-words from peripherals to memory in circles, bytes from memory to peripherals,
//! half and complete flags.

use crate::peripherals::registers::{Registers, Unmodelled};

const CHANNELS: usize = 8;
const ENABLE: u32 = 1;
const COMPLETE_IE: u32 = 2;
const HALF_IE: u32 = 4;
const ERROR_IE: u32 = 8;
const CIRCULAR: u32 = 1 << 5;
const TO_PERIPHERAL: u32 = 1 << 4;
/// Memory increments. Peripheral to memory: 16 bits on both sides, in a circle. The other way: 8 bits, once. Enable,
/// interrupts and priority are free.
const SUPPORTED: [u32; 2] = [CIRCULAR | 1 << 7 | 1 << 8 | 1 << 10, TO_PERIPHERAL | 1 << 7];
const FREE: u32 = ENABLE | COMPLETE_IE | HALF_IE | ERROR_IE | 3 << 12;

#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    control: u32,
    remaining: u32,
    reload: u32,
    peripheral: u32,
    memory: u32,
}

/// The controller.
#[derive(Clone, Debug)]
pub struct Dma {
    channels: [Channel; CHANNELS],
    /// Four flags per channel: global, complete, half, error.
    flags: u32,
    multiplexer: Registers,
}

/// One transfer to be carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transfer {
    /// Where to read.
    pub peripheral: u32,
    /// Where to write.
    pub memory: u32,
}

const MULTIPLEXER: &[(u32, u32)] = &[
    (0x00, 0),
    (0x04, 0),
    (0x08, 0),
    (0x0C, 0),
    (0x10, 0),
    (0x14, 0),
    (0x18, 0),
    (0x1C, 0),
];

impl Dma {
    /// After reset.
    pub fn new() -> Self {
        Dma {
            channels: [Channel::default(); CHANNELS],
            flags: 0,
            multiplexer: Registers::new("DMAMUX", MULTIPLEXER),
        }
    }

    /// Serves a request line of the multiplexer; `None` when no enabled channel listens.
    pub fn request(&mut self, line: u32) -> Result<Option<Transfer>, Unmodelled> {
        let listens = |k: &usize| self.multiplexer.get(4 * *k as u32) & 0x7F == line;
        let Some(index) = (0..CHANNELS).find(listens) else {
            return Ok(None);
        };
        let channel = &mut self.channels[index];
        if channel.control & ENABLE == 0 || channel.remaining == 0 {
            return Ok(None);
        }
        if !SUPPORTED.contains(&(channel.control & !FREE)) {
            let access = format!("transfer with CCR {:#x}", channel.control);
            return Err(unmodelled(access, index as u32));
        }
        let done = channel.reload - channel.remaining;
        channel.remaining -= 1;
        let transfer = Transfer {
            peripheral: channel.peripheral,
            memory: channel.memory
                + done
                    * if channel.control & TO_PERIPHERAL == 0 {
                        2
                    } else {
                        1
                    },
        };
        if channel.remaining == channel.reload / 2 {
            self.flags |= 0b0101 << (4 * index);
        }
        if channel.remaining == 0 {
            if channel.control & CIRCULAR != 0 {
                channel.remaining = channel.reload;
            }
            self.flags |= 0b0011 << (4 * index);
        }
        Ok(Some(transfer))
    }

    /// Requests of a line until a flag of its channel is raised; `None` where no enabled channel listens.
    pub fn until_flag(&self, line: u32) -> Option<u32> {
        let listens = |k: &usize| self.multiplexer.get(4 * *k as u32) & 0x7F == line;
        let channel = &self.channels[(0..CHANNELS).find(listens)?];
        let left = channel.remaining;
        let half = left
            .checked_sub(channel.reload / 2)
            .filter(|left| *left > 0);
        (channel.control & ENABLE != 0 && left > 0).then(|| half.unwrap_or(left))
    }

    /// Whether an enabled channel with something left listens to a request line.
    pub fn listens(&self, line: u32) -> bool {
        (0..CHANNELS).any(|k| {
            let channel = &self.channels[k];
            self.multiplexer.get(4 * k as u32) & 0x7F == line
                && channel.control & ENABLE != 0
                && channel.remaining > 0
        })
    }

    /// Whether the interrupt line of channel `index` is asserted.
    pub fn interrupt(&self, index: usize) -> bool {
        // CCR's enables and the flags have the same order from bit 1 on.
        self.flags >> (4 * index) & self.channels[index].control & 0b1110 != 0
    }

    /// A bus read.
    pub fn read(&self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            0 => Ok(self.flags),
            0x08..0xA8 => {
                let channel = &self.channels[(offset as usize - 8) / 20];
                match (offset - 8) % 20 {
                    0 => Ok(channel.control),
                    4 => Ok(channel.remaining),
                    8 => Ok(channel.peripheral),
                    12 => Ok(channel.memory),
                    _ => Err(unmodelled("read".into(), offset)),
                }
            }
            _ => Err(unmodelled("read".into(), offset)),
        }
    }

    /// A bus write. Address and count are ignored by an enabled channel on silicon: an error here.
    pub fn write(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        if offset == 4 {
            self.clear(value);
            return Ok(());
        }
        if !(0x08..0xA8).contains(&offset) {
            return Err(unmodelled(format!("write of {value:#x}"), offset));
        }
        let channel = &mut self.channels[(offset as usize - 8) / 20];
        let enabled = channel.control & ENABLE != 0;
        match (offset - 8) % 20 {
            0 => channel.control = value,
            4 if !enabled => (channel.remaining, channel.reload) = (value, value),
            8 if !enabled => channel.peripheral = value,
            12 if !enabled => channel.memory = value,
            _ => return Err(unmodelled(format!("write of {value:#x}"), offset)),
        }
        Ok(())
    }

    /// Clearing the global flag clears all four.
    fn clear(&mut self, bits: u32) {
        for index in 0..CHANNELS {
            let group = bits >> (4 * index) & 0xF;
            let cleared = if group & 1 == 1 { 0xF } else { group };
            self.flags &= !(cleared << (4 * index));
            if self.flags >> (4 * index) & 0xE == 0 {
                self.flags &= !(1 << (4 * index));
            }
        }
    }

    /// A read of the multiplexer.
    pub fn read_multiplexer(&self, offset: u32) -> Result<u32, Unmodelled> {
        self.multiplexer.read(offset)
    }

    /// A write of the multiplexer.
    pub fn write_multiplexer(&mut self, offset: u32, value: u32) -> Result<(), Unmodelled> {
        self.multiplexer.write(offset, value)
    }
}

fn unmodelled(access: String, offset: u32) -> Unmodelled {
    Unmodelled {
        block: "DMA1",
        access,
        offset,
    }
}
