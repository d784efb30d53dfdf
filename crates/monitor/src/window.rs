//! The last few cycles seen as one coherent measurement, and how much they changed.

mod rates;

pub use rates::{RateNoise, Rates};

use core::f32::consts::{PI, TAU};

use num_complex::Complex32;

use crate::input::chain::AnalogueChain;
use crate::input::sample::{CHANNELS, ClippedChannels};
use crate::input::torque::TorqueReading;
use crate::noise::trend::Trend;
use crate::sync::encoder::SpeedReading;
use crate::sync::phasor::{ChannelCycle, CyclePhasors};
use frames::{Sequence, magnitude};
use pll::arcsine;

/// Longest window, in supply cycles.
pub const MAX_WINDOW_CYCLES: usize = 10;

/// What one supply cycle left behind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Phasors, offsets and mean squares of the six channels.
    pub phasors: CyclePhasors,
    /// Shaft speed over the cycle.
    pub speed: SpeedReading,
    /// Brake torque over the cycle.
    pub torque: TorqueReading,
    /// Channels that touched a rail.
    pub clipped: ClippedChannels,
    /// Samples that were not finite numbers and were replaced by their predecessor.
    pub invalid_samples: u16,
}

impl Cycle {
    /// Whether the field turns backwards.
    fn is_backwards(&self) -> bool {
        turn_backwards(&self.phases())
    }

    /// Phasors of the voltages and of the currents.
    fn phases(&self) -> [[Complex32; 3]; 2] {
        phases_of(&self.phasors.channels)
    }

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

    /// The cycle at the motor's terminals, of what a chain showed at the supply frequency `omega`, rad/s.
    #[must_use]
    pub fn ahead_of(mut self, chain: &AnalogueChain, omega: f32) -> Self {
        let channels = self.phasors.channels.iter_mut();
        for (channel, factor) in channels.zip(chain.undone(omega)) {
            channel.phasor *= factor;
            channel.mean_square *= factor.norm_sqr();
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
///
/// A motor whose field turns backwards is its own mirror image with phases b and c exchanged and shaft and load turning the
/// other way. So everything but `channels` stands here as the mirror shows it: the sequence that carries the motor is the
/// positive one, and a speed is positive that follows the field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Window {
    /// Phasors, offsets and mean squares: voltages a, b, c, then currents a, b, c.
    pub channels: [ChannelCycle; CHANNELS],
    /// The field turns backwards, phases a, c, b: see [`Window`].
    pub backwards: bool,
    /// The field changed its direction within the window.
    pub reverses: bool,
    /// Symmetrical components of the voltages, V.
    pub u_s: Sequence,
    /// Symmetrical components of the currents, A.
    pub i_s: Sequence,
    /// Supply frequency, rad/s.
    pub omega_sync: f32,
    /// Mean mechanical speed with the field, rad/s; see [`Window::shaft_speed`].
    pub omega_mech: Option<f32>,
    /// Mean brake torque against the field, N m.
    pub tau_load: Option<f32>,
    /// How fast voltage, current and speed change.
    pub rates: Rates,
    /// Farthest that the current of a cycle, seen from the voltage, lies off a straight line through the window, A.
    pub current_bend: f32,
    /// The same of the mechanical speed, rad/s.
    pub speed_bend: f32,
    /// Standard deviation of the speed of a cycle by the scatter of its samples, rad/s.
    pub speed_noise: f32,
    /// The same of the brake torque by the noise from sample to sample, N m.
    pub tau_noise: f32,
    /// Time between the middles of the first and the last cycle, s.
    pub span: f32,
    /// How much longer the oscillator's turns are than the supply's, a share, while it follows a frequency that changes.
    pub turn_error: f32,
    /// Channels that touched a rail anywhere in the window.
    pub clipped: ClippedChannels,
    /// Samples replaced because they were not finite.
    pub invalid_samples: u16,
    /// Encoder counts left out as too fast.
    pub glitches: u16,
    /// The speed sensor gave no edge in any cycle.
    pub encoder_silent: bool,
}

/// Standard deviations of what single cycles show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleNoise {
    /// Of the voltage vector, V.
    pub voltage: f32,
    /// Of the current vector, A.
    pub current: f32,
    /// Of the mechanical speed, rad/s.
    pub speed: f32,
    /// Of the brake torque, N m; 0 where it is not measured.
    pub torque: f32,
}

impl Window {
    /// Mean mechanical speed as the sensor shows it, rad/s: negative backwards, whatever the field does.
    pub fn shaft_speed(&self) -> Option<f32> {
        self.omega_mech.map(|omega| self.as_turned(omega))
    }

