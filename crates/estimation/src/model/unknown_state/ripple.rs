//! A ripple of the shaft's speed at twice the supply's frequency, which an unbalanced supply and an unbalanced motor make.
//!
//! Flux and current of negative sequence make a torque `Re(T exp(j 2 theta))` beside the mean one,
//! `T = 3/2 n_p (psi_1 i_2 + psi_2 i_1)` at most, and that a speed of amplitude `T / (2 omega J)`; a load coupled to the motor makes it
//! smaller. Its two amounts, cosine and sine, are expected to be as large as that.

use crate::data::case::Waveform;
use crate::data::channels::SPEED;
use crate::fit::nuisance::Strip;
use motor::dynamic::clarke;
use motor::effect::Plant;
use num_complex::Complex64;
use signal::are_counts;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// A ripple of the speed that drives a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    /// Amplitude, rad/s.
    size: f64,
    /// Phase at the first sample, rad.
    phase: f64,
}

impl Ripple {
    /// Its cosine and its sine, each as large as what was measured makes one expect.
    pub fn expected(waveform: &Waveform, plant: &Plant) -> [Self; 2] {
        let size = size(waveform, plant);
        [0.0, FRAC_PI_2].map(|phase| Self { size, phase })
    }

    /// The other way.
    pub fn opposite(self) -> Self {
        Self {
            phase: self.phase + PI,
            ..self
        }
    }

    /// The speed that drives a case, rad/s, with the ripple.
    pub fn added(&self, waveform: &Waveform) -> Vec<f64> {
        let both = waveform.speed.iter().zip(angles(waveform));
        both.map(|(omega, angle)| omega + self.size * (2.0 * angle + self.phase).cos())
            .collect()
    }
}

/// Angle of the supply at each input sample, rad, from zero at the first.
fn angles(waveform: &Waveform) -> impl Iterator<Item = f64> + '_ {
    let step = waveform.inputs.t_sample;
    waveform
        .timeline
        .omega_sync
        .iter()
        .scan(0.0, move |angle, omega| {
            let here = *angle;
            *angle += omega * step;
            Some(here)
        })
}

/// The cosine and the sine that counts of the speed may show in some rows, whatever the shaft does: a count over one period of the ripple
/// shows none, a shorter one a part. Nothing where the speed is no output, or no count.
pub fn of_counts(waveform: &Waveform, rows: Range<usize>) -> Vec<Strip> {
    let speeds: Vec<f64> = waveform.measured[rows.clone()]
        .iter()
        .map(|row| row[SPEED])
        .collect();
    if waveform.speed_is_input || !are_counts(&speeds) {
        return Vec::new();
    }
    let angles = angles(waveform).step_by(waveform.samples_per_row());
    let angles: Vec<f64> = angles.skip(rows.start).take(rows.len()).collect();
    let weights = &waveform.weight[rows.clone()];
    let wave = |phase: f64| {
        let both = angles.iter().zip(weights);
        let values = both.map(|(angle, w)| w[SPEED] * (2.0 * angle + phase).cos());
        Strip::of_channel(SPEED, rows.start, values.collect())
    };
    [0.0, FRAC_PI_2].map(wave).into()
}

/// Amplitude of a ripple, rad/s: the upper quartile of the supply's pairs of cycles. The first ones after a switch hold direct current that
/// fades, which looks like other sequences.
fn size(waveform: &Waveform, plant: &Plant) -> f64 {
    let pairs = pairs_of_cycles(waveform);
    let mut sizes: Vec<f64> = pairs.iter().map(|pair| pair.ripple(plant)).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let upper = sizes.len() - 1 - sizes.len() / 4;
    *sizes.select_nth_unstable_by(upper, f64::total_cmp).1
}

/// Sums over two cycles of the supply, with the weights of Hann: two cycles are no whole number of rows.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    weight: f64,
    omega_sync: f64,
    /// Positive and negative sequence of the voltage, V, and of the current, A, times the weight.
    u: [Complex64; 2],
    i: [Complex64; 2],
}

impl Pair {
    fn add(&mut self, angle: f64, omega_sync: f64, u: Complex64, i: Complex64) {
        let weight = 1.0 - (0.5 * angle).cos();
        let turn = weight * Complex64::cis(angle);
        self.weight += weight;
        self.omega_sync += weight * omega_sync;
        self.u = [self.u[0] + u * turn.conj(), self.u[1] + u * turn];
        self.i = [self.i[0] + i * turn.conj(), self.i[1] + i * turn];
    }

    /// Amplitude of the ripple that its sequences make, rad/s, with the flux of a winding without resistance.
    fn ripple(&self, plant: &Plant) -> f64 {
        let omega = self.omega_sync.abs() / self.weight;
        let both = self.u[0].norm() * self.i[1].norm() + self.u[1].norm() * self.i[0].norm();
        let torque = 1.5 * plant.rated.n_p * both / (self.weight.powi(2) * omega);
        torque / (2.0 * omega * plant.mechanics.inertia)
    }
}

/// The whole pairs of cycles of a case.
fn pairs_of_cycles(waveform: &Waveform) -> Vec<Pair> {
    let inputs = angles(waveform)
        .zip(&waveform.timeline.omega_sync)
        .zip(&waveform.inputs.u_s);
    let rows = inputs
        .step_by(waveform.samples_per_row())
        .zip(&waveform.measured);
    let (mut all, mut pair, mut number) = (Vec::new(), Pair::default(), 0.0);
    for (((angle, omega_sync), u), [a, b, c, ..]) in rows {
        // A field that turns backwards counts its cycles too.
        let pairs = (angle.abs() / (2.0 * TAU)).floor();
        if pairs != number {
            all.push(std::mem::take(&mut pair));
            number = pairs;
        }
        pair.add(angle, *omega_sync, *u, clarke([*a, *b, *c]));
    }
    all
}
