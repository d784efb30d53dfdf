//! What arrives at the core: one instant of the six analogue channels and the speed sensor.

use frames::Abc;

/// Channels: voltages a, b, c, then currents a, b, c.
pub const CHANNELS: usize = 6;

/// One sampling instant as the hardware delivers it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RawSample {
    /// ADC codes of the phase voltages a, b, c; sums of them where [`Converter::summed`](crate::Converter::summed) says so.
    pub voltage_codes: [u16; 3],
    /// ADC codes of the phase currents a, b, c.
    pub current_codes: [u16; 3],
    /// Free-running encoder counter, four counts per pulse, wrapping.
    pub encoder_count: u16,
    /// Channels of which a single conversion was at a rail, which a sum does not show.
    pub clipped: ClippedChannels,
}

/// Consecutive instants as the converter's and the encoder's DMA leave them; taken from the front.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RawBlock<'a> {
    codes: &'a [[u16; CHANNELS]],
    counts: &'a [u16],
    /// Of each instant, or empty where none is marked.
    clipped: &'a [ClippedChannels],
    /// Whether single conversions were looked at: then codes need not be.
    pub(crate) is_watched: bool,
}

impl<'a> RawBlock<'a> {
    /// `codes` are ADC codes in the order voltage a, current a, voltage b, current b, voltage c, current c; `counts`
    /// the free-running encoder counter at the same instants. The longer of the two is cut to the shorter.
    pub fn new(codes: &'a [[u16; CHANNELS]], counts: &'a [u16]) -> Self {
        let length = codes.len().min(counts.len());
        RawBlock {
            codes: codes.get(..length).unwrap_or_default(),
            counts: counts.get(..length).unwrap_or_default(),
            clipped: &[],
            is_watched: false,
        }
    }

    /// The same, of codes that are sums of conversions each of which was looked at: the channels of each instant of which one was
    /// at a rail; empty where there are none. The sums themselves are not compared with rails then.
    #[must_use]
    pub fn with_clipped(self, clipped: &'a [ClippedChannels]) -> Self {
        RawBlock {
            clipped,
            is_watched: true,
            ..self
        }
    }

    /// Whether every instant was taken.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.codes.is_empty()
    }

    /// Counts of the instants that are left.
    #[inline]
    pub(crate) fn counts(&self) -> &'a [u16] {
        self.counts
    }

    /// The instants that are left.
    #[inline]
    pub(crate) fn instants(&self) -> impl Iterator<Item = (&'a [u16; CHANNELS], u16)> + use<'a> {
        self.codes.iter().zip(self.counts.iter().copied())
    }

    /// Takes at most `length` instants and gives their codes, and the channels that are marked in any of them.
    #[inline]
    pub(crate) fn take(&mut self, length: usize) -> (&'a [[u16; CHANNELS]], ClippedChannels) {
        let length = length.min(self.codes.len());
        let taken = self.codes.get(..length).unwrap_or_default();
        self.codes = self.codes.get(length..).unwrap_or_default();
        self.counts = self.counts.get(length..).unwrap_or_default();
        (taken, self.take_clipped(length))
    }

    #[inline]
    fn take_clipped(&mut self, length: usize) -> ClippedChannels {
        let length = length.min(self.clipped.len());
        let taken = self.clipped.get(..length).unwrap_or_default();
        self.clipped = self.clipped.get(length..).unwrap_or_default();
        taken
            .iter()
            .fold(ClippedChannels::NONE, |all, one| all.union(*one))
    }
}

impl RawSample {
    /// The codes in the order of [`RawBlock`].
    pub(crate) fn interleaved(&self) -> [u16; CHANNELS] {
        let [v_a, v_b, v_c] = self.voltage_codes;
        let [i_a, i_b, i_c] = self.current_codes;
        [v_a, i_a, v_b, i_b, v_c, i_c]
    }
}

/// What is known about the shaft at this instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpeedSample {
    /// No speed sensor.
    #[default]
    None,
    /// Free-running encoder counter, four counts per pulse, wrapping.
    Count(u16),
    /// Mechanical speed, rad/s, from a tachometer or a recording.
    RadPerSecond(f32),
}

/// One sampling instant in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Phase-to-neutral voltages, V; `None` when they are not measured.
    pub u_s_abc: Option<Abc>,
    /// Phase currents into the motor, A; `None` when they are not measured.
    pub i_s_abc: Option<Abc>,
    /// Shaft speed or position.
    pub speed: SpeedSample,
    /// Brake torque at the shaft, N m, where a torque channel exists.
    pub tau_load: Option<f32>,
    /// Which channels were at a rail of their converter.
    pub clipped: ClippedChannels,
}