    /// Mean brake torque as the sensor shows it, N m: it has the sign of the speed that it brakes.
    pub fn shaft_torque(&self) -> Option<f32> {
        self.tau_load.map(|tau| self.as_turned(tau))
    }

    fn as_turned(&self, with_field: f32) -> f32 {
        if self.backwards {
            -with_field
        } else {
            with_field
        }
    }

    /// What the samples beside their fundamentals do to the vectors of single cycles. Harmonics and ripple count as noise:
    /// an upper limit.
    pub fn cycle_noise(&self, t_sample: f32) -> CycleNoise {
        let beside = |channel: &ChannelCycle| {
            channel.mean_square - channel.offset * channel.offset - 0.5 * channel.phasor.norm_sqr()
        };
        let share = self.noise_share(t_sample);
        let of = |first: usize| {
            let three = self.channels.iter().skip(first).take(3);
            let mean = three.map(beside).sum::<f32>() / 3.0;
            processor::sqrtf(mean.max(0.0) * share)
        };
        CycleNoise {
            voltage: of(0),
            current: of(3),
            speed: self.speed_noise,
            torque: self.tau_noise,
        }
    }

    /// What a cycle's vector takes of the variance of its samples: two parts of a phasor, each of variance `2 s^2/n`, of the
    /// mean of three phases; `n` samples in a turn.
    fn noise_share(&self, t_sample: f32) -> f32 {
        4.0 * self.omega_sync * t_sample / (3.0 * TAU)
    }

    /// What harmonics and ripple do to a window whose cycles are no turns of the supply, over what they would do to a cycle
    /// as white noise: the share of their amplitude, of any order, by which the cycles are too long or too short.
    pub fn leakage(&self, t_sample: f32) -> f32 {
        self.turn_error.abs() / processor::sqrtf(self.noise_share(t_sample))
    }

    /// A ratio of negative or zero over positive sequence as the channels a, b, c show it: in the mirror the unbalance
    /// that a real change of one channel makes is the conjugate of what it is forwards.
    pub fn in_channels(&self, ratio: Complex32) -> Complex32 {
        if self.backwards { ratio.conj() } else { ratio }
    }

    /// What `length` cycles would have shown had the oscillator's turns been the supply's. Over `1 + e` turns the mean of
    /// `2 Re(X e^{j (1 + e) theta}) e^{-j theta}` is `X` and `e/2` of its conjugate, to first order in `e`: in a phase's phasor
    /// that looks like an unbalance, as the conjugate of a positive sequence is a negative one. And cycles that turn by
    /// `2 pi e` from one to the next have a mean that is shorter by `(pi e length)^2/6`.
    fn count_whole_turns(&mut self, length: usize) {
        let share = 0.5 * self.turn_error;
        let turned = PI * self.turn_error * length as f32;
        let gain = 1.0 + turned * turned / 6.0;
        for ChannelCycle { phasor, .. } in &mut self.channels {
            *phasor = (*phasor - phasor.conj() * share) * gain;
        }
    }

    /// What follows from the channels of `length` cycles, in the mirror where the field turns backwards.
    #[inline]
    fn finish(&mut self, length: usize) {
        self.count_whole_turns(length);
        let phases = phases_of(&self.channels);
        self.backwards = turn_backwards(&phases);
        [self.u_s, self.i_s] = phases.map(|phases| components(phases, self.backwards));
        self.mirror();
    }

    /// The mirror image of a motor whose field turns backwards, in everything but the channels.
    fn mirror(&mut self) {
        if self.backwards {
            self.omega_mech = self.omega_mech.map(|omega| -omega);
            self.tau_load = self.tau_load.map(|tau| -tau);
            self.rates.speed = -self.rates.speed;
        }
    }
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

