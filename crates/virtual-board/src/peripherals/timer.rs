//! General-purpose timers: counting, update and compare flags; TIM3 counts the encoder instead.

use crate::peripherals::registers::{Registers, Unmodelled};

const CR1: u32 = 0x00;
const CR2: u32 = 0x04;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0C;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2C;
const CCR: [u32; 2] = [0x34, 0x38];
const UPDATE: u32 = 1;
const CAPTURE: u32 = 2;
const UPDATE_DMA: u32 = 1 << 8;
const RESET: &[(u32, u32)] = &[
    (CR1, 0),
    (CR2, 0),
    (SMCR, 0),
    (DIER, 0),
    (0x18, 0), // CCMR1
    (0x1C, 0), // CCMR2
    (0x20, 0), // CCER
    (PSC, 0),
    (ARR, 0xFFFF),
    (CCR[0], 0),
    (CCR[1], 0),
    (0x3C, 0),
    (0x40, 0),
    (0x44, 0), // BDTR
];

/// One timer.
#[derive(Clone, Debug)]
pub struct Timer {
    registers: Registers,
    status: u32,
    /// Prescaler in force; the register takes effect at an update.
    prescaler: u64,
    /// Units of time per cycle of its clock.
    clock: u64,
    /// Count at `since`, and the cycle from which it counts.
    count: u64,
    since: u64,
    /// Ticks since `since` whose flags were evaluated.
    evaluated: u64,
    /// What happened before a write and is still to be handed out.
    pending: Ticked,
    /// Cycle of the next flag, and of the next one that anybody waits for: looked at far more often than they change.
    next_flag: Option<u64>,
    next_event: Option<u64>,
    /// Encoder count in encoder mode, as last seen and when the program set it.
    encoder: u16,
    /// Edges of the encoder that the program has asked to be interrupted for and has not acknowledged.
    edges: u64,
}

/// What one advance of a timer brought.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ticked {
    /// The counter wrapped and asks for DMA.
    pub update_dma: bool,
    /// The counter wrapped and its trigger output follows updates.
    pub trigger: bool,
}

impl Ticked {
    fn and(self, later: Ticked) -> Ticked {
        Ticked {
            update_dma: self.update_dma || later.update_dma,
            trigger: self.trigger || later.trigger,
        }
    }
}

impl Timer {
    /// After reset.
    pub fn new() -> Self {
        Timer {
            registers: Registers::new("TIM", RESET),
            status: 0,
            prescaler: 1,
            clock: 1,
            count: 0,
            since: 0,
            evaluated: 0,
            pending: Ticked::default(),
            next_flag: None,
            next_event: None,
            encoder: 0,
            edges: 0,
        }
    }

    /// Its clock takes `clock` units of time a cycle from now on.
    pub fn set_clock(&mut self, clock: u64, now: u64) {
        if clock != self.clock {
            self.rebase(now);
            self.clock = clock;
            self.look_ahead();
        }
    }

    /// A reset; the clock stays.
    pub fn reset(&mut self) {
        *self = Timer {
            clock: self.clock,
            ..Timer::new()
        };
    }

    /// Units of time per count.
    fn step(&self) -> u64 {
        self.prescaler * self.clock
    }

    fn is_counting(&self) -> bool {
        self.registers.get(CR1) & 1 == 1 && !self.is_encoder()
    }

    fn is_encoder(&self) -> bool {
        self.registers.get(SMCR) & 7 == 3
    }

    fn period(&self) -> u64 {
        u64::from(self.registers.get(ARR)) + 1
    }

    /// Units of time from one wrap to the next.
    pub fn whole_period(&self) -> u64 {
        self.period() * self.step()
    }

    fn ticks(&self, now: u64) -> u64 {
        if self.is_counting() {
            (now - self.since) / self.step()
        } else {
            0
        }
    }

    fn count_now(&self, now: u64) -> u64 {
        (self.count + self.ticks(now)) % self.period()
    }

    /// Starts counting anew from the present count, so that changed settings apply from here on. What happened until
    /// now has happened: its flags must not be lost because the program writes to the timer in that very moment.
    fn rebase(&mut self, now: u64) {
        let before = self.evaluate(now);
        self.pending = self.pending.and(before);
        self.count = self.count_now(now);
        // Not simply `now`: the prescaler keeps its place within a tick.
        self.since = if self.is_counting() {
            self.since + self.ticks(now) * self.step()
        } else {
            now
        };
        self.evaluated = 0;
    }

    /// The encoder's count, where the timer is switched to count it. All edges since the last call come at once; one
    /// capture interrupt each, where the program wants them.
    pub fn apply_encoder(&mut self, count: u16) {
        if self.registers.get(CR1) & 1 != 1 || !self.is_encoder() {
            return;
        }
        let moved = count.wrapping_sub(self.encoder) as i16;
        self.encoder = count;
        if self.registers.get(DIER) & CAPTURE != 0 {
            self.edges += u64::from(moved.unsigned_abs());
            self.raise_capture();
        }
    }

    fn raise_capture(&mut self) {
        if self.edges > 0 {
            self.edges -= 1;
            self.status |= CAPTURE;
        }
    }

    /// First tick after the evaluated one at which the count is `value`.
    fn next_tick(&self, value: u64) -> u64 {
        let period = self.period();
        let seen = (self.count + self.evaluated) % period;
        self.evaluated + (value + period - seen - 1) % period + 1
    }