/// One flag per analogue channel: voltages a, b, c, then currents a, b, c.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClippedChannels(u8);

impl ClippedChannels {
    /// No channel clipped.
    pub const NONE: Self = ClippedChannels(0);

    /// Marks voltage channel `phase` (0..=2).
    pub fn mark_voltage(&mut self, phase: usize) {
        self.0 |= 1 << (phase % 3);
    }

    /// Marks current channel `phase` (0..=2).
    pub fn mark_current(&mut self, phase: usize) {
        self.0 |= 1 << (3 + phase % 3);
    }

    /// Whether voltage channel `phase` (0..=2) is marked.
    pub fn voltage(self, phase: usize) -> bool {
        self.0 >> (phase % 3) & 1 == 1
    }

    /// Whether current channel `phase` (0..=2) is marked.
    pub fn current(self, phase: usize) -> bool {
        self.0 >> (3 + phase % 3) & 1 == 1
    }

    /// Marks of channels: voltages a, b, c, then currents a, b, c.
    pub fn of(channels: [bool; CHANNELS]) -> Self {
        let marks = channels.iter().enumerate();
        ClippedChannels(marks.fold(0, |all, (k, marked)| all | u8::from(*marked) << k))
    }

    /// Marks by bits: voltages a, b, c, then currents a, b, c from bit 0 on.
    pub const fn from_bits(bits: u8) -> Self {
        ClippedChannels(bits & 0x3F)
    }

    /// Whether any channel is marked.
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// The channels marked in either.
    pub fn union(self, other: Self) -> Self {
        ClippedChannels(self.0 | other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_channel_has_its_own_mark() {
        for phase in 0..3 {
            let (mut voltage, mut current) = (ClippedChannels::NONE, ClippedChannels::NONE);
            voltage.mark_voltage(phase);
            current.mark_current(phase);
            for other in 0..3 {
                assert_eq!(voltage.voltage(other), other == phase);
                assert_eq!(current.current(other), other == phase);
                assert!(!voltage.current(other) && !current.voltage(other));
            }
            assert!(voltage.any() && current.any());
            // A mark stays when it is set again or joined with itself.
            let mut twice = voltage.union(current);
            twice.mark_voltage(phase);
            twice.mark_current(phase);
            assert_eq!(twice, voltage.union(current).union(voltage));
            assert!(twice.voltage(phase) && twice.current(phase));
        }
        assert!(!ClippedChannels::NONE.any());
    }

    #[test]
    fn a_block_is_as_long_as_its_shorter_half_and_is_taken_from_the_front() {
        let codes: [[u16; CHANNELS]; 3] = [[1; CHANNELS], [2; CHANNELS], [3; CHANNELS]];
        let mut block = RawBlock::new(&codes, &[10, 20]);
        let seen: Vec<_> = block
            .instants()
            .map(|(codes, count)| (codes[0], count))
            .collect();
        assert_eq!(seen, [(1, 10), (2, 20)]);
        assert!(!block.is_empty());
        assert_eq!(block.take(1), (&codes[..1], ClippedChannels::NONE));
        let left: Vec<_> = block
            .instants()
            .map(|(codes, count)| (codes[0], count))
            .collect();
        assert_eq!(left, [(2, 20)]);
        assert_eq!(block.take(5).0, &codes[1..2], "no more than there are");
        assert!(block.is_empty());
    }

    #[test]
    fn marks_of_single_conversions_come_with_their_instants() {
        let codes = [[1; CHANNELS]; 4];
        let marks = [0, 0b1, 0b10_0000, 0].map(ClippedChannels::from_bits);
        let mut block = RawBlock::new(&codes, &[0; 4]).with_clipped(&marks);
        assert_eq!(block.take(1).1, ClippedChannels::NONE);
        let (_, both) = block.take(2);
        assert!(both.voltage(0) && both.current(2) && !both.voltage(1));
        assert_eq!(block.take(1).1, ClippedChannels::NONE);
    }

    #[test]
    fn codes_alternate_between_voltage_and_current() {
        let raw = RawSample {
            voltage_codes: [1, 2, 3],
            current_codes: [4, 5, 6],
            encoder_count: 7,
            ..RawSample::default()
        };
        assert_eq!(raw.interleaved(), [1, 4, 2, 5, 3, 6]);
    }
}