    /// Mean current of the two latest cycles, seen from their voltages, A, and the latest one's length, samples. Half the
    /// supply's frequency cancels in it, where once a turn of four poles nearly lies.
    pub fn latest_current(&self) -> Option<(Complex32, f32)> {
        let mut latest = self.latest(2)?;
        let (newest, before) = (latest.next()?, latest.next()?);
        let mean = (Turned::of(newest).current + Turned::of(before).current) * 0.5;
        Some((mean, newest.phasors.samples))
    }

    /// The window over the latest `length` cycles; `None` until there are that many.
    pub fn measure(&self, length: usize, t_sample: f32) -> Option<Window> {
        let length = length.clamp(2, MAX_WINDOW_CYCLES);
        let cycles = self.latest(length)?;
        let mut window = mean(cycles.clone(), length);
        let mut turned = [Turned::default(); MAX_WINDOW_CYCLES];
        for (turned, cycle) in turned.iter_mut().zip(cycles) {
            *turned = Turned::of(cycle);
        }
        window.follow(turned.get(..length)?, t_sample)?;
        window.finish(length);
        Some(window)
    }

    /// The cycle that came `age` cycles before the newest, as if it were a whole window like `like` without any change.
    pub fn single(&self, age: usize, like: &Window) -> Option<Window> {
        let mut cycle = mean(self.latest(age + 1)?.skip(age), 1);
        cycle.omega_sync = like.omega_sync;
        cycle.turn_error = like.turn_error;
        cycle.finish(1);
        (cycle.backwards == like.backwards).then_some(cycle)
    }
}

/// What the field's sequence shows of a cycle.
#[derive(Clone, Copy, Default)]
struct Turned {
    /// Voltage, or the current where voltages are not measured: what the frequency is told by.
    reference: Complex32,
    /// Length of the voltage, V.
    voltage: f32,
    /// The current as the voltage sees it, A.
    current: Complex32,
    /// Speed over the cycle, rad/s.
    speed: f32,
    /// Length, samples.
    samples: f32,
    /// See [`CyclePhasors::missing`].
    missing: f32,
}

impl Turned {
    fn of(cycle: &Cycle) -> Self {
        let (u, i) = positive(cycle);
        let voltage = magnitude(u);
        Turned {
            reference: if u.norm_sqr() > 0.0 { u } else { i },
            voltage,
            current: seen_from(u, voltage, i),
            speed: cycle.speed.omega_mech.unwrap_or_default(),
            samples: cycle.phasors.samples,
            missing: cycle.phasors.missing,
        }
    }

