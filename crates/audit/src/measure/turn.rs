//! Sine and cosine at the samples of a block: a turn of one step costs a tenth of a sine.

/// Turns from one exact sine to the next: rounding adds up to some 1e-15.
const LONGEST: u32 = 32;
/// A sample may be off its even place by this angle, rad: the third power of it is left out.
const UNEVEN: f64 = 5e-6;

/// `sin` and `cos` of `omega (t - centre)` for one sample after the other, to 1e-14; samples may be uneven, and gaps between them.
pub(crate) struct Turns {
    omega: f64,
    centre: f64,
    /// Angle of an even step with its sine and cosine.
    step: (f64, f64, f64),
    /// Angle of the last exact sine.
    exact: f64,
    /// Sine and cosine of the last sample's even place.
    sin: f64,
    cos: f64,
    left: u32,
}

impl Turns {
    /// For samples at the times `t`, s, that turn at `omega`, rad/s, about the time `centre`, s.
    pub fn new(t: &[f64], omega: f64, centre: f64) -> Turns {
        let steps = t.len().saturating_sub(1).max(1) as f64;
        let length = t
            .last()
            .zip(t.first())
            .map_or(0.0, |(last, first)| last - first);
        let angle = omega * length / steps;
        let (sin, cos) = angle.sin_cos();
        Turns {
            omega,
            centre,
            step: (angle, sin, cos),
            exact: 0.0,
            sin: 0.0,
            cos: 1.0,
            left: 0,
        }
    }

    /// Sine and cosine at the time `t`, s, of the next sample.
    #[inline]
    pub fn at(&mut self, t: f64) -> (f64, f64) {
        let angle = self.omega * (t - self.centre);
        let (step, step_sin, step_cos) = self.step;
        let turned = f64::from(LONGEST - self.left + 1) * step;
        let off = (angle - self.exact) - turned;
        if self.left == 0 || off.is_nan() || off.abs() > UNEVEN {
            (self.sin, self.cos) = angle.sin_cos();
            (self.exact, self.left) = (angle, LONGEST);
            return (self.sin, self.cos);
        }
        let sin = self.sin * step_cos + self.cos * step_sin;
        let cos = self.cos * step_cos - self.sin * step_sin;
        // The next turn begins at the even place: it need not wait for what follows.
        (self.sin, self.cos, self.left) = (sin, cos, self.left - 1);
        let lost = 0.5 * off * off;
        (sin + off * cos - lost * sin, cos - off * sin - lost * cos)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(t: &[f64], omega: f64) -> f64 {
        let centre = 0.5 * (t[0] + t[t.len() - 1]);
        let mut turns = Turns::new(t, omega, centre);
        let off = t.iter().map(|t| {
            let (sin, cos) = turns.at(*t);
            let (exact_sin, exact_cos) = (omega * (t - centre)).sin_cos();
            (sin - exact_sin).abs().max((cos - exact_cos).abs())
        });
        off.fold(0.0, f64::max)
    }

    #[test]
    fn even_and_uneven_samples_and_gaps_turn_as_exact_sines_do() {
        let even: Vec<f64> = (0..3000).map(|k| 1e3 + f64::from(k) * 1e-4).collect();
        let jitter = |size: f64| -> Vec<f64> {
            let shaken = even.iter().enumerate();
            shaken
                .map(|(k, t)| t + size * (k as f64 * 1.7).sin())
                .collect()
        };
        let gap: Vec<f64> = even
            .iter()
            .copied()
            .filter(|t| (t - 1e3 - 0.1).abs() > 0.03)
            .collect();
        for t in [even.clone(), jitter(1e-10), jitter(5e-9), jitter(3e-5), gap] {
            for omega in [9.0, 314.0, 5e3] {
                assert!(worst(&t, omega) < 1e-14, "{omega} {}", worst(&t, omega));
            }
        }
    }
}
