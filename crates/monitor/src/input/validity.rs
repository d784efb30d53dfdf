//! The door of the core: bad numbers are kept out, missing and clipped channels are noted.

use core::f32::consts::TAU;

use crate::input::sample::{ClippedChannels, Sample};
use crate::input::torque::{TorqueReading, TorqueTally};
use frames::Abc;
use processor::higher;

/// Corner of the low pass before the supply's crossings are looked for, Hz: it leaves a tenth of an inverter's ripple at 2 kHz,
/// which may be half as high as the fundamental.
const CORNER_HZ: f32 = 200.0;
/// Share of rated voltage (current, where voltages are missing) that counts as a supply.
pub(crate) const LEAST_REFERENCE: f32 = 0.05;

/// What has come in since the last cycle ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IntakeState {
    held_voltages: Abc,
    held_currents: Abc,
    /// Instants since voltages or currents last changed by a bit.
    still: u32,
    /// Peaks of voltage and current as shares of their rated values, which decay slowly.
    peaks: [f32; 2],
    /// What the supply is found by, without ripple.
    smooth: f32,
    tally: Tally,
}

/// How the supply is looked for from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceFilter {
    /// What a peak keeps of itself.
    keep: f32,
    /// What the low pass takes of the new sample.
    share: f32,
}

impl ReferenceFilter {
    /// For samples `t_sample` seconds apart.
    pub fn new(t_sample: f32) -> Self {
        let per_corner = TAU * CORNER_HZ * t_sample;
        ReferenceFilter {
            keep: 1.0 - pll::PEAK_DECAY_PER_SECOND * t_sample,
            share: per_corner / (1.0 + per_corner),
        }
    }
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
    torque: TorqueTally,
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

    /// Brake torque over the cycle, when every sample carried one.
    pub fn torque(&self) -> TorqueReading {
        self.torque.close(self.samples)
    }
}

impl IntakeState {
    /// Takes one sample; whatever is not finite is replaced by its predecessor and counted.
    #[inline(always)]
    pub fn admit(&mut self, sample: &Sample) -> Admitted {
        let tally = &mut self.tally;
        tally.samples = tally.samples.saturating_add(1);
        tally.clipped = tally.clipped.union(sample.clipped);
        let before = (self.held_voltages, self.held_currents);
        let (u_s_abc, voltages) = hold_last(&mut self.held_voltages, sample.u_s_abc);
        let (i_s_abc, currents) = hold_last(&mut self.held_currents, sample.i_s_abc);
        for (count, quality) in tally.present.iter_mut().zip([voltages, currents]) {
            *count = count.saturating_add(u16::from(quality != Quality::Missing));
        }
        let torque = sample.tau_load.filter(|tau| tau.abs() < LARGEST);
        let torque_bad = sample.tau_load.is_some() && torque.is_none();
        let bad = voltages == Quality::Invalid || currents == Quality::Invalid || torque_bad;
        tally.invalid = tally.invalid.saturating_add(u16::from(bad));
        if let Some(tau) = torque {
            tally.torque.add(tau);
        }
        let repeats = before == (u_s_abc, i_s_abc);
        self.still = if repeats {
            self.still.saturating_add(1)
        } else {
            0
        };
        Admitted { u_s_abc, i_s_abc }
    }

