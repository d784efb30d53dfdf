//! Trigger, converter and DMA. A hundred and sixty thousand sequences a second would stop the processor more often than it
//! runs: what they do is made up for in one go, each at its own time, before anybody can see it.
//!
//! Seen is what the program reads or writes of timer, converter and DMA, and their interrupts, all to the unit of time. In
//! memory a word may appear up to a tenth of a millisecond late, but never after the interrupt that tells of it.

use monitor::{ClippedChannels, RawSample};

use super::{LINE_ADC1, LINE_TIM4_UP, Machine};
use crate::peripherals::dma::Transfer;
use crate::peripherals::registers::Unmodelled;

/// Sequences that make a sample, as the program adds them up.
pub(super) const CONVERSIONS: u32 = 16;
/// Channels of ADC1 as wired in docs/wiring.md: voltages a, b, c, then currents a, b, c.
const WIRED: [u32; 6] = [1, 6, 8, 2, 7, 9];
/// ADC1's data register.
const ADC1_DATA: u32 = 0x5000_0040;

/// What the converter took for the sample that is being made, however the program adds it up.
#[derive(Clone, Copy, Default)]
pub(crate) struct Taking {
    sequences: u32,
    sums: [u16; 6],
    clipped: u8,
}

impl Taking {
    /// Takes one conversion; the sample when it is the last of it.
    fn take(&mut self, channel: u32, code: u16, ends: bool, count: u16) -> Option<RawSample> {
        if let Some(place) = WIRED.iter().position(|wired| *wired == channel) {
            self.sums[place] = self.sums[place].wrapping_add(code);
            self.clipped |= u8::from(!(2..=4_093).contains(&code)) << place;
        }
        self.sequences += u32::from(ends);
        if self.sequences < CONVERSIONS {
            return None;
        }
        let [v_a, v_b, v_c, i_a, i_b, i_c] = self.sums;
        let sample = RawSample {
            voltage_codes: [v_a, v_b, v_c],
            current_codes: [i_a, i_b, i_c],
            encoder_count: count,
            clipped: ClippedChannels::from_bits(self.clipped),
        };
        *self = Taking::default();
        Some(sample)
    }
}

/// Bytes for memory, joined where they follow each other.
#[derive(Clone, Default)]
pub(crate) struct Writes(pub Vec<(u32, Vec<u8>)>);

impl Writes {
    fn push(&mut self, address: u32, value: u16) {
        let follows = |(start, bytes): &&mut (u32, Vec<u8>)| {
            start.wrapping_add(bytes.len() as u32) == address
        };
        match self.0.iter_mut().rev().take(4).find(follows) {
            Some((_, bytes)) => bytes.extend(value.to_le_bytes()),
            None => self.0.push((address, value.to_le_bytes().to_vec())),
        }
    }
}

impl Machine {
    /// Does everything of acquisition up to now.
    pub fn catch_up(&mut self) -> Result<(), Unmodelled> {
        while let Some(at) = self.next_of_acquisition().filter(|at| *at <= self.now) {
            self.acquire(at)?;
        }
        // Flags that nobody waits for.
        self.tim4.advance(self.now);
        Ok(())
    }

    /// The converter was started: what follows is a new sample.
    pub(super) fn begin_sample(&mut self) {
        self.taking = Taking::default();
    }

    fn next_of_acquisition(&self) -> Option<u64> {
        match (self.tim4.next_event(), self.adc1.next_event()) {
            (Some(trigger), Some(end)) => Some(trigger.min(end)),
            (trigger, end) => trigger.or(end),
        }
    }

    /// Until when the processor may run before acquisition has to be made up for.
    pub(super) fn acquisition_horizon(&self) -> Option<u64> {
        let next = self.next_of_acquisition()?;
        let sequence = u64::from(self.adc1.length());
        let until = |line, each: u64| {
            let left = self.dma.until_flag(line)?;
            Some(u64::from(left) / each)
        };
        let triggers = [until(LINE_ADC1, sequence), until(LINE_TIM4_UP, 1)];
        let free = triggers
            .into_iter()
            .flatten()
            .min()
            .unwrap_or(0)
            .min(u64::from(CONVERSIONS));
        // A sequence may be under way, and the flag comes within the last one.
        Some(next + free.saturating_sub(2) * self.tim4.whole_period())
    }

    fn acquire(&mut self, now: u64) -> Result<(), Unmodelled> {
        let ticked = self.tim4.advance(now);
        if ticked.trigger || ticked.update_dma {
            let count = self.sensing.count(now);
            self.tim3.apply_encoder(count);
            self.count = count;
        }
        if ticked.update_dma {
            match self.lost_encoder_requests.checked_sub(1) {
                Some(left) => self.lost_encoder_requests = left,
                None => self.serve(LINE_TIM4_UP)?,
            }
        }
        if ticked.trigger && !self.adc1.trigger(now) {
            self.tally.missed_triggers += 1;
        }
        self.convert(now)
    }

    fn convert(&mut self, now: u64) -> Result<(), Unmodelled> {
        let (sensing, millivolt) = (&mut self.sensing, self.vdda_millivolt);
        let level = |channel, sampled| sensing.code(channel, sampled, millivolt);
        let Some(ended) = self.adc1.advance(now, level) else {
            return Ok(());
        };
        let count = self.count;
        if let Some(sample) =
            self.taking
                .take(ended.channel, ended.code, ended.ends_sequence, count)
        {
            self.tally.conversions += 1;
            if let Some(taken) = &mut self.taken {
                taken.push(sample);
            }
        }
        if ended.asks_dma {
            self.serve(LINE_ADC1)?;
        }
        Ok(())
    }

    fn serve(&mut self, line: u32) -> Result<(), Unmodelled> {
        if self.dma_blocked {
            return Ok(());
        }
        if let Some(Transfer { peripheral, memory }) = self.dma.request(line)? {
            let value = match peripheral {
                ADC1_DATA => self.adc1.fetch(),
                _ => self.read_as_it_is(peripheral)? as u16,
            };
            self.writes.push(memory, value);
        }
        Ok(())
    }
}
