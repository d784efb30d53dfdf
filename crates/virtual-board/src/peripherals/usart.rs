//! Serial ports with their FIFOs, byte by byte in time: USART and LPUART, interrupts, DMA requests, driver enable, noise.

use std::collections::VecDeque;

use crate::peripherals::registers::{Registers, Unmodelled};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const CR3: u32 = 0x08;
const BRR: u32 = 0x0C;
const ISR: u32 = 0x1C;
const ICR: u32 = 0x20;
const RDR: u32 = 0x24;
const TDR: u32 = 0x28;
const PRESC: u32 = 0x2C;
const RESET: &[(u32, u32)] = &[
    (CR1, 0),
    (CR2, 0),
    (CR3, 0),
    (BRR, 0),
    (0x14, 0), // RTOR
    (0x18, 0), // RQR
    (PRESC, 0),
];
/// CR1.
const ENABLE: u32 = 1;
const RECEIVE: u32 = 1 << 2;
const TRANSMIT: u32 = 1 << 3;
const PARITY: u32 = 1 << 10;
const NINE_BITS: u32 = 1 << 12;
const FIFO: u32 = 1 << 29;
/// CR3.
const DMA_TRANSMIT: u32 = 1 << 7;
const DRIVER_ENABLE: u32 = 1 << 14;
/// ISR, and the enables of CR1 at the same places.
const PARITY_ERROR: u32 = 1;
const FRAMING_ERROR: u32 = 1 << 1;
const NOISE: u32 = 1 << 2;
const OVERRUN: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const NOT_EMPTY: u32 = 1 << 5;
const COMPLETE: u32 = 1 << 6;
const NOT_FULL: u32 = 1 << 7;
const ACKNOWLEDGED: u32 = 1 << 21 | 1 << 22;
/// Bytes of each FIFO.
const DEPTH: usize = 8;
const PRESCALERS: [u64; 12] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];

/// A byte that the program sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent {
    /// The byte.
    pub byte: u8,
    /// Cycle at which its stop bit ended.
    pub at: u64,
    /// The driver-enable pin was the port's and active.
    pub driven: bool,
    /// The other end of the wire had the same speed.
    pub understood: bool,
}

/// How a byte arrives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Undisturbed.
    #[default]
    Good,
    /// Disturbed: the port sees a parity, framing and noise error.
    Bad,
}

/// One port.
#[derive(Clone, Debug)]
pub struct Usart {
    registers: Registers,
    /// Bits of a unit of BRR: an LPUART counts in 256ths.
    divider: u64,
    /// Units of time per cycle of its clock.
    pub clock: u64,
    status: u32,
    waiting: VecDeque<u8>,
    /// Byte on the wire, and the cycle at which it ends.
    shifting: Option<(u8, u64)>,
    received: VecDeque<u8>,
    /// What is on its way here, and the cycle at which each byte has arrived.
    incoming: VecDeque<(u64, u8, Quality)>,
    idle_at: Option<u64>,
    /// Units of time of a bit of the other end of the wire; `None` follows the port's own.
    pub peer_bit: Option<u64>,
    /// Everything that was sent.
    pub sent: Vec<Sent>,
}

impl Usart {
    /// After reset; `low_power` is an LPUART.
    pub fn new(low_power: bool) -> Self {
        Usart {
            registers: Registers::new("USART", RESET),
            divider: if low_power { 256 } else { 1 },
            clock: 1,
            status: COMPLETE | NOT_FULL,
            waiting: VecDeque::new(),
            shifting: None,
            received: VecDeque::new(),
            incoming: VecDeque::new(),
            idle_at: None,
            peer_bit: None,
            sent: Vec::new(),
        }
    }

    /// A reset of the chip: the wire and what came over it stay.
    pub fn reset(&mut self) {
        *self = Usart {
            incoming: std::mem::take(&mut self.incoming),
            sent: std::mem::take(&mut self.sent),
            clock: self.clock,
            peer_bit: self.peer_bit,
            ..Usart::new(self.divider != 1)
        };
    }

    fn has(&self, register: u32, bits: u32) -> bool {
        self.registers.get(register) & bits == bits
    }

    /// Units of time of a bit.
    fn bit(&self) -> u64 {
        let prescaler = PRESCALERS[(self.registers.get(PRESC) & 0xF).min(11) as usize];
        let bit = u64::from(self.registers.get(BRR)) * prescaler;
        bit * self.clock / self.divider
    }

    fn bits_of_a_character(&self) -> u64 {
        let data = if self.has(CR1, NINE_BITS) { 9 } else { 8 };
        data + 2
    }

    /// Units of time of one character with start and stop bit.
    fn character(&self) -> u64 {
        (self.bits_of_a_character() * self.bit()).max(1)
    }

    /// Whether the other end of the wire understands the port's speed: within 4 % the last bit of a character is still read within
    /// itself.
    fn agrees(&self) -> bool {
        let own = self.bit();
        self.peer_bit
            .is_none_or(|peer| 25 * own.abs_diff(peer) <= own)
    }

