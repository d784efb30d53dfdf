//! The air-gap flux of a star of branches. `factor` of a flux (over rated) is what the magnetizing current is multiplied by, and its derivative.

use spline::{Known, Solved};

/// Most steps of Newton.
const STEPS: usize = 12;
/// Newton's step, over the rated flux, at which the iteration ends: the next one is its square, times some ten for exponents up to 16.
const SOLVED: f64 = 1e-6;
/// Largest error of a flux half way between two solutions that is one itself, over the rated flux: those of powers are.
const EXACT: f64 = 1e-9;
/// The same of a flux from which Newton begins: those of a curve with corners are no cubics.
const NEAR: f64 = 1e-3;
/// Fluxes that are solved beforehand ...
const SOLUTIONS: usize = 1024;
/// ... up to this flux without saturation, over rated: what a start reaches and more.
const HIGHEST: f64 = 4.0;

/// A star of branches: currents drive a flux through the sum of their admittances and the magnetizing inductance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Star {
    /// Sum of the admittances of all branches but the magnetizing one, 1/H.
    pub admittance: f64,
    /// Magnetizing inductance at rated flux, H.
    pub l_m: f64,
    /// Rated flux, V s.
    pub flux_rated: f64,
}

impl Star {
    /// The flux (V s) without saturation at the current `drive` (A).
    pub fn linear(&self, drive: f64) -> f64 {
        drive / (self.admittance + 1.0 / self.l_m)
    }

    /// Change of the current per flux, A/(V s), where the factor is `f` and `rise` is flux times its derivative.
    #[inline]
    fn slope(&self, f: f64, rise: f64) -> f64 {
        self.admittance + (f + rise / self.flux_rated) / self.l_m
    }

    /// The same at the flux `x` (V s).
    fn gradient(&self, factor: impl Fn(f64) -> (f64, f64), x: f64) -> f64 {
        let (f, slope) = factor(x / self.flux_rated);
        self.slope(f, x * slope)
    }

    /// Flux `x` (V s) with `x (admittance + f(x)/L_m) = drive`, by Newton's steps from `guess`.
    #[inline]
    pub fn solve(&self, factor: impl Fn(f64) -> (f64, f64), drive: f64, guess: f64) -> f64 {
        let mut x = guess;
        for _ in 0..STEPS {
            let (f, slope) = factor(x / self.flux_rated);
            let excess = x * (self.admittance + f / self.l_m) - drive;
            let step = excess / self.slope(f, x * slope);
            x = (x - step).max(0.0);
            if step.abs() < SOLVED * self.flux_rated {
                break;
            }
        }
        x
    }
}

/// Fluxes of one star over the flux without saturation, solved beforehand.
#[derive(Clone, Debug)]
pub(super) struct Solutions {
    star: Star,
    /// Current per flux without saturation, A/(V s).
    per_flux: f64,
    flux: Solved,
}

impl Solutions {
    /// Of one star.
    pub fn of(star: &Star, factor: impl Fn(f64) -> (f64, f64) + Copy) -> Self {
        let distance = HIGHEST * star.flux_rated / (SOLUTIONS - 1) as f64;
        let per_drive = star.admittance + 1.0 / star.l_m;
        let limits = [EXACT, NEAR].map(|limit| limit * star.flux_rated);
        let flux = Solved::of(SOLUTIONS, distance, limits, |linear, guess| {
            let x = star.solve(factor, linear * per_drive, guess);
            [x, per_drive / star.gradient(factor, x)]
        });
        Self {
            flux,
            per_flux: per_drive,
            star: *star,
        }
    }

    /// The flux (V s) of the star that was solved, at the current `drive` (A).
    #[inline]
    pub fn own_flux(&self, factor: impl Fn(f64) -> (f64, f64), drive: f64) -> f64 {
        let linear = drive / self.per_flux;
        match self.flux.at(linear) {
            Known::Answer(flux) => flux,
            Known::Guess(guess) => self.star.solve(factor, drive, guess),
            Known::Nothing => self.star.solve(factor, drive, linear),
        }
    }

    /// The flux of `star` (V s) at the current `drive` (A).
    #[inline]
    pub fn flux(&self, star: &Star, factor: impl Fn(f64) -> (f64, f64), drive: f64) -> f64 {
        match *star == self.star {
            true => self.own_flux(factor, drive),
            false => star.solve(factor, drive, star.linear(drive)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    const STAR: Star = Star {
        admittance: 190.0,
        l_m: 0.234,
        flux_rated: 1.0,
    };

    fn power(exponent: f64) -> impl Fn(f64) -> (f64, f64) {
        move |x: f64| {
            let power = x.powf(exponent - 1.0);
            (1.0 + 0.3 * (x * power - 1.0), 0.3 * exponent * power)
        }
    }

    /// Fluxes from nothing to the highest that is solved beforehand satisfy the equation, whatever the exponent; those of another star up to twice
    /// the rated flux.
    #[test]
    fn the_flux_drives_the_current_that_drives_it() {
        for exponent in [2.0, 7.0, 16.0] {
            let factor = power(exponent);
            let solutions = Solutions::of(&STAR, &factor);
            for other in [1.0, 1.2] {
                let star = Star {
                    admittance: other * STAR.admittance,
                    ..STAR
                };
                // Twelve steps from the flux without saturation reach the steepest power up to twice the rated flux.
                let highest = if star == STAR { 775.0 } else { 400.0 };
                for k in 0..2000 {
                    let drive = highest / 2000.0 * f64::from(k);
                    let x = solutions.flux(&star, &factor, drive);
                    let excess = x * (star.admittance + factor(x).0 / star.l_m) - drive;
                    let error = excess / star.gradient(&factor, x);
                    assert!(error.abs() < 1e-9, "{exponent} {drive}: {error:e}");
                }
            }
        }
    }

    /// A curve with corners is no cubic between two solutions.
    #[test]
    fn the_flux_of_a_curve_with_corners_is_solved() {
        let corner = |x: f64| match x > 0.9003 {
            true => (1.0 + 2.0 * (x - 0.9003), 2.0),
            false => (1.0, 0.0),
        };
        let solutions = Solutions::of(&STAR, corner);
        assert!(matches!(solutions.flux.at(0.9), Known::Guess(_)));
        let powers = Solutions::of(&STAR, &power(7.0));
        assert!(matches!(powers.flux.at(0.9), Known::Answer(_)));
        for k in 0..2000 {
            let drive = 0.43 * f64::from(k);
            let x = solutions.flux(&STAR, corner, drive);
            let excess = x * (STAR.admittance + corner(x).0 / STAR.l_m) - drive;
            let error = excess / STAR.gradient(corner, x);
            assert!(error.abs() < 1e-9, "{drive}: {error:e}");
        }
    }

    /// What was solved beforehand is worth its memory: the factor is not asked again.
    #[test]
    fn a_flux_that_was_solved_beforehand_asks_nothing() {
        let asked = Cell::new(0);
        let factor = |x: f64| {
            asked.set(asked.get() + 1);
            power(7.0)(x)
        };
        let solutions = Solutions::of(&STAR, factor);
        asked.set(0);
        for k in 0..100 {
            solutions.flux(&STAR, factor, 7.0 * f64::from(k));
        }
        assert_eq!(asked.get(), 0);
    }
}
