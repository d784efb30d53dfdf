//! The air-gap flux of a star of branches whose magnetizing one saturates.

/// What the magnetizing current is multiplied by at a flux (over rated), and its derivative.
pub(super) type Factor<'a> = &'a dyn Fn(f64) -> (f64, f64);

/// Most steps of Newton.
const STEPS: usize = 30;
/// Newton's step, over the rated flux, after which the next one would be below 1e-9: it is this one squared, times some ten for exponents
/// up to 16.
const SOLVED: f64 = 8e-6;
/// Fluxes that were solved beforehand ...
const GUESSES: usize = 1024;
/// ... up to this flux without saturation, over rated: what a start reaches and more.
const HIGHEST: f64 = 4.0;

/// A star of branches: currents drive a flux through the sum of their admittances and the magnetizing inductance.
#[derive(Clone, Copy, Debug)]
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

    /// Flux `x` (V s) with `x (admittance + f(x)/L_m) = drive`, by Newton's steps from `guess`.
    #[inline]
    pub fn solve(&self, factor: impl Fn(f64) -> (f64, f64), drive: f64, guess: f64) -> f64 {
        let mut x = guess;
        for _ in 0..STEPS {
            let (f, slope) = factor(x / self.flux_rated);
            let excess = x * (self.admittance + f / self.l_m) - drive;
            let gradient = self.admittance + (f + x * slope / self.flux_rated) / self.l_m;
            let step = excess / gradient;
            x = (x - step).max(0.0);
            if step.abs() < SOLVED * self.flux_rated {
                break;
            }
        }
        x
    }
}

/// Fluxes of a star, solved beforehand: with one of them as its guess a solution takes one step instead of three or four.
#[derive(Clone, Debug)]
pub(super) struct Guesses {
    /// Flux over the flux without saturation, at equal distances of the latter.
    share: Vec<f64>,
    /// One over that distance, 1/(V s).
    per_flux: f64,
}

impl Guesses {
    /// Of one star; others may be guessed with them.
    pub fn of(star: &Star, factor: Factor<'_>) -> Self {
        let distance = HIGHEST * star.flux_rated / (GUESSES - 1) as f64;
        let per_drive = star.admittance + 1.0 / star.l_m;
        let mut share = Vec::with_capacity(GUESSES);
        let mut last = 1.0;
        for k in 0..GUESSES {
            // At no flux at all the share is that of hardly any.
            let linear = distance * (k as f64).max(1e-3);
            last = star.solve(factor, linear * per_drive, last * linear) / linear;
            share.push(last);
        }
        Self {
            share,
            per_flux: 1.0 / distance,
        }
    }

    /// A guess of the flux where it would be `linear` (V s) without saturation.
    #[inline]
    pub fn at(&self, linear: f64) -> f64 {
        let place = linear * self.per_flux;
        let k = (place as usize).min(self.share.len() - 2);
        let between = (place - k as f64).min(1.0);
        linear * (self.share[k] + between * (self.share[k + 1] - self.share[k]))
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

    /// Fluxes from nothing to what a start reaches satisfy the equation, whatever the exponent and wherever the guess.
    #[test]
    fn the_flux_drives_the_current_that_drives_it() {
        for exponent in [2.0, 7.0, 16.0] {
            let factor = power(exponent);
            let guesses = Guesses::of(&STAR, &factor);
            for k in 0..2000 {
                let drive = 0.4 * f64::from(k);
                for guess in [guesses.at(STAR.linear(drive)), STAR.linear(drive)] {
                    let x = STAR.solve(&factor, drive, guess);
                    let (f, slope) = factor(x);
                    let excess = x * (STAR.admittance + f / STAR.l_m) - drive;
                    let error = excess / (STAR.admittance + (f + x * slope) / STAR.l_m);
                    assert!(error.abs() < 1e-9, "{exponent} {drive}: {error:e}");
                }
            }
        }
    }

    /// The guess is worth its memory: around the rated flux one evaluation is enough.
    #[test]
    fn one_step_from_a_guess_is_enough_about_the_rated_flux() {
        let asked = Cell::new(0);
        let factor = |x: f64| {
            asked.set(asked.get() + 1);
            power(7.0)(x)
        };
        let guesses = Guesses::of(&STAR, &factor);
        asked.set(0);
        for k in 0..100 {
            let drive = (0.9 + 0.002 * f64::from(k)) * (STAR.admittance + 1.0 / STAR.l_m);
            STAR.solve(&factor, drive, guesses.at(STAR.linear(drive)));
        }
        assert_eq!(asked.get(), 100);
    }
}
