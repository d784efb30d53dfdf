//! Slow things: wandering quantities, temperatures.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// A normally distributed number of variance 1.
pub(super) fn normal(random: &mut Pcg64) -> f64 {
    StandardNormal.sample(random)
}

/// Anywhere in -1..1.
pub(super) fn signed(random: &mut Pcg64) -> f64 {
    random.random_range(-1.0..1.0)
}

/// Anywhere between two positive numbers, evenly in their logarithm.
pub(super) fn log_between(random: &mut Pcg64, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.random())
}

/// A quantity that wanders about zero and forgets where it was (Ornstein and Uhlenbeck).
#[derive(Clone, Copy, Debug)]
pub(super) struct Wander {
    pub value: f64,
    sigma: f64,
    forgets_s: f64,
}

impl Wander {
    pub fn new(sigma: f64, forgets_s: f64, random: &mut Pcg64) -> Wander {
        let value = sigma * normal(random);
        Wander {
            value,
            sigma,
            forgets_s,
        }
    }

    pub fn step(&mut self, seconds: f64, random: &mut Pcg64) {
        let keep = (-seconds / self.forgets_s).exp();
        let news = self.sigma * (1.0 - keep * keep).sqrt();
        self.value = keep * self.value + news * normal(random);
    }
}

/// A temperature that follows its target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub degc: f64,
    running_s: f64,
    resting_s: f64,
}

impl Body {
    pub fn new(degc: f64, running_s: f64, resting_s: f64) -> Body {
        Body {
            degc,
            running_s,
            resting_s,
        }
    }

    /// How fast it warms towards a target while it runs, K/s.
    pub fn rate(&self, target: f64) -> f64 {
        (target - self.degc) / self.running_s
    }

    pub fn step(&mut self, seconds: f64, target: f64, running: bool) {
        let constant = if running {
            self.running_s
        } else {
            self.resting_s
        };
        self.degc += (target - self.degc) * -(-seconds / constant).exp_m1();
    }
}
