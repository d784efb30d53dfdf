//! The door of the core: bad numbers are kept out, missing and clipped channels are noted.

use crate::config::MonitorConfig;
use crate::frames::Abc;
use crate::sample::{ClippedChannels, Sample};

/// Share of a peak that is forgotten per second.
pub(crate) const PEAK_DECAY_PER_SECOND: f32 = 5.0;
/// Share of rated voltage (current, where voltages are missing) that counts as a supply.
pub(crate) const LEAST_REFERENCE: f32 = 0.05;

/// What has come in since the last cycle ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IntakeState {
    held_voltages: Abc,
    held_currents: Abc,
    /// Peaks of voltage and current as shares of their rated values, which decay slowly.
    peaks: [f32; 2],
    tally: Tally,
}

/// Counts over one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Samples in all.
    pub samples: u16,
    /// Samples with voltages, currents.
    pub present: [u16; 2],
    /// Samples that were not finite.
    pub invalid: u16,
    /// Channels at a rail.
    pub clipped: ClippedChannels,
    torque_sum: f32,
    torque_samples: u16,
}

/// One instant fit for arithmetic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Admitted {
    /// Phase voltages, V; 0 where not measured.
    pub u_s_abc: Abc,
    /// Phase currents, A; 0 where not measured.
    pub i_s_abc: Abc,
}

impl Tally {
    /// Whether at least half of the samples carried voltages and currents, in this order.
    pub fn measured(&self) -> [bool; 2] {
        self.present
            .map(|present| 2 * u32::from(present) > u32::from(self.samples))
    }

    /// Mean brake torque, N m, when every sample carried one.
    pub fn tau_load(&self) -> Option<f32> {
        let complete = self.torque_samples > 0 && self.torque_samples == self.samples;
        complete.then(|| self.torque_sum / f32::from(self.torque_samples))
    }
}

impl IntakeState {
    /// Takes one sample; whatever is not finite is replaced by its predecessor and counted.
    #[inline(always)]
    pub fn admit(&mut self, sample: &Sample) -> Admitted {
        let tally = &mut self.tally;
        tally.samples = tally.samples.saturating_add(1);
        tally.clipped = tally.clipped.union(sample.clipped);
        let (u_s_abc, voltages) = hold_last(&mut self.held_voltages, sample.u_s_abc);
        let (i_s_abc, currents) = hold_last(&mut self.held_currents, sample.i_s_abc);
        for (count, quality) in tally.present.iter_mut().zip([voltages, currents]) {
            *count = count.saturating_add(u16::from(quality != Quality::Missing));
        }
        let torque_bad = sample.tau_load.is_some_and(|tau| !tau.is_finite());
        let bad = voltages == Quality::Invalid || currents == Quality::Invalid || torque_bad;
        tally.invalid = tally.invalid.saturating_add(u16::from(bad));
        if let (Some(tau), false) = (sample.tau_load, torque_bad) {
            tally.torque_sum += tau;
            tally.torque_samples = tally.torque_samples.saturating_add(1);
        }
        Admitted { u_s_abc, i_s_abc }
    }

    /// Notes `instants` whose voltages and currents come from a converter and are numbers by construction.
    #[inline]
    pub fn admit_codes(&mut self, instants: usize, clipped: ClippedChannels) {
        let instants = u16::try_from(instants).unwrap_or(u16::MAX);
        let tally = &mut self.tally;
        tally.samples = tally.samples.saturating_add(instants);
        for count in &mut tally.present {
            *count = count.saturating_add(instants);
        }
        tally.clipped = tally.clipped.union(clipped);
    }

    /// Picks what the supply is found by: the voltage or, where there is none, the current; both as shares of rated.
    /// `keep` is what a peak keeps of itself from one sample to the next.
    #[inline(always)]
    pub fn reference(&mut self, [u, i]: [f32; 2], keep: f32) -> f32 {
        let [u_peak, i_peak] = &mut self.peaks;
        *u_peak = higher(*u_peak * keep, u.abs());
        *i_peak = higher(*i_peak * keep, i.abs());
        if *u_peak < LEAST_REFERENCE && *i_peak > LEAST_REFERENCE {
            i
        } else {
            u
        }
    }

    /// Whether neither voltage nor current is worth the name.
    pub fn is_dark(&self) -> bool {
        self.peaks.iter().all(|peak| *peak < LEAST_REFERENCE)
    }

    /// Ends a cycle: hands out the counts and starts new ones.
    pub fn close_cycle(&mut self) -> Tally {
        core::mem::take(&mut self.tally)
    }
}

/// Clarke's alpha of phase quantities or codes, times three; a zero sequence and a code of zero drop out.
pub(crate) fn reference_of(x: Abc) -> f32 {
    2.0 * x.a - x.b - x.c
}

/// Turns [`reference_of`] voltages in V and of currents in A into shares of rated.
pub(crate) fn reference_scales(config: &MonitorConfig) -> [f32; 2] {
    [config.rated_voltage, config.rated_current].map(|rated| 1.0 / (3.0 * rated))
}

/// Not `max`, which has to care for NaN: neither can be one here.
#[inline(always)]
pub(crate) fn higher(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Quality {
    Good,
    Missing,
    Invalid,
}

#[inline(always)]
fn hold_last(held: &mut Abc, value: Option<Abc>) -> (Abc, Quality) {
    let (admitted, quality) = match value {
        None => (Abc::default(), Quality::Missing),
        // NaN and infinity fail the comparison too.
        Some(x) if x.a.abs() < LARGEST && x.b.abs() < LARGEST && x.c.abs() < LARGEST => {
            (x, Quality::Good)
        }
        Some(_) => (*held, Quality::Invalid),
    };
    *held = admitted;
    (admitted, quality)
}

/// No motor that this monitor is for carries more than this, V or A; squares stay far from overflow.
const LARGEST: f32 = 1e6;

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(u: f32, i: f32) -> Sample {
        Sample {
            u_s_abc: Some(Abc::splat(u)),
            i_s_abc: Some(Abc::splat(i)),
            ..Sample::default()
        }
    }

    #[test]
    fn a_bad_number_is_replaced_by_its_predecessor_and_counted() {
        let mut state = IntakeState::default();
        state.admit(&sample(10.0, 1.0));
        for bad in [f32::NAN, f32::INFINITY, 1e30] {
            let admitted = state.admit(&sample(bad, 2.0));
            assert_eq!(admitted.u_s_abc, Abc::splat(10.0));
            assert_eq!(admitted.i_s_abc, Abc::splat(2.0));
        }
        let tally = state.close_cycle();
        assert_eq!((tally.invalid, tally.samples), (3, 4));
        assert_eq!(tally.measured(), [true, true]);
    }

    #[test]
    fn a_missing_channel_is_missing_not_zero() {
        let mut state = IntakeState::default();
        let only_currents = Sample {
            u_s_abc: None,
            ..sample(0.0, 3.0)
        };
        state.admit(&only_currents);
        assert_eq!(state.close_cycle().measured(), [false, true]);
    }

    #[test]
    fn torque_is_averaged_only_when_complete() {
        let mut state = IntakeState::default();
        for tau in [1.0, 3.0] {
            let with_torque = Sample {
                tau_load: Some(tau),
                ..sample(1.0, 1.0)
            };
            state.admit(&with_torque);
        }
        assert_eq!(state.close_cycle().tau_load(), Some(2.0));
        state.admit(&sample(1.0, 1.0));
        assert_eq!(state.close_cycle().tau_load(), None);
    }
}
