//! Converters: calibration, software and timer start, sequences, DMA requests, overrun, analogue watchdog, and the wrong first
//! result after a pause.

use std::collections::VecDeque;

use crate::TICK_HZ;
use crate::peripherals::registers::{Registers, Unmodelled};

const ISR: u32 = 0x00;
const CR: u32 = 0x08;
const CFGR: u32 = 0x0C;
const SMPR1: u32 = 0x14;
const SMPR2: u32 = 0x18;
const TR1: u32 = 0x20;
const SQR1: u32 = 0x30;
const DR: u32 = 0x40;
const RESET: &[(u32, u32)] = &[
    (0x04, 0), // IER
    (CR, 0x2000_0000),
    (CFGR, 0x8000_0000),
    (0x10, 0), // CFGR2
    (SMPR1, 0),
    (SMPR2, 0),
    (TR1, 0x0FFF_0000),
    (SQR1, 0),
    (0x34, 0),
    (0x38, 0),
    (0x3C, 0),
    (0xB0, 0), // DIFSEL
];
/// CR.
const ENABLE: u32 = 1;
const START: u32 = 1 << 2;
const STOP: u32 = 1 << 4;
const REGULATOR: u32 = 1 << 28;
const CALIBRATE: u32 = 1 << 31;
/// ISR.
const READY: u32 = 1;
const END_OF_CONVERSION: u32 = 1 << 2;
const END_OF_SEQUENCE: u32 = 1 << 3;
const OVERRUN: u32 = 1 << 4;
const WATCHDOG: u32 = 1 << 7;
/// CFGR: analogue watchdog 1 looks, at one channel alone.
const WATCHDOG_ENABLE: u32 = 1 << 23;
const WATCHDOG_SINGLE: u32 = 1 << 22;
/// A pause after which the first result is wrong (erratum of the family).
const IDLE: u64 = TICK_HZ / 1_000;
/// Doubled sampling times in converter clocks, by the code in SMPR.
const SAMPLE_CLOCKS_X2: [u64; 8] = [5, 13, 25, 49, 95, 185, 495, 1281];
/// Doubled: 12.5 clocks for 12 bits.
const CONVERSION_CLOCKS_X2: u64 = 25;
/// EXTSEL of TIM4's trigger output for ADC1 and ADC2 (RM0440, table of regular triggers).
const EXTSEL_TIM4_TRGO: u32 = 12;

/// One converter.
#[derive(Clone, Debug)]
pub struct Adc {
    registers: Registers,
    status: u32,
    data: u16,
    /// Channels still to convert, and the cycle at which the first of them is done.
    queue: VecDeque<u32>,
    done_at: u64,
    /// The clock has failed: nothing ever ends.
    pub clock_stopped: bool,
    /// Units of time per cycle of its clock.
    pub clock: u64,
    /// End of the last conversion since the calibration.
    last_end: Option<u64>,
    /// The conversion under way began after a pause.
    is_wrong: bool,
}

/// A conversion that has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ended {
    pub channel: u32,
    pub code: u16,
    pub ends_sequence: bool,
    pub asks_dma: bool,
}

impl Adc {
    /// After reset.
    pub fn new() -> Self {
        Adc {
            registers: Registers::new("ADC", RESET),
            status: 0,
            data: 0,
            queue: VecDeque::new(),
            done_at: 0,
            clock_stopped: false,
            clock: 1,
            last_end: None,
            is_wrong: false,
        }
    }

    /// A reset through RCC; the fault stays.
    pub fn reset(&mut self) {
        *self = Adc {
            clock_stopped: self.clock_stopped,
            clock: self.clock,
            ..Adc::new()
        };
    }

    fn control(&self) -> u32 {
        self.registers.get(CR)
    }

    fn is_started(&self) -> bool {
        self.control() & START != 0
    }

    fn uses_dma(&self) -> bool {
        self.registers.get(CFGR) & 1 == 1
    }

    fn conversion_cycles(&self, channel: u32) -> u64 {
        let (register, place) = if channel < 10 {
            (SMPR1, channel)
        } else {
            (SMPR2, channel - 10)
        };
        let code = self.registers.get(register) >> (3 * place) & 7;
        (SAMPLE_CLOCKS_X2[code as usize] + CONVERSION_CLOCKS_X2) * self.clock / 2
    }

    fn sequence(&self) -> impl Iterator<Item = u32> + use<> {
        let [s1, s2, s3, s4] = [0x30, 0x34, 0x38, 0x3C].map(|offset| self.registers.get(offset));
        let length = (s1 & 0xF) as usize + 1;
        let first = (1..5).map(move |k| s1 >> (6 * k) & 0x1F);
        let rest = [s2, s3, s4]
            .into_iter()
            .flat_map(|s| (0..5).map(move |k| s >> (6 * k) & 0x1F));
        first.chain(rest).take(length)
    }

    /// Conversions of a sequence.
    pub fn length(&self) -> u32 {
        (self.registers.get(SQR1) & 0xF) + 1
    }

