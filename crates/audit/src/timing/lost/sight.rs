//! Three channels over one block as a rotating vector, and where it jumps.

use super::extrapolation::Weights;
use crate::measure::blocks::Three;
use crate::measure::sequence::a;
use crate::measure::statistics::median;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Samples on each side of an instant, tried one after the other until noise leaves a jump by one sample clear.
const SIDES: [usize; 3] = [6, 12, 24];
/// Share of a period beyond which a side does not reach, unless it is the first of [`SIDES`].
const SIDE: f64 = 1.0 / 6.0;
/// Standard deviations of the noise of a jump that must fit into [`OFF`] samples.
const CLEAR: f64 = 4.0;
/// By how much a jump may miss whole samples, in samples; further for what unbalance adds, as a share of the jump.
const OFF: f64 = 0.25;
const OFF_SHARE: f64 = 0.05;
/// Jumps from so many samples on are looked at.
pub(super) const SMALLEST: f64 = 0.6;
/// Angle of the usual step over what the supply turns in a sampling time, less 1: samples that are held or repeated differ.
const USUAL: f64 = 0.25;
/// Share of the steps that must be usual ones, within so much of it.
const MOST: f64 = 0.7;
const ALIKE: f64 = 0.3;
/// Median over standard deviation of an axis, of the size of a Gaussian vector.
const GAUSSIAN: f64 = 1.1774;
/// Samples passed over at an instant to see whether a jump stays.
const PASSED: usize = 2;

/// A rotating vector with its steps over a block.
pub(super) struct Sight {
    /// The vector from sample `first` of the recording on.
    z: Vec<Complex64>,
    first: usize,
    /// Angle from one sample to the next, rad.
    angle: f64,
    /// Jumps in samples, the first in front of the first sample that `near` reaches.
    jumps: Vec<f64>,
    near: Weights,
    far: Weights,
}

impl Sight {
    /// Samples beside a block that a sight uses.
    pub const REACH: usize = SIDES[2] + PASSED;

    /// Of three channels over a block and [`Sight::REACH`] samples beside it; `None` where a jump by one sample would not be clear.
    pub fn new(
        channels: [&[f64]; 3],
        range: Range<usize>,
        three: &Three,
        turn: f64,
    ) -> Option<Sight> {
        let is_positive = three.sequence().clear_order()?;
        let b = if is_positive { a() } else { a().conj() };
        let z: Vec<Complex64> = range
            .clone()
            .map(|k| {
                (channels[0][k] + b * channels[1][k] + b.conj() * channels[2][k]) * (2.0 / 3.0)
            })
            .collect();
        let angle = usual_angle(&z, turn)?;
        let scale = 1.0 / (three.sequence().main().norm() * angle);
        let (side, near, jumps) = SIDES.into_iter().find_map(|side| {
            let fits = side == SIDES[0] || side as f64 * angle < SIDE * TAU;
            let near = Weights::new(0, side, angle).filter(|_| fits)?;
            let jumps = jumps(&z, &near, scale);
            is_clear(&jumps).then_some((side, near, jumps))
        })?;
        Some(Sight {
            far: Weights::new(PASSED, side, angle)?,
            near,
            jumps,
            z,
            first: range.start,
            angle,
        })
    }

    /// The samples that have enough others on both sides.
    pub fn inside(&self) -> Range<usize> {
        let reach = self.far.reach();
        self.first + reach
            ..(self.first + self.z.len())
                .saturating_sub(reach)
                .max(self.first + reach)
    }

    /// Size of the jump in front of a sample that is [`Sight::inside`], in samples.
    pub fn jump(&self, at: usize) -> f64 {
        self.jumps[at - self.first - self.near.reach()]
    }

    /// Samples by which the vector jumps ahead, where it jumps by whole ones below half a turn and goes on from there.
    pub fn lost(&self, at: usize) -> Option<u32> {
        let turned = self.turned(&self.near, at);
        let samples = (turned.arg() / self.angle).round();
        let meant = Complex64::cis(samples * self.angle);
        let allowed = OFF * self.angle + OFF_SHARE * (meant - 1.0).norm();
        let is_whole = (turned - meant).norm() < allowed && samples * self.angle < PI;
        // A spike is over a few samples later. Carried on from further away the angle is less certain.
        let stays = (self.turned(&self.far, at).arg() / self.angle).round() == samples;
        (is_whole && stays && samples >= 1.0).then_some(samples as u32)
    }

    fn turned(&self, weights: &Weights, at: usize) -> Complex64 {
        let [before, behind] = weights.both(&self.z, at - self.first);
        behind / before
    }
}

/// Sizes of the jumps in front of all samples that have enough others on both sides, times a scale.
fn jumps(z: &[Complex64], near: &Weights, scale: f64) -> Vec<f64> {
    let inside = near.reach()..(z.len() + 1).saturating_sub(near.reach());
    let size = |at| {
        let [before, behind] = near.both(z, at);
        scale * (behind - before).norm()
    };
    inside.map(size).collect()
}

/// Whether noise leaves a jump by one sample clear.
fn is_clear(jumps: &[f64]) -> bool {
    median(jumps.iter().copied()).is_some_and(|size| CLEAR * size / GAUSSIAN < OFF)
}

/// The angle that the vector mostly turns by from one sample to the next, where it does so evenly and about as fast as `turn`.
fn usual_angle(z: &[Complex64], turn: f64) -> Option<f64> {
    let steps = || z.windows(2).map(|pair| (pair[1] * pair[0].conj()).arg());
    let angle = median(steps())?;
    let alike = steps().filter(|step| (step - angle).abs() < ALIKE * angle);
    let is_even = alike.count() as f64 > MOST * z.len() as f64;
    (is_even && (angle / turn - 1.0).abs() < USUAL).then_some(angle)
}