    /// How far the supply turned from the middle of this cycle to the middle of one that came `turns` later, rad.
    fn advance(&self, later: &Turned, turns: usize) -> f32 {
        let advance = phase_advance(self.reference, later.reference);
        TAU * turns as f32 - 0.5 * self.missing + advance
    }
}

impl Window {
    /// Frequency and rates of the cycles of a window, the newest first; `None` without any.
    fn follow(&mut self, cycles: &[Turned], t_sample: f32) -> Option<()> {
        let (newest, oldest) = (cycles.first()?, cycles.last()?);
        let length = cycles.len();
        let all: f32 = cycles.iter().map(|cycle| cycle.samples).sum();
        self.span = (all - 0.5 * (newest.samples + oldest.samples)) * t_sample;
        self.omega_sync = oldest.advance(newest, length - 1) / self.span;
        let missing: f32 = cycles.iter().map(|cycle| cycle.missing).sum();
        let turned = TAU * length as f32 - missing;
        self.turn_error = self.omega_sync * all * t_sample / turned - 1.0;
        let per_second = (length - 1) as f32 / self.span;
        let real = |x: f32| Complex32::new(x, 0.0);
        let voltages = cycles.iter().map(|cycle| real(cycle.voltage));
        self.rates.voltage = Trend::of(voltages, length).slope.re * per_second;
        let currents = Trend::of(cycles.iter().map(|cycle| cycle.current), length);
        self.rates.current = currents.slope * per_second;
        self.current_bend = currents.bend;
        self.rates.supply = supply_rate(cycles, t_sample) * per_second;
        if self.omega_mech.is_some() {
            let speeds = Trend::of(cycles.iter().map(|cycle| real(cycle.speed)), length);
            self.rates.speed = speeds.slope.re * per_second;
            self.speed_bend = speeds.bend;
        }
        Some(())
    }
}

/// Change of the supply's frequency from a cycle to the next, rad/s: frequencies stand between two cycles each.
fn supply_rate(cycles: &[Turned], t_sample: f32) -> f32 {
    let mut frequencies = [Complex32::ZERO; MAX_WINDOW_CYCLES];
    let pairs = cycles.iter().zip(cycles.iter().skip(1));
    for (frequency, (newer, older)) in frequencies.iter_mut().zip(pairs) {
        let seconds = 0.5 * (older.samples + newer.samples) * t_sample;
        frequency.re = older.advance(newer, 1) / seconds;
    }
    let count = cycles.len().saturating_sub(1);
    // One frequency is no change.
    if count < 2 {
        return 0.0;
    }
    Trend::of(frequencies.iter().take(count).copied(), count)
        .slope
        .re
}

fn mean<'a>(cycles: impl Iterator<Item = &'a Cycle> + Clone, length: usize) -> Window {
    let mut window = Window {
        encoder_silent: cycles.clone().all(|cycle| cycle.speed.silent),
        omega_mech: mean_of(cycles.clone(), |cycle| cycle.speed.omega_mech),
        tau_load: mean_of(cycles.clone(), |cycle| cycle.torque.mean),
        reverses: reverses(cycles.clone()),
        ..Window::default()
    };
    let share = 1.0 / length as f32;
    for cycle in cycles {
        for (sum, channel) in window.channels.iter_mut().zip(&cycle.phasors.channels) {
            sum.phasor += channel.phasor * share;
            sum.offset += channel.offset * share;
            sum.mean_square += channel.mean_square * share;
        }
        window.speed_noise = window.speed_noise.max(cycle.speed.noise);
        window.tau_noise = window.tau_noise.max(cycle.torque.noise);
        window.clipped = window.clipped.union(cycle.clipped);
        window.invalid_samples = window.invalid_samples.saturating_add(cycle.invalid_samples);
        window.glitches = window.glitches.saturating_add(cycle.speed.glitches);
    }
    window
}

fn reverses<'a>(mut cycles: impl Iterator<Item = &'a Cycle>) -> bool {
    let newest = cycles.next().is_some_and(Cycle::is_backwards);
    cycles.any(|cycle| cycle.is_backwards() != newest)
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

fn phases_of(channels: &[ChannelCycle; CHANNELS]) -> [[Complex32; 3]; 2] {
    let [ua, ub, uc, ia, ib, ic] = channels;
    [
        [ua.phasor, ub.phasor, uc.phasor],
        [ia.phasor, ib.phasor, ic.phasor],
    ]
}

/// Whether the field turns backwards: by the voltages or, where they are not measured, by the currents.
fn turn_backwards([u, i]: &[[Complex32; 3]; 2]) -> bool {
    let measured = u.iter().any(|x| x.norm_sqr() > 0.0);
    Sequence::is_backwards(if measured { *u } else { *i })
}

/// Symmetrical components as the mirror shows them where the field turns backwards.
fn components(phases: [Complex32; 3], backwards: bool) -> Sequence {
    Sequence::from_phases(if backwards {
        Sequence::mirrored(phases)
    } else {
        phases
    })
}

/// A current as a voltage of this length sees it; its length alone without a voltage.
fn seen_from(u: Complex32, length: f32, i: Complex32) -> Complex32 {
    if length > 0.0 {
        i * u.conj() / length
    } else {
        Complex32::new(magnitude(i), 0.0)
    }
}

/// How far the supply turned beyond the oscillator from one cycle to a later one, rad.
fn phase_advance(first: Complex32, last: Complex32) -> f32 {
    let square = first.norm_sqr();
    if square <= f32::MIN_POSITIVE {
        return 0.0;
    }
    arcsine((last * first.conj()).im / square)
}

/// The sequences of voltages and currents that carry the motor.
fn positive(cycle: &Cycle) -> (Complex32, Complex32) {
    let phases = cycle.phases();
    let backwards = turn_backwards(&phases);
    let [u, i] = phases.map(|phases| components(phases, backwards).positive);
    (u, i)
}

#[cfg(test)]
mod tests;