    /// Whether all channels have repeated their values for so many instants, and these are not those of a motor at rest:
    /// the recorder stands still. Shares are of rated voltage and current.
    pub fn is_frozen(&self, instants: u32, [rated_voltage, rated_current]: [f32; 2]) -> bool {
        let beyond = |x: Abc, rated: f32| {
            let least = LEAST_REFERENCE * rated;
            x.a.abs() > least || x.b.abs() > least || x.c.abs() > least
        };
        self.still >= instants
            && (beyond(self.held_voltages, rated_voltage)
                || beyond(self.held_currents, rated_current))
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
    /// Smoothed: it comes a little late, by the same angle in every turn.
    #[inline(always)]
    pub fn reference(&mut self, [u, i]: [f32; 2], filter: &ReferenceFilter) -> f32 {
        let [u_peak, i_peak] = &mut self.peaks;
        *u_peak = higher(*u_peak * filter.keep, u.abs());
        *i_peak = higher(*i_peak * filter.keep, i.abs());
        let picked = if *u_peak < LEAST_REFERENCE && *i_peak > LEAST_REFERENCE {
            i
        } else {
            u
        };
        self.smooth += filter.share * (picked - self.smooth);
        self.smooth
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
pub(crate) fn reference_scales(rated: [f32; 2]) -> [f32; 2] {
    rated.map(|rated| 1.0 / (3.0 * rated))
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

/// No motor that this monitor is for carries more than this, V, A or N m; squares and sums stay far from overflow.
const LARGEST: f32 = 1e6;

#[cfg(test)]
mod tests {
    use super::*;
    use pll::{SyncConfig, SyncState};

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
        assert_eq!(state.close_cycle().torque().mean, Some(2.0));
        state.admit(&sample(1.0, 1.0));
        assert_eq!(state.close_cycle().torque().mean, None);
    }

    #[test]
    fn more_than_half_of_the_samples_make_a_measurement() {
        for (present, measured) in [(2, false), (3, true)] {
            let mut state = IntakeState::default();
            for k in 0..4 {
                let mut sample = sample(1.0, 1.0);
                if k >= present {
                    sample.i_s_abc = None;
                }
                state.admit(&sample);
            }
            assert_eq!(state.close_cycle().measured(), [true, measured]);
        }
    }

    #[test]
    fn each_phase_alone_can_spoil_a_sample() {
        for phase in 0..3 {
            let mut state = IntakeState::default();
            state.admit(&sample(7.0, 1.0));
            let mut values = [2.0; 3];
            values[phase] = -2.0 * LARGEST;
            let bad = Sample {
                u_s_abc: Some(Abc::from_array(values)),
                ..sample(0.0, 1.0)
            };
            assert_eq!(state.admit(&bad).u_s_abc, Abc::splat(7.0), "phase {phase}");
        }
    }

    #[test]
    fn a_torque_that_is_no_number_is_counted_and_spoils_the_mean() {
        let mut state = IntakeState::default();
        let with = |tau| Sample {
            tau_load: Some(tau),
            ..sample(1.0, 1.0)
        };
        // The sum of two of the largest finite numbers is infinite.
        for bad in [f32::NAN, f32::NEG_INFINITY, f32::MAX] {
            state.admit(&with(1.0));
            state.admit(&with(bad));
            let tally = state.close_cycle();
            assert_eq!((tally.invalid, tally.torque().mean), (1, None), "{bad}");
        }
    }

    #[test]
    fn clipped_channels_are_gathered_over_the_cycle() {
        let mut state = IntakeState::default();
        for phase in [0, 2] {
            let mut sample = sample(1.0, 1.0);
            sample.clipped.mark_voltage(phase);
            state.admit(&sample);
        }
        let mut converter = ClippedChannels::NONE;
        converter.mark_current(1);
        state.admit_codes(5, converter);
        let tally = state.close_cycle();
        assert!(tally.clipped.voltage(0) && tally.clipped.voltage(2) && tally.clipped.current(1));
        assert!(!tally.clipped.voltage(1));
        assert_eq!((tally.samples, tally.present), (7, [7, 7]));
    }

    /// The supply is found by the voltage; by the current only where there is no voltage.
    #[test]
    fn the_current_stands_in_for_a_missing_voltage() {
        let filter = ReferenceFilter {
            keep: 0.5,
            share: 1.0,
        };
        let mut state = IntakeState::default();
        assert!(state.is_dark());
        assert_eq!(state.reference([1.0, 0.8], &filter), 1.0);
        assert!((state.reference([-0.2, 0.8], &filter) + 0.2).abs() < 1e-6);
        assert!(!state.is_dark());
        // 1, 0.5, 0.25, ...: after five samples the peak is below a twentieth.
        let picked: Vec<f32> = (0..5)
            .map(|_| state.reference([0.0, -0.6], &filter))
            .collect();
        assert_eq!(picked, [0.0, 0.0, 0.0, -0.6, -0.6]);
        assert!(!state.is_dark(), "current flows");
        for _ in 0..5 {
            state.reference([0.0, 0.0], &filter);
        }
        assert!(state.is_dark());
    }

    /// Behind an inverter with a carrier of 2 kHz, whose ripple is half as high as the fundamental.
    #[test]
    fn a_supply_is_found_under_ripple() {
        let t_sample = 1e-4;
        let sync = SyncConfig {
            t_sample,
            omega_min: TAU * 4.5,
            omega_max: TAU * 110.0,
            min_amplitude: LEAST_REFERENCE,
        };
        let filter = ReferenceFilter::new(t_sample);
        let mut intake = IntakeState::default();
        let [mut raw, mut smooth] = [SyncState::default(); 2];
        let [mut raw_locks, mut smooth_locks] = [0; 2];
        for k in 0..4000_u16 {
            let t = f64::from(k) * 1e-4;
            let turn = |hertz: f64| (core::f64::consts::TAU * hertz * t + 1.0).sin();
            let x = (turn(50.0) + 0.5 * turn(2008.0)) as f32;
            sync.update(&mut raw, x);
            sync.update(&mut smooth, intake.reference([x, 0.0], &filter));
            raw_locks += u16::from(raw.is_locked());
            smooth_locks += u16::from(smooth.is_locked());
        }
        assert_eq!(raw_locks, 0);
        assert!(smooth_locks > 3000, "{smooth_locks}");
        assert!(
            (smooth.omega() / (TAU * 50.0) - 1.0).abs() < 0.01,
            "{}",
            smooth.omega()
        );
    }

    #[test]
    fn the_reference_is_alpha_as_a_share_of_rated() {
        let x = Abc {
            a: 5.0,
            b: 1.0,
            c: -2.0,
        };
        let alpha = frames::AlphaBeta::from(x).alpha;
        assert!((reference_of(x) / 3.0 - alpha).abs() < 1e-6);
        assert_eq!(
            reference_of(Abc::splat(7.0)),
            0.0,
            "a zero sequence drops out"
        );
    }
}
