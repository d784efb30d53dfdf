//! The last few cycles seen as one coherent measurement, and how much they changed.

use core::f32::consts::TAU;

use num_complex::Complex32;

use crate::encoder::SpeedReading;
use crate::frames::{Sequence, magnitude};
use crate::phasor::{CHANNELS, ChannelCycle, CyclePhasors};
use crate::sample::ClippedChannels;

/// Longest window, in supply cycles.
pub const MAX_WINDOW_CYCLES: usize = 10;

/// What one supply cycle left behind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Phasors, offsets and mean squares of the six channels.
    pub phasors: CyclePhasors,
    /// Shaft speed over the cycle.
    pub speed: SpeedReading,
    /// Mean brake torque over the cycle, N m, where a torque channel exists.
    pub tau_load: Option<f32>,
    /// Channels that touched a rail.
    pub clipped: ClippedChannels,
    /// Samples that were not finite numbers and were replaced by their predecessor.
    pub invalid_samples: u16,
}

impl Cycle {
    /// The cycle with a gain on each channel: voltages a, b, c, then currents a, b, c.
    #[must_use]
    pub fn corrected(mut self, gains: &[f32; CHANNELS]) -> Self {
        for (channel, &gain) in self.phasors.channels.iter_mut().zip(gains) {
            channel.phasor *= gain;
            channel.offset *= gain;
            channel.mean_square *= gain * gain;
        }
        self
    }
}

/// Ring of the latest cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowState {
    cycles: [Cycle; MAX_WINDOW_CYCLES],
    /// Where the newest lies; older ones follow, around the end.
    newest: usize,
    filled: usize,
}

impl Default for WindowState {
    fn default() -> Self {
        WindowState {
            cycles: [Cycle::default(); MAX_WINDOW_CYCLES],
            newest: 0,
            filled: 0,
        }
    }
}

/// Mean of the cycles of a window. Voltages and currents are space vectors seen from the oscillator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Window {
    /// Phasors, offsets and mean squares: voltages a, b, c, then currents a, b, c.
    pub channels: [ChannelCycle; CHANNELS],
    /// Symmetrical components of the voltages, V.
    pub u_s: Sequence,
    /// Symmetrical components of the currents, A.
    pub i_s: Sequence,
    /// Supply frequency, rad/s.
    pub omega_sync: f32,
    /// Mean mechanical speed, rad/s.
    pub omega_mech: Option<f32>,
    /// Mean brake torque, N m.
    pub tau_load: Option<f32>,
    /// Change of the current, seen from the voltage, from the first to the last cycle, A; an excursion in between
    /// counts with its share of the window.
    pub current_change: f32,
    /// Change of the mechanical speed from the first to the last cycle, rad/s.
    pub speed_change: f32,
    /// Time between the middles of the first and the last cycle, s.
    pub span: f32,
    /// Channels that touched a rail anywhere in the window.
    pub clipped: ClippedChannels,
    /// Samples replaced because they were not finite.
    pub invalid_samples: u16,
    /// Encoder counts left out as too fast.
    pub glitches: u16,
    /// The speed sensor gave no edge in any cycle.
    pub encoder_silent: bool,
}

impl WindowState {
    /// Adds the latest cycle, keeping at most `length` (2..=[`MAX_WINDOW_CYCLES`]) of them.
    pub fn push(&mut self, cycle: Cycle, length: usize) {
        self.newest = self.newest.checked_sub(1).unwrap_or(MAX_WINDOW_CYCLES - 1);
        if let Some(newest) = self.cycles.get_mut(self.newest) {
            *newest = cycle;
        }
        self.filled = (self.filled + 1).min(length.clamp(2, MAX_WINDOW_CYCLES));
    }

    /// Forgets all cycles: the oscillator was restarted.
    pub fn clear(&mut self) {
        self.filled = 0;
    }

    /// The latest `length` cycles, newest first; `None` until there are that many.
    fn latest(&self, length: usize) -> Option<impl Iterator<Item = &Cycle> + Clone> {
        let (wrapped, straight) = self.cycles.split_at_checked(self.newest)?;
        let latest = straight.iter().chain(wrapped).take(length);
        (self.filled >= length).then_some(latest)
    }

