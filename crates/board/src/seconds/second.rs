//! One second as it lies in the ring and travels to a master.

/// Bytes of a second: twenty words of the protocol.
pub const SECOND_BYTES: usize = 40;
const WORDS: usize = SECOND_BYTES / 4;
/// Steps of a residual: a ten-thousandth of its scale.
const STEPS: f32 = 1e4;
/// Where there is no residual.
const MISSING: i16 = i16::MIN;

/// What was measured and judged in one second: means over its windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Second {
    /// Which run of the program: the number that its first event gets. Two runs never have the same.
    pub start: u32,
    /// Counts from 1 since the start.
    pub number: u32,
    /// Two bits for each lamp, as in the register `Lamps`: the brightest that it was within the second, on before blinking.
    pub lamps: u32,
    /// Windows that ended in the second.
    pub windows: u8,
    /// Of these judged.
    pub judged: u8,
    /// Number of the reason of the last window that was not judged; 0 where every one was.
    pub not_judged: u8,
    /// Number of the likeliest fault of the last window; 0 where FAULT is dark.
    pub fault: u8,
    /// r1..r4, shares of their scales, -3.2767 to 3.2767 in steps of 0.0001; `None` where no window had them.
    pub residuals: Option<[f32; 4]>,
    /// Phase voltage, positive sequence, RMS, V; NaN where it was not measured, as the three below.
    pub voltage_volt: f32,
    /// Phase current, positive sequence, RMS, A.
    pub current_amp: f32,
    /// Of the supply, Hz.
    pub supply_hz: f32,
    /// Of the shaft, 1/min.
    pub speed_rpm: f32,
}

impl Second {
    /// Nothing, as it lies in the ring before anything happened: number 0.
    pub const BLANK: [u8; SECOND_BYTES] = [0; SECOND_BYTES];

    /// Little-endian words, as they lie in the ring.
    pub fn to_bytes(&self) -> [u8; SECOND_BYTES] {
        let [r1, r2, r3, r4] = self.residuals.map_or([MISSING; 4], |r| r.map(steps));
        let counts = [self.windows, self.judged, self.not_judged, self.fault];
        let words = [
            self.start,
            self.number,
            self.lamps,
            u32::from_le_bytes(counts),
            pair(r1, r2),
            pair(r3, r4),
            self.voltage_volt.to_bits(),
            self.current_amp.to_bits(),
            self.supply_hz.to_bits(),
            self.speed_rpm.to_bits(),
        ];
        let mut bytes = Self::BLANK;
        for (place, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
            *place = word.to_le_bytes();
        }
        bytes
    }

    /// From a master's answer; `None` where there is no second yet.
    pub fn from_bytes(bytes: &[u8; SECOND_BYTES]) -> Option<Self> {
        let mut words = [0; WORDS];
        for (word, four) in words.iter_mut().zip(bytes.as_chunks::<4>().0) {
            *word = u32::from_le_bytes(*four);
        }
        let [start, number, lamps, counts, r12, r34, u, i, f, n] = words;
        let [windows, judged, not_judged, fault] = counts.to_le_bytes();
        let ([r1, r2], [r3, r4]) = (halves(r12), halves(r34));
        let known = ![r1, r2, r3, r4].contains(&MISSING);
        (number > 0).then_some(Second {
            start,
            number,
            lamps,
            windows,
            judged,
            not_judged,
            fault,
            residuals: known.then(|| [r1, r2, r3, r4].map(|r| f32::from(r) / STEPS)),
            voltage_volt: f32::from_bits(u),
            current_amp: f32::from_bits(i),
            supply_hz: f32::from_bits(f),
            speed_rpm: f32::from_bits(n),
        })
    }
}

/// Beyond the range a residual stays at its end; what is no number counts as none.
fn steps(residual: f32) -> i16 {
    if residual.is_nan() {
        return MISSING;
    }
    let half = if residual < 0.0 { -0.5 } else { 0.5 };
    ((residual * STEPS + half) as i16).max(-i16::MAX)
}

fn pair(low: i16, high: i16) -> u32 {
    u32::from(high as u16) << 16 | u32::from(low as u16)
}

fn halves(word: u32) -> [i16; 2] {
    [word as i16, (word >> 16) as i16]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    pub(in super::super) fn example(number: u32) -> Second {
        Second {
            start: 7,
            number,
            lamps: 0b01_00_00_00_00_00_00_01,
            windows: 50,
            judged: 49,
            not_judged: 10,
            fault: 1,
            residuals: Some([0.0123, -0.5, 0.0, 3.2767]),
            voltage_volt: 230.5,
            current_amp: 4.75,
            supply_hz: 50.0,
            speed_rpm: -1_430.25,
        }
    }

    #[test]
    fn a_second_comes_back_and_what_is_blank_is_none() {
        assert_eq!(Second::from_bytes(&example(3).to_bytes()), Some(example(3)));
        assert_eq!(Second::from_bytes(&Second::BLANK), None);
        let without = Second {
            residuals: None,
            ..example(4)
        };
        assert_eq!(Second::from_bytes(&without.to_bytes()), Some(without));
    }

    #[test]
    fn bytes_lie_where_the_manual_says() {
        let bytes = example(0x0102_0304).to_bytes();
        assert_eq!(bytes[4..8], [4, 3, 2, 1]);
        assert_eq!(bytes[12..16], [50, 49, 10, 1]);
        assert_eq!(bytes[16..18], 123_i16.to_le_bytes());
        assert_eq!(bytes[18..20], (-5_000_i16).to_le_bytes());
        assert_eq!(bytes[36..40], (-1_430.25_f32).to_le_bytes());
    }

    proptest! {
        /// Half a step of 1e-4, and single precision of the product.
        #[test]
        fn a_residual_is_kept_to_half_a_step_or_to_the_end_of_the_range(r in -10.0_f32..10.0) {
            let kept = f32::from(steps(r)) / STEPS;
            prop_assert!((kept - r.clamp(-3.2767, 3.2767)).abs() < 5.1e-5, "{r} {kept}");
        }

        #[test]
        fn any_bytes_are_read(bytes in prop::collection::vec(any::<u8>(), SECOND_BYTES)) {
            let bytes: [u8; SECOND_BYTES] = bytes.try_into().unwrap_or(Second::BLANK);
            let number = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]);
            prop_assert_eq!(Second::from_bytes(&bytes).map(|second| second.number), (number > 0).then_some(number));
        }
    }
}
