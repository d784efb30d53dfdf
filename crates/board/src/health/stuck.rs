//! A converter's channel that stands still far from zero while its neighbours move.
//!
//! The core finds dead sensors, which show zero. A channel that stands elsewhere can shift the supply's reference beyond
//! its own zero crossings; then no supply is found, and nothing that rests on windows is ever looked at.

use monitor::CHANNELS;

/// Codes of 12 bits in the board's samples, which are sums of them.
const CONVERSIONS: u16 = 16;

/// Looks, one per 3.2 ms block, before anything is said (0.2 s): a sixth to a third of a cycle of 50 or 60 Hz apart, so
/// that a channel that moves has shown nearly all of its range.
const LOOKS: u8 = 62;
/// Codes by which a channel that stands still may waver: the converter's noise and its last bits.
const STILL: u16 = 16 * CONVERSIONS;
/// Codes that a neighbour must have moved: a tenth of the range. Without a supply all channels stand.
const MOVING: u16 = 410 * CONVERSIONS;
/// The code of zero.
const ZERO: u16 = 2_048 * CONVERSIONS;
/// Codes from zero beyond which a standing channel is stuck: a tenth of half the range. Nearer to zero it may be an open
/// phase, or a dead sensor, which the core tells apart.
const FAR: u16 = 205 * CONVERSIONS;

/// Codes seen since the last verdict, and the verdict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StuckChannels {
    lowest: [u16; CHANNELS],
    highest: [u16; CHANNELS],
    looks: u8,
    is_any: bool,
}

impl Default for StuckChannels {
    fn default() -> Self {
        StuckChannels {
            lowest: [u16::MAX; CHANNELS],
            highest: [0; CHANNELS],
            looks: 0,
            is_any: false,
        }
    }
}

impl StuckChannels {
    /// Takes one instant per block, in the order of [`monitor::RawBlock`]: voltage and current of each phase in turn.
    #[inline(never)]
    pub fn look(&mut self, codes: &[u16; CHANNELS]) {
        let ranges = self.lowest.iter_mut().zip(&mut self.highest);
        for ((lowest, highest), code) in ranges.zip(codes) {
            *lowest = (*lowest).min(*code);
            *highest = (*highest).max(*code);
        }
        self.looks += 1;
        if self.looks >= LOOKS {
            *self = StuckChannels {
                is_any: self.is_stuck(0) || self.is_stuck(1) || self.is_frozen(),
                ..StuckChannels::default()
            };
        }
    }

    /// Whether a channel was stuck at the last verdict, which is at most 0.4 s old.
    pub fn is_any(&self) -> bool {
        self.is_any
    }

    /// Whether all channels stand to the last bit, and some far from zero: a converter that works wavers by its noise.
    fn is_frozen(&self) -> bool {
        let mut ranges = self.lowest.iter().zip(&self.highest);
        let still = ranges.clone().all(|(lowest, highest)| lowest == highest);
        still && ranges.any(|(_, highest)| highest.abs_diff(ZERO) > FAR)
    }

    /// Whether, among voltages (0) or currents (1), one stands far from zero while another moves.
    fn is_stuck(&self, kind: usize) -> bool {
        let (mut stands, mut moves) = (false, false);
        let ranges = self.lowest.iter().zip(&self.highest);
        for (lowest, highest) in ranges.skip(kind).step_by(2) {
            let range = highest.saturating_sub(*lowest);
            stands |= range <= STILL && highest.abs_diff(ZERO) > FAR;
            moves |= range >= MOVING;
        }
        stands && moves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A balanced supply of `hz` with an amplitude in codes, looked at once per block for a second.
    fn judged(hz: f64, amplitude: f64, change: impl Fn(&mut [u16; CHANNELS])) -> bool {
        let mut channels = StuckChannels::default();
        for block in 0..312 {
            let angle = core::f64::consts::TAU * hz * 0.0032 * f64::from(block);
            let mut codes = core::array::from_fn(|place| {
                let phase = core::f64::consts::TAU / 3.0 * (place / 2) as f64;
                (16.0 * (2_048.0 + amplitude * (angle - phase).cos())) as u16
            });
            change(&mut codes);
            channels.look(&codes);
        }
        channels.is_any()
    }

    #[test]
    fn a_supply_of_any_frequency_is_not_stuck() {
        for hz in 5..=100 {
            assert!(!judged(f64::from(hz), 900.0, |_| {}), "{hz} Hz");
        }
    }

    #[test]
    fn a_channel_that_stands_away_from_zero_is_stuck_at_any_frequency() {
        for hz in 5..=100 {
            for place in 0..CHANNELS {
                for code in [0, 700, 1_800, 2_300, 4_095] {
                    let stuck = judged(f64::from(hz), 900.0, |codes| {
                        codes[place] = CONVERSIONS * code;
                    });
                    assert!(stuck, "{hz} Hz, channel {place} at {code}");
                }
            }
        }
    }

    #[test]
    fn an_open_phase_and_a_silent_motor_are_not_stuck() {
        assert!(!judged(50.0, 900.0, |codes| codes[3] = 2_050 * CONVERSIONS));
        // Nothing but noise moves: whatever the channels show, there is no supply.
        let last_bit = core::cell::Cell::new(0);
        assert!(!judged(50.0, 0.0, |codes| {
            last_bit.set(last_bit.get() ^ 1);
            codes[2] = 700 * CONVERSIONS + last_bit.get();
        }));
    }

    #[test]
    fn a_converter_whose_channels_all_stand_is_stuck() {
        let held: [u16; CHANNELS] =
            core::array::from_fn(|k| CONVERSIONS * (1_500 + 217 * k as u16));
        assert!(judged(50.0, 900.0, |codes| *codes = held));
        assert!(!judged(50.0, 900.0, |codes| *codes = [ZERO + 3; CHANNELS]));
    }

    #[test]
    fn a_channel_that_moves_again_is_not_stuck_any_more() {
        let mut channels = StuckChannels::default();
        let moving = |k: u16| [CONVERSIONS * (1_500 + 10 * k); CHANNELS];
        for k in 0..u16::from(LOOKS) {
            let mut codes = moving(k);
            codes[4] = 3_000 * CONVERSIONS;
            channels.look(&codes);
        }
        assert!(channels.is_any());
        (0..u16::from(LOOKS)).for_each(|k| channels.look(&moving(k)));
        assert!(!channels.is_any());
    }
}
