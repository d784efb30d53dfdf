//! Phasors of one supply cycle: weighted least squares of offset and fundamental for six channels.
//!
//! Least squares instead of a plain sum because a cycle is not a whole number of samples: offset
//! and fundamental are then separated exactly, wherever the cycle is cut. The sample in which the
//! cycle ends is shared between the two cycles by weight, which keeps harmonics out to second order.

use num_complex::Complex32;

use crate::input::sample::CHANNELS;
use pll::{SyncTick, arcsine};

/// Running sums over one cycle, in V and A or in whatever [`Unit`] says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhasorState {
    /// See [`CyclePhasors::missing`].
    missing: f32,
    gram: Gram,
    channels: [Projection; CHANNELS],
}

/// What one channel was summed up in: `value = scale * x - offset`, V or A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// V or A per unit of `x`.
    pub scale: f32,
    /// V or A.
    pub offset: f32,
}

/// ADC codes as they are summed up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CodeRange {
    /// Code of 0 V and of 0 A, which is taken off.
    pub zero: [f32; 2],
    /// Lowest and highest code that are no rail.
    pub lowest: i32,
    /// See `lowest`.
    pub highest: i32,
}

impl Unit {
    /// Summed up in V and A.
    pub const SI: Unit = Unit {
        scale: 1.0,
        offset: 0.0,
    };
}

/// Weighted inner products of the three basis functions 1, cos, sin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Gram {
    /// Instants of weight 1, and the weights of the others: whole numbers do not round, however they are grouped.
    whole: u32,
    shared: f32,
    cos: f32,
    sin: f32,
    cos_cos: f32,
    cos_sin: f32,
}

/// Weighted inner products of one channel with the basis, and its square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Projection {
    one: f32,
    cos: f32,
    sin: f32,
    square: f32,
}

/// One channel over one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelCycle {
    /// Fundamental: the channel is `Re(phasor * axis)`, V or A, peak value.
    pub phasor: Complex32,
    /// Mean over the cycle, V or A.
    pub offset: f32,
    /// Mean square over the cycle, V2 or A2.
    pub mean_square: f32,
}

/// All channels over one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CyclePhasors {
    /// Voltages a, b, c, then currents a, b, c.
    pub channels: [ChannelCycle; CHANNELS],
    /// Length of the cycle in samples.
    pub samples: f32,
    /// Angle that the cycle lacks of a whole turn, rad: the oscillator is set to the supply's phase at a sample, up to one
    /// sample behind the crossing at which a turn begins.
    pub missing: f32,
}

impl PhasorState {
    /// Adds one instant; returns the finished cycle when the oscillator completes its turn.
    #[inline(always)]
    pub fn update(
        &mut self,
        tick: &SyncTick,
        x: &[f32; CHANNELS],
        units: &[Unit; CHANNELS],
    ) -> Option<CyclePhasors> {
        if tick.restarted {
            *self = PhasorState {
                missing: arcsine(tick.axis.im),
                ..PhasorState::default()
            };
        }
        match tick.turn_ends {
            Some(share) => self.turn(tick.axis, share, x, units),
            None => {
                self.gram.whole += 1;
                self.add(1.0, tick.axis, x);
                None
            }
        }
    }

    /// The instant in which a turn ends is shared by two of them.
    #[inline(never)]
    fn turn(
        &mut self,
        axis: Complex32,
        share: f32,
        x: &[f32; CHANNELS],
        units: &[Unit; CHANNELS],
    ) -> Option<CyclePhasors> {
        self.gram.shared += share;
        self.add(share, axis, x);
        let cycle = self.solve(units);
        *self = PhasorState::default();
        self.gram.shared = 1.0 - share;
        self.add(1.0 - share, axis, x);
        cycle
    }

    /// Adds instants inside a turn, in codes above the code of zero; tells whether none of them is at a rail, where it is to
    /// look for them.
    #[inline]
    pub fn add_codes<const LOOKS: bool>(
        &mut self,
        codes: &[[u16; CHANNELS]],
        axes: &[Complex32],
        range: &CodeRange,
    ) -> bool {
        self.gram.whole += codes.len().min(axes.len()) as u32;
        self.gram.add_axes(axes);
        let [v_a, v_b, v_c, i_a, i_b, i_c] = &mut self.channels;
        let voltages = add_phases::<0, LOOKS>([v_a, v_b, v_c], codes, axes, range);
        let currents = add_phases::<1, LOOKS>([i_a, i_b, i_c], codes, axes, range);
        voltages && currents
    }

    #[inline(always)]
    fn add(&mut self, weight: f32, axis: Complex32, x: &[f32; CHANNELS]) {
        let (cos, sin) = (weight * axis.re, weight * axis.im);
        self.gram.cos += cos;
        self.gram.sin += sin;
        self.gram.cos_cos += cos * axis.re;
        self.gram.cos_sin += cos * axis.im;
        for (channel, &x) in self.channels.iter_mut().zip(x) {
            channel.one += weight * x;
            channel.cos += cos * x;
            channel.sin += sin * x;
            channel.square += weight * x * x;
        }
    }