    /// The window over the latest `length` cycles; `None` until there are that many.
    pub fn measure(&self, length: usize, t_sample: f32) -> Option<Window> {
        let length = length.clamp(2, MAX_WINDOW_CYCLES);
        let cycles = self.latest(length)?;
        let (newest, oldest) = (cycles.clone().next()?, cycles.clone().last()?);
        let mut window = mean(cycles.clone(), length);
        let all: f32 = cycles.clone().map(|cycle| cycle.phasors.samples).sum();
        let span = all - 0.5 * (newest.phasors.samples + oldest.phasors.samples);
        window.span = span * t_sample;
        window.omega_sync =
            (TAU * (length - 1) as f32 + phase_advance(oldest, newest)) / window.span;
        window.current_change = current_change(cycles, length, oldest, newest);
        if let (Some(first), Some(last)) = (oldest.speed.omega_mech, newest.speed.omega_mech) {
            window.speed_change = last - first;
        }
        Some(window)
    }
}

/// From the first cycle to the last, or what an excursion in between adds to the window's mean, whichever is larger.
fn current_change<'a>(
    cycles: impl Iterator<Item = &'a Cycle>,
    length: usize,
    oldest: &Cycle,
    newest: &Cycle,
) -> f32 {
    let start = seen_from_voltage(oldest);
    let square = |cycle: &Cycle| (seen_from_voltage(cycle) - start).norm_sqr();
    let largest = libm::sqrtf(cycles.map(square).fold(0.0, f32::max));
    libm::sqrtf(square(newest)).max(largest / length as f32)
}

fn mean<'a>(cycles: impl Iterator<Item = &'a Cycle> + Clone, length: usize) -> Window {
    let mut window = Window {
        encoder_silent: cycles.clone().all(|cycle| cycle.speed.silent),
        omega_mech: mean_of(cycles.clone(), |cycle| cycle.speed.omega_mech),
        tau_load: mean_of(cycles.clone(), |cycle| cycle.tau_load),
        ..Window::default()
    };
    let share = 1.0 / length as f32;
    for cycle in cycles {
        for (sum, channel) in window.channels.iter_mut().zip(&cycle.phasors.channels) {
            sum.phasor += channel.phasor * share;
            sum.offset += channel.offset * share;
            sum.mean_square += channel.mean_square * share;
        }
        window.clipped = window.clipped.union(cycle.clipped);
        window.invalid_samples = window.invalid_samples.saturating_add(cycle.invalid_samples);
        window.glitches = window.glitches.saturating_add(cycle.speed.glitches);
    }
    (window.u_s, window.i_s) = sequences(&window.channels);
    window
}

/// Mean weighted by cycle length; `None` as soon as one cycle has no value.
fn mean_of<'a>(
    cycles: impl Iterator<Item = &'a Cycle>,
    value: impl Fn(&Cycle) -> Option<f32>,
) -> Option<f32> {
    let (mut sum, mut weight) = (0.0, 0.0);
    for cycle in cycles {
        sum += cycle.phasors.samples * value(cycle)?;
        weight += cycle.phasors.samples;
    }
    (weight > 0.0).then(|| sum / weight)
}

fn sequences(channels: &[ChannelCycle; CHANNELS]) -> (Sequence, Sequence) {
    let [ua, ub, uc, ia, ib, ic] = channels;
    (
        Sequence::from_phases([ua.phasor, ub.phasor, uc.phasor]),
        Sequence::from_phases([ia.phasor, ib.phasor, ic.phasor]),
    )
}

/// How far the supply turned beyond the oscillator from one cycle to a later one, rad.
fn phase_advance(from: &Cycle, to: &Cycle) -> f32 {
    let (first, last) = (reference(from), reference(to));
    let square = first.norm_sqr();
    if square <= f32::MIN_POSITIVE {
        return 0.0;
    }
    let sine = ((last * first.conj()).im / square).clamp(-0.5, 0.5);
    // arcsine to fifth order: 1e-4 rad at the clamp, exact to rounding below 0.1 rad.
    sine * (1.0 + sine * sine * (1.0 / 6.0 + sine * sine * 3.0 / 40.0))
}

/// Positive sequences of voltages and currents.
fn positive(cycle: &Cycle) -> (Complex32, Complex32) {
    let [ua, ub, uc, ia, ib, ic] = &cycle.phasors.channels;
    (
        Sequence::positive_of([ua.phasor, ub.phasor, uc.phasor]),
        Sequence::positive_of([ia.phasor, ib.phasor, ic.phasor]),
    )
}

/// Positive-sequence voltage, or the current where voltages are not measured.
fn reference(cycle: &Cycle) -> Complex32 {
    let (u, i) = positive(cycle);
    if u.norm_sqr() > 0.0 { u } else { i }
}

fn seen_from_voltage(cycle: &Cycle) -> Complex32 {
    let (u, i) = positive(cycle);
    let length = magnitude(u);
    if length > 0.0 {
        i * u.conj() / length
    } else {
        Complex32::new(magnitude(i), 0.0)
    }
}
