//! One window's result on its way to a computer.

use monitor::{Lamp, Lamps, RESIDUALS, Reason, Report};
use serde::{Deserialize, Serialize};

use crate::door::display::{LAMPS, Shown};
use crate::frames::framing::{self, MAX_FRAME_BYTES, SCHEMA};

/// What the board says about one window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    schema: u8,
    /// Counts frames, wrapping; a gap shows what was lost on the way.
    pub sequence: u32,
    /// Samples that the core has seen up to the end of the window.
    pub sample_index: u64,
    /// Lamps in the order of [`crate::LAMP_NAMES`], two bits each from the lowest: 0 off, 1 on, 2 blinking.
    pub lamps: u32,
    /// Residuals r1..r4 relative to their scales; `None` where they could not be evaluated.
    pub residuals: Option<[f32; RESIDUALS]>,
    /// Positive-sequence phase voltage, amplitude, V.
    pub u_s_volt: f32,
    /// Positive-sequence phase current, amplitude, A.
    pub i_s_amp: f32,
    /// Supply frequency, rad/s; negative where the phases follow each other as a, c, b: the field turns backwards.
    pub omega_sync_rad_s: f32,
    /// Mechanical speed, rad/s, negative backwards; `None` without a sensor.
    pub omega_mech_rad_s: Option<f32>,
    /// Number of the reason why the window was not judged ([`monitor::Reason`]); 0 when it was, at rest or in motion.
    pub not_judged: u8,
    /// Supply of the converters, mV.
    pub vdda_millivolt: u16,
    /// How the window stands in motion: number of a [`monitor::MotionWord`].
    pub motion: u8,
}

impl Frame {
    /// What a report says, and what the door shows with it.
    #[inline(never)]
    pub fn new(report: &Report, shown: &Shown, sequence: u32, vdda_millivolt: u16) -> Self {
        let window = report.window.unwrap_or_default();
        Frame {
            schema: SCHEMA,
            sequence,
            sample_index: report.sample_index,
            lamps: packed(&shown.lamps),
            residuals: report
                .residuals
                .filter(|_| !shown.instrument_faulty)
                .map(|residuals| residuals.r),
            u_s_volt: monitor::magnitude(window.u_s.positive),
            i_s_amp: monitor::magnitude(window.i_s.positive),
            omega_sync_rad_s: match window.backwards {
                true => -window.omega_sync,
                false => window.omega_sync,
            },
            omega_mech_rad_s: window.shaft_speed(),
            not_judged: why_not_judged(report, shown),
            vdda_millivolt,
            motion: report.motion_word() as u8,
        }
    }

    /// Lamp `index` in the order of [`crate::LAMP_NAMES`]; dark beyond.
    pub fn lamp(&self, index: usize) -> Lamp {
        match self.lamps.checked_shr(2 * index as u32).unwrap_or(0) & 3 {
            1 => Lamp::On,
            2 => Lamp::Blink,
            _ => Lamp::Off,
        }
    }

    /// FAULT, the last of the lamps.
    pub fn fault(&self) -> Lamp {
        self.lamp(LAMPS - 1)
    }

    /// The bytes to send, zero byte included; empty if they did not fit, which a test rules out.
    #[inline(never)]
    pub fn encode<'a>(&self, buffer: &'a mut [u8; MAX_FRAME_BYTES]) -> &'a [u8] {
        framing::encode(self, buffer)
    }
}

/// Number of the reason why a window counts for nothing; 0 where it was judged.
fn why_not_judged(report: &Report, shown: &Shown) -> u8 {
    match shown.instrument_faulty {
        true => Reason::Instrument.number(),
        false => report.reason().map_or(0, Reason::number),
    }
}

pub(crate) fn packed(lamps: &Lamps) -> u32 {
    let lamps = crate::door::display::in_order(lamps);
    let codes = lamps.map(|lamp| match lamp {
        Lamp::Off => 0,
        Lamp::On => 1,
        Lamp::Blink => 2,
    });
    (0..LAMPS).fold(0, |bits, k| bits | codes[k] << (2 * k))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::framing::FrameError;
    use proptest::prelude::*;

    /// Every number at its longest.
    fn longest() -> Frame {
        Frame {
            schema: SCHEMA,
            sequence: u32::MAX,
            sample_index: u64::MAX,
            lamps: u32::MAX,
            residuals: Some([f32::MIN; 4]),
            u_s_volt: f32::MIN,
            i_s_amp: f32::MIN,
            omega_sync_rad_s: f32::MIN,
            omega_mech_rad_s: Some(f32::MIN),
            not_judged: u8::MAX,
            vdda_millivolt: u16::MAX,
            motion: u8::MAX,
        }
    }

    #[test]
    fn the_longest_frame_fits_and_comes_back() {
        let mut buffer = [0; MAX_FRAME_BYTES];
        let bytes = longest().encode(&mut buffer);
        assert!(!bytes.is_empty());
        assert_eq!(
            bytes.iter().filter(|byte| **byte == 0).count(),
            1,
            "only the end is zero"
        );
        assert_eq!(Frame::decode(bytes), Ok(longest()));
    }

    #[test]
    fn lamps_are_told_apart() {
        let shown = Shown {
            lamps: Lamps {
                run: Lamp::Blink,
                fault: Lamp::On,
                ..Lamps::default()
            },
            ..Shown::default()
        };
        let frame = Frame::new(&Report::default(), &shown, 0, 3300);
        let seen: Vec<Lamp> = (0..LAMPS).map(|k| frame.lamp(k)).collect();
        assert_eq!(seen[0], Lamp::Blink);
        assert_eq!(seen[LAMPS - 1], Lamp::On);
        assert!(seen[1..LAMPS - 1].iter().all(|lamp| *lamp == Lamp::Off));
    }

    #[test]
    fn another_schema_is_named() {
        let mut other = longest();
        other.schema = 1;
        let mut buffer = [0; MAX_FRAME_BYTES];
        assert_eq!(
            Frame::decode(other.encode(&mut buffer)),
            Err(FrameError::Schema(1))
        );
    }

    proptest! {
        #[test]
        fn a_damaged_frame_is_never_taken_for_a_frame(place in 0..80_usize, flip in 1..=255_u8) {
            let mut buffer = [0; MAX_FRAME_BYTES];
            let mut bytes = longest().encode(&mut buffer).to_vec();
            prop_assume!(place < bytes.len() - 1);
            bytes[place] ^= flip;
            prop_assert!(Frame::decode(&bytes).is_err());
        }

        #[test]
        fn any_bytes_are_read_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            let _ = Frame::decode(&bytes);
        }
    }
}