    fn begin(&mut self, now: u64) {
        let sequence = self.sequence();
        self.queue.clear();
        self.queue.extend(sequence);
        self.is_wrong = self.last_end.is_none_or(|end| now - end > IDLE);
        self.schedule(now);
    }

    fn schedule(&mut self, now: u64) {
        if let Some(&channel) = self.queue.front() {
            self.done_at = now + self.conversion_cycles(channel);
        }
    }

    /// TIM4's trigger output rose. Returns whether a sequence began.
    pub fn trigger(&mut self, now: u64) -> bool {
        let cfgr = self.registers.get(CFGR);
        let selected = cfgr >> 5 & 0x1F == EXTSEL_TIM4_TRGO && cfgr >> 10 & 3 == 1;
        let ready = self.is_started() && self.queue.is_empty() && !self.clock_stopped;
        if selected && ready {
            self.begin(now);
        }
        selected && ready
    }

    /// Cycle at which the next conversion ends.
    pub fn next_event(&self) -> Option<u64> {
        (!self.queue.is_empty() && !self.clock_stopped).then_some(self.done_at)
    }

    /// Ends the conversion that is due; `level` gives the code of a channel sampled at a time.
    pub fn advance(&mut self, now: u64, level: impl FnOnce(u32, u64) -> u16) -> Option<Ended> {
        if self.next_event().is_none_or(|at| at > now) {
            return None;
        }
        let channel = self.queue.pop_front()?;
        let sampled = now.saturating_sub(CONVERSION_CLOCKS_X2 * self.clock / 2);
        // Wrong by half: what silicon shows is not known, and it must not matter.
        let code = level(channel, sampled) >> u16::from(std::mem::take(&mut self.is_wrong));
        if self.status & END_OF_CONVERSION != 0 && self.uses_dma() {
            // The previous result was never fetched: it stays, and DMA is refused until OVR is cleared.
            self.status |= OVERRUN;
        } else {
            self.data = code;
        }
        self.status |= END_OF_CONVERSION;
        self.last_end = Some(now);
        self.watch(channel, code);
        self.schedule(now);
        let ends_sequence = self.queue.is_empty();
        if ends_sequence {
            self.end_sequence();
        }
        Some(Ended {
            channel,
            code,
            ends_sequence,
            asks_dma: self.uses_dma() && self.status & OVERRUN == 0,
        })
    }

    /// The analogue watchdog: a result beyond its limits raises its flag (12 bits, no filter).
    fn watch(&mut self, channel: u32, code: u16) {
        let (cfgr, limits) = (self.registers.get(CFGR), self.registers.get(TR1));
        let is_watched = cfgr & WATCHDOG_ENABLE != 0
            && (cfgr & WATCHDOG_SINGLE == 0 || cfgr >> 26 & 0x1F == channel);
        let sound = limits & 0xFFF..=limits >> 16 & 0xFFF;
        if is_watched && !sound.contains(&u32::from(code)) {
            self.status |= WATCHDOG;
        }
    }

    fn end_sequence(&mut self) {
        self.status |= END_OF_SEQUENCE;
        let by_software = self.registers.get(CFGR) >> 10 & 3 == 0;
        if by_software {
            self.registers.set(CR, self.control() & !START);
        }
    }

    /// DMA or the program fetches the result.
    pub fn fetch(&mut self) -> u16 {
        self.status &= !END_OF_CONVERSION;
        self.data
    }

    /// A bus read.
    pub fn read(&mut self, offset: u32) -> Result<u32, Unmodelled> {
        match offset {
            ISR => Ok(self.status),
            DR => Ok(u32::from(self.fetch())),
            _ => self.registers.read(offset),
        }
    }

    /// A bus write; whether it starts conversions. What decides about them must not change while they run.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<bool, Unmodelled> {
        match offset {
            ISR => self.status &= !value,
            CR => return Ok(self.command(value, now)),
            CFGR | TR1 | SQR1 | 0x34 | 0x38 | 0x3C if self.is_locked(offset, value) => {
                return Err(Unmodelled {
                    block: "ADC",
                    access: format!("write of {value:#x} while conversions run"),
                    offset,
                });
            }
            _ => self.registers.write(offset, value)?,
        }
        Ok(false)
    }

    fn is_locked(&self, offset: u32, value: u32) -> bool {
        self.is_started() && self.registers.get(offset) != value
    }

    fn command(&mut self, value: u32, now: u64) -> bool {
        let powered = value & REGULATOR != 0 && value >> 29 & 1 == 0;
        let mut next = value;
        if value & CALIBRATE != 0 && !self.clock_stopped {
            next &= !CALIBRATE;
            self.last_end = None;
        }
        if value & ENABLE != 0 && powered {
            self.status |= READY;
        }
        if value & STOP != 0 && !self.clock_stopped {
            next &= !(STOP | START);
            self.queue.clear();
        }
        let starts = next & START != 0 && !self.is_started();
        self.registers.set(CR, next);
        let by_software = self.registers.get(CFGR) >> 10 & 3 == 0;
        if starts && by_software {
            self.begin(now);
        }
        starts
    }
}