    /// Puts bytes on the wire towards the chip, one behind the other from `now` on. At another speed than the port's they arrive
    /// as rubbish.
    pub fn deliver(&mut self, now: u64, bytes: &[(u8, Quality)]) {
        let last = self.incoming.back().map_or(now, |(at, ..)| (*at).max(now));
        let bit = self.peer_bit.unwrap_or(self.bit());
        let character = (self.bits_of_a_character() * bit).max(1);
        let agrees = self.agrees();
        for (k, (byte, quality)) in (1..).zip(bytes) {
            let at = last + k * character;
            let (byte, quality) = match agrees {
                true => (*byte, *quality),
                false => (byte.rotate_left(3) ^ 0x5A, Quality::Bad),
            };
            self.incoming.push_back((at, byte, quality));
        }
    }

    /// Cycle of the next thing that happens without the program.
    pub fn next_event(&self) -> Option<u64> {
        let shifted = self.shifting.map(|(_, at)| at);
        let arrived = self.incoming.front().map(|(at, ..)| *at);
        [shifted, arrived, self.idle_at].into_iter().flatten().min()
    }

    /// Lets everything happen up to `now`.
    pub fn advance(&mut self, now: u64) {
        while let Some((byte, at)) = self.shifting.filter(|(_, at)| *at <= now) {
            let driven = self.has(CR3, DRIVER_ENABLE);
            let understood = self.agrees();
            self.sent.push(Sent {
                byte,
                at,
                driven,
                understood,
            });
            self.shifting = None;
            self.shift(at);
            if self.shifting.is_none() {
                self.status |= COMPLETE;
            }
        }
        while let Some((at, byte, quality)) = self.incoming.front().copied() {
            if at > now {
                break;
            }
            self.incoming.pop_front();
            self.receive(at, byte, quality);
        }
        if self.idle_at.is_some_and(|at| at <= now) {
            self.idle_at = None;
            self.status |= IDLE;
        }
    }

    /// The next waiting byte begins.
    fn shift(&mut self, now: u64) {
        if self.shifting.is_none()
            && self.has(CR1, ENABLE | TRANSMIT)
            && let Some(byte) = self.waiting.pop_front()
        {
            self.status &= !COMPLETE;
            self.shifting = Some((byte, now + self.character()));
        }
    }

    fn receive(&mut self, at: u64, byte: u8, quality: Quality) {
        if !self.has(CR1, ENABLE | RECEIVE) {
            return;
        }
        self.idle_at = Some(at + self.character());
        if quality == Quality::Bad {
            self.status |= PARITY_ERROR | FRAMING_ERROR | NOISE;
        }
        let room = if self.has(CR1, FIFO) { DEPTH } else { 1 };
        if self.received.len() < room {
            self.received.push_back(byte);
        } else {
            self.status |= OVERRUN;
        }
    }

    fn flags(&self) -> u32 {
        let not_empty = if self.received.is_empty() {
            0
        } else {
            NOT_EMPTY
        };
        let not_full = if self.waiting.len() < DEPTH {
            NOT_FULL
        } else {
            0
        };
        self.status & !(NOT_EMPTY | NOT_FULL) | not_empty | not_full | ACKNOWLEDGED
    }

    /// Whether the interrupt line is asserted.
    pub fn interrupt(&self) -> bool {
        let enabled = self.registers.get(CR1);
        let plain = self.flags() & enabled & (IDLE | NOT_EMPTY | COMPLETE | NOT_FULL);
        // An overrun comes with the enable of reception, a parity error with bit 8, the others with bit 0 of CR3.
        let overrun = self.status & OVERRUN != 0 && enabled & NOT_EMPTY != 0;
        let parity = self.status & PARITY_ERROR != 0 && enabled >> 8 & 1 == 1;
        let line = self.status & (FRAMING_ERROR | NOISE) != 0 && self.has(CR3, 1);
        self.has(CR1, ENABLE) && (plain != 0 || overrun || parity || line)
    }

    /// Whether DMA is to bring a byte to send.
    pub fn wants_byte(&self) -> bool {
        self.has(CR1, ENABLE | TRANSMIT)
            && self.has(CR3, DMA_TRANSMIT)
            && self.waiting.len() < DEPTH
    }

    /// A bus read.
    pub fn read(&mut self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            ISR => Ok(self.flags()),
            RDR => {
                let byte = u32::from(self.received.pop_front().unwrap_or(0));
                // Even parity is the ninth bit that the program finds above the byte.
                let parity = if self.has(CR1, PARITY | NINE_BITS) {
                    byte.count_ones() & 1
                } else {
                    0
                };
                Ok(parity << 8 | byte)
            }
            _ => self.registers.read(offset),
        }
    }

    /// A bus write at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<(), Unmodelled> {
        match offset {
            ICR => {
                self.status &=
                    !(value & (PARITY_ERROR | FRAMING_ERROR | NOISE | OVERRUN | IDLE | COMPLETE))
            }
            TDR if self.waiting.len() < DEPTH => {
                self.waiting.push_back(value as u8);
                self.shift(now);
            }
            TDR => {
                return Err(self
                    .registers
                    .unmodelled("write of a byte too many".into(), offset));
            }
            BRR | CR2 if self.has(CR1, ENABLE) => {
                let access = format!("write of {value:#x} while enabled");
                return Err(self.registers.unmodelled(access, offset));
            }
            _ => {
                self.registers.write(offset, value)?;
                self.shift(now);
            }
        }
        Ok(())
    }
}