    fn solve(&self, units: &[Unit; CHANNELS]) -> Option<CyclePhasors> {
        let inverse = self.gram.invert()?;
        let samples = self.gram.one();
        let mut cycle = CyclePhasors {
            samples,
            missing: self.missing,
            ..CyclePhasors::default()
        };
        for ((result, sums), unit) in cycle.channels.iter_mut().zip(&self.channels).zip(units) {
            *result = inverse.apply(&sums.in_si(unit, &self.gram), samples);
        }
        Some(cycle)
    }
}

/// One quantity of the three phases over many instants; `QUANTITY` is 0 for voltages, 1 for currents. The sums of
/// three channels fit into the processor's registers, those of six do not.
#[inline(always)]
fn add_phases<const QUANTITY: usize, const LOOKS: bool>(
    mut channels: [&mut Projection; 3],
    codes: &[[u16; CHANNELS]],
    axes: &[Complex32],
    range: &CodeRange,
) -> bool {
    let zero = range.zero[QUANTITY];
    // Negative as soon as one code was outside: two subtractions instead of two branches.
    let mut inside = 0;
    let mut sums = channels.each_ref().map(|channel| **channel);
    for (codes, axis) in codes.iter().zip(axes) {
        let (phases, _) = codes.as_chunks::<2>();
        for (sums, phase) in sums.iter_mut().zip(phases) {
            let code = phase[QUANTITY];
            if LOOKS {
                inside |= (i32::from(code) - range.lowest) | (range.highest - i32::from(code));
            }
            let x = f32::from(code) - zero;
            sums.one += x;
            sums.cos += axis.re * x;
            sums.sin += axis.im * x;
            sums.square += x * x;
        }
    }
    for (channel, sums) in channels.iter_mut().zip(sums) {
        **channel = sums;
    }
    inside >= 0
}

impl Projection {
    /// The sums that `scale * x - offset` would have given.
    fn in_si(&self, unit: &Unit, gram: &Gram) -> Projection {
        let Unit { scale, offset } = *unit;
        let n = gram.one();
        Projection {
            one: scale * self.one - offset * n,
            cos: scale * self.cos - offset * gram.cos,
            sin: scale * self.sin - offset * gram.sin,
            square: scale * (scale * self.square - 2.0 * offset * self.one) + offset * offset * n,
        }
    }
}

/// Inverse of the symmetric 3x3 Gram matrix in the order 1, cos, sin.
struct InverseGram {
    one_one: f32,
    one_cos: f32,
    one_sin: f32,
    cos_cos: f32,
    cos_sin: f32,
    sin_sin: f32,
}

/// Least determinant, relative to that of a whole cycle (1/4), at which three functions count as independent.
const LEAST_DETERMINANT: f32 = 0.05;

impl Gram {
    /// Weight of all instants.
    fn one(&self) -> f32 {
        self.whole as f32 + self.shared
    }

    /// Adds instants of weight 1, but not their number.
    #[inline(always)]
    fn add_axes(&mut self, axes: &[Complex32]) {
        let mut sums = *self;
        for axis in axes {
            sums.cos += axis.re;
            sums.sin += axis.im;
            sums.cos_cos += axis.re * axis.re;
            sums.cos_sin += axis.re * axis.im;
        }
        *self = sums;
    }

    /// `None` when the samples do not cover enough of a cycle to tell the three functions apart.
    fn invert(&self) -> Option<InverseGram> {
        let n = self.one();
        let (c, s) = (self.cos / n, self.sin / n);
        let (cc, cs) = (self.cos_cos / n, self.cos_sin / n);
        let ss = 1.0 - cc;
        let determinant = (cc * ss - cs * cs) - c * (c * ss - cs * s) + s * (c * cs - cc * s);
        // The range also refuses NaN (no samples).
        if n < 4.0 || !(0.25 * LEAST_DETERMINANT..=1.0).contains(&determinant) {
            return None;
        }
        let scale = 1.0 / determinant;
        Some(InverseGram {
            one_one: scale * (cc * ss - cs * cs),
            one_cos: scale * (s * cs - c * ss),
            one_sin: scale * (c * cs - s * cc),
            cos_cos: scale * (ss - s * s),
            cos_sin: scale * (c * s - cs),
            sin_sin: scale * (cc - c * c),
        })
    }
}

impl InverseGram {
    fn apply(&self, sums: &Projection, n: f32) -> ChannelCycle {
        let (one, cos, sin) = (sums.one / n, sums.cos / n, sums.sin / n);
        let a = self.one_cos * one + self.cos_cos * cos + self.cos_sin * sin;
        let b = self.one_sin * one + self.cos_sin * cos + self.sin_sin * sin;
        ChannelCycle {
            // a cos + b sin = Re((a - j b) e^{j theta})
            phasor: Complex32::new(a, -b),
            offset: self.one_one * one + self.one_cos * cos + self.one_sin * sin,
            mean_square: sums.square / n,
        }
    }
}

#[cfg(test)]
mod tests;