    /// Values at which something happens, with their flag.
    fn marks(&self) -> [(u64, u32); 3] {
        let compare = |k: usize| u64::from(self.registers.get(CCR[k]));
        [(0, UPDATE), (compare(0), 2), (compare(1), 4)]
    }

    /// Cycle of the next flag that anybody waits for.
    pub fn next_event(&self) -> Option<u64> {
        self.next_event
    }

    /// Finds both next cycles anew, after anything that may move them.
    fn look_ahead(&mut self) {
        let wanted = self.registers.get(DIER) | self.registers.get(DIER) >> 8 | self.triggers();
        self.next_flag = self.next_of(u32::MAX);
        self.next_event = self.next_of(wanted);
    }

    /// Cycle of the next one of `flags`.
    fn next_of(&self, flags: u32) -> Option<u64> {
        if !self.is_counting() {
            return None;
        }
        let marks = self.marks().into_iter();
        let ticks = marks
            .filter(|(_, flag)| flags & flag != 0)
            .map(|(value, _)| self.next_tick(value));
        Some(self.since + ticks.min()? * self.step())
    }

    fn triggers(&self) -> u32 {
        u32::from(self.registers.get(CR2) >> 4 & 7 == 2)
    }

    /// Sets the flags of everything that happened up to `now`.
    pub fn advance(&mut self, now: u64) -> Ticked {
        let mut ticked = std::mem::take(&mut self.pending);
        if self.next_flag.is_some_and(|at| at <= now) {
            ticked = ticked.and(self.evaluate(now));
            self.look_ahead();
        }
        ticked
    }

    fn evaluate(&mut self, now: u64) -> Ticked {
        let ticks = self.ticks(now);
        let mut reached = 0;
        for (value, flag) in self.marks() {
            if self.is_counting() && self.next_tick(value) <= ticks {
                reached |= flag;
            }
        }
        self.evaluated = self.evaluated.max(ticks);
        self.status |= reached;
        let wrapped = reached & UPDATE != 0;
        Ticked {
            update_dma: wrapped && self.registers.get(DIER) & UPDATE_DMA != 0,
            trigger: wrapped && self.triggers() != 0,
        }
    }

    /// Whether the interrupt line is asserted.
    pub fn interrupt(&self) -> bool {
        self.status & self.registers.get(DIER) & 0x7 != 0
    }

    /// A bus read at cycle `now`.
    pub fn read(&self, offset: u32, now: u64) -> Result<u32, Unmodelled> {
        match offset {
            SR => Ok(self.status),
            CNT if self.is_encoder() => Ok(u32::from(self.encoder)),
            CNT => Ok(self.count_now(now) as u32),
            _ => self.registers.read(offset),
        }
    }

    /// A bus write at cycle `now`.
    pub fn write(&mut self, offset: u32, value: u32, now: u64) -> Result<(), Unmodelled> {
        self.rebase(now);
        let written = self.put(offset, value, now);
        self.look_ahead();
        written
    }

    fn put(&mut self, offset: u32, value: u32, now: u64) -> Result<(), Unmodelled> {
        match offset {
            SR => {
                self.status &= value;
                if self.is_encoder() && self.status & CAPTURE == 0 {
                    self.raise_capture();
                }
            }
            EGR => {
                self.prescaler = u64::from(self.registers.get(PSC)) + 1;
                (self.count, self.since) = (0, now);
                let only_overflow = self.registers.get(CR1) & 4 != 0;
                self.status |= u32::from(!only_overflow);
            }
            CNT if self.is_encoder() => self.encoder = value as u16,
            CNT => self.count = u64::from(value & 0xFFFF),
            _ => return self.registers.write(offset, value),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: u64 = 0x1_0000;
    const PRESCALER: u64 = 170;

    /// As the time driver sets it up: interrupts at the wrap and at half a period.
    fn time_driver() -> Timer {
        let mut timer = Timer::new();
        for (offset, value) in [
            (PSC, 169),
            (EGR, 1),
            (SR, 0),
            (CCR[0], 0x8000),
            (DIER, 3),
            (CR1, 1),
        ] {
            timer.write(offset, value, 0).expect("a register");
        }
        timer
    }

    /// Around the wrap and around half a period, a cycle apart.
    fn moments() -> impl Iterator<Item = u64> {
        let around = |tick: u64| PRESCALER * tick - 3..PRESCALER * tick + 200;
        around(PERIOD / 2).chain(around(PERIOD))
    }

    #[test]
    fn a_write_in_the_moment_of_an_event_loses_no_flag() {
        for moment in moments() {
            let mut timer = time_driver();
            let half = PRESCALER * PERIOD / 2;
            timer.advance(moment.min(half - 1));
            // The driver sets its alarm.
            timer.write(CCR[1], 0x1234, moment).expect("a register");
            timer.advance(moment + 1_000);
            let expected = if moment + 1_000 < PRESCALER * PERIOD {
                2
            } else {
                3
            };
            assert_eq!(timer.status & 3, expected, "at cycle {moment}");
        }
    }

    #[test]
    fn writes_cost_no_time() {
        let mut timer = time_driver();
        for moment in (0..1_000_000).step_by(997) {
            timer.write(CCR[1], 0x1234, moment).expect("a register");
        }
        assert_eq!(timer.read(CNT, 1_000_000), Ok(1_000_000 / 170));
    }
}
