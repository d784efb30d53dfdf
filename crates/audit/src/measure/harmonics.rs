//! The harmonics of three channels over a block, all in one pass.

use crate::measure::fit::Fit;
use crate::measure::turn::Turns;
use num_complex::Complex64;

/// Highest harmonic that is looked at.
pub(crate) const HIGHEST: usize = 25;
/// Harmonics by their order; 0 and 1 are not asked for.
const N: usize = HIGHEST + 1;

/// Harmonics 2 to [`HIGHEST`] over the fundamental, each in the fundamental's phase, of three channels.
pub(crate) type Ratios = [[Complex64; N]; 3];

/// Real and imaginary parts by order, apart so that neighbours are computed together.
#[derive(Clone, Copy)]
struct Parts {
    re: [f64; N],
    im: [f64; N],
}

impl Parts {
    const ZERO: Parts = Parts {
        re: [0.0; N],
        im: [0.0; N],
    };

    fn of(&self, order: usize) -> Complex64 {
        Complex64::new(self.re[order], self.im[order])
    }

    fn set(&mut self, order: usize, z: Complex64) {
        (self.re[order], self.im[order]) = (z.re, z.im);
    }

    /// `z` to the powers from 1 on, each by squares from the lowest on.
    fn powers(&mut self, z: Complex64) {
        self.set(1, z);
        for order in 2..N {
            let highest = 1 << order.ilog2();
            let power = match order == highest {
                true => self.of(order / 2) * self.of(order / 2),
                false => self.of(order - highest) * self.of(highest),
            };
            self.set(order, power);
        }
    }

    fn add(&mut self, x: f64, powers: &Parts) {
        for k in 0..N {
            self.re[k] += x * powers.re[k];
            self.im[k] += x * powers.im[k];
        }
    }
}

/// Of the samples `x` at the times `t`, s, whose fundamental is `fits` at `omega`, rad/s.
pub(crate) fn harmonics(t: &[f64], x: [&[f64]; 3], omega: f64, fits: &[Fit; 3]) -> Ratios {
    let (first, last) = (t[0], t[t.len() - 1]);
    let centre = 0.5 * (first + last);
    let (mut powers, mut sums) = (Parts::ZERO, [Parts::ZERO; 3]);
    let mut turns = Turns::new(t, omega, centre);
    let [a, b, c] = x;
    for (((t, a), b), c) in t.iter().zip(a).zip(b).zip(c) {
        let (sin, cos) = turns.at(*t);
        let turn = Complex64::new(cos, sin);
        powers.powers(turn.conj());
        for ((sum, fit), x) in sums.iter_mut().zip(fits).zip([a, b, c]) {
            sum.add(x - fit.mean - (fit.phasor * turn).re, &powers);
        }
    }
    let ratios = |(sum, fit): (Parts, &Fit)| {
        let unit = fit.phasor / fit.phasor.norm();
        std::array::from_fn(|order| {
            2.0 * sum.of(order) / t.len() as f64 / (fit.phasor.norm() * unit.powu(order as u32))
        })
    };
    let [a, b, c] = fits;
    let [of_a, of_b, of_c] = sums;
    [(of_a, a), (of_b, b), (of_c, c)].map(ratios)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::fit::Basis;
    use std::f64::consts::TAU;

    /// Three whole periods with a fifth and a seventh of known size and phase.
    #[test]
    fn harmonics_of_known_size_are_found_in_the_phase_of_the_fundamental() {
        let omega = TAU * 50.0;
        let t: Vec<f64> = (0..600).map(|k| f64::from(k) * 1e-4).collect();
        let shift = [0.0, -TAU / 3.0, TAU / 3.0];
        let wave = |phase: f64| {
            let signal = |t: &f64| {
                let angle = omega * t + phase;
                300.0 * angle.cos() + 15.0 * (5.0 * angle + 0.4).cos() + 6.0 * (7.0 * angle).cos()
            };
            t.iter().map(signal).collect::<Vec<f64>>()
        };
        let x = shift.map(wave);
        let basis = Basis::new(&t, omega).unwrap();
        let fits = [0, 1, 2].map(|k| basis.fit(&x[k]));
        let found = harmonics(&t, [&x[0], &x[1], &x[2]], omega, &fits);
        for ratios in found {
            let close = |order: usize, expected: Complex64| {
                assert!(
                    (ratios[order] - expected).norm() < 2e-3,
                    "{order}: {}",
                    ratios[order]
                );
            };
            close(5, Complex64::from_polar(0.05, 0.4));
            close(7, Complex64::new(0.02, 0.0));
            close(11, Complex64::ZERO);
        }
    }
}
