//! What all windows since the alarm say together about the cause, on a calibrated motor.

use monitor::{CAUSES, Isolation, Report, Witness, magnitude};

/// Bands of current, as shares of rated: windows in one band share their systematic errors and count as one witness;
/// bands are witnesses of their own.
const BANDS: [f32; 3] = [0.4, 0.7, 1.0];

/// What a band of windows cannot rule out by itself.
const DOUBT: f64 = 1e-3;
/// Standard deviations that a band departs by at least to tell a size.
const TELLS_A_SIZE: f64 = 4.0;
/// Systematic error of a size, as a share of it: what the model errs by differs from load to load.
const SIZE_ERROR: f64 = 0.1;
/// What sizes that disagree leave of a cause at least: some change with the load by themselves.
const DISAGREED: f64 = 0.01;

/// Sums over one band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Band {
    windows: u64,
    probabilities: [f64; CAUSES],
    unknown: f64,
    sizes: [f64; CAUSES],
    significance: f64,
}

/// Evidence about the cause.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Causes {
    bands: [Band; BANDS.len() + 1],
    torque_is_known: bool,
}

impl Causes {
    /// Without windows. Where the torque is not known, two rows tell a size: what the model errs by at a low load is then as large as a
    /// fault, and sizes are not compared.
    pub fn new(torque_is_known: bool) -> Self {
        Causes {
            torque_is_known,
            ..Causes::default()
        }
    }

    /// Adds a window; `rated_current` is an amplitude, A.
    pub fn add(&mut self, report: &Report, rated_current: f32) {
        let (Some(isolation), Some(window)) = (&report.isolation, &report.window) else {
            return;
        };
        let share = magnitude(window.i_s.positive) / rated_current;
        let band = BANDS.iter().filter(|limit| share > **limit).count();
        if let Some(band) = self.bands.get_mut(band) {
            band.add(isolation);
        }
    }

    /// Windows that say something.
    pub fn windows(&self) -> u64 {
        self.bands.iter().map(|band| band.windows).sum()
    }

    /// What they say together; `Witness::None` without a window.
    pub fn witness(&self) -> Witness {
        if self.windows() == 0 {
            return Witness::None;
        }
        let (shares, unknown) = self.probabilities();
        Witness::Directions {
            probabilities: shares.map(|share| share as f32),
            unknown: unknown as f32,
            sizes: self.sizes().map(|size| size as f32),
        }
    }

    /// Windows of one band vote, bands multiply: a cause that one band rules out stays ruled out, and one whose size would have to
    /// change from band to band is unlikely. A resistance that is read as a voltage's gain at one load is another gain at the next.
    fn probabilities(&self) -> ([f64; CAUSES], f64) {
        let mut shares = [1.0; CAUSES];
        let mut unknown = 1.0;
        for band in self.bands.iter().filter(|band| band.windows > 0) {
            let mean = |sum: f64| (sum / band.windows as f64).max(DOUBT);
            for (share, sum) in shares.iter_mut().zip(band.probabilities) {
                *share *= mean(sum);
            }
            unknown *= mean(band.unknown);
        }
        for (cause, share) in shares.iter_mut().enumerate() {
            *share *= self.agreement(cause);
        }
        let sum = shares.iter().sum::<f64>() + unknown;
        (shares.map(|share| share / sum), unknown / sum)
    }

    /// How well the sizes of a cause agree from band to band: 1 where one band tells it.
    fn agreement(&self, cause: usize) -> f64 {
        let comparable = |band: &&Band| self.torque_is_known && band.tells_sizes();
        let tell = self.bands.iter().filter(comparable);
        let told: Vec<(f64, f64)> = tell.map(|band| band.size(cause)).collect();
        let weight = |deviation: f64| 1.0 / (deviation * deviation).max(f64::MIN_POSITIVE);
        let weights: f64 = told.iter().map(|(_, deviation)| weight(*deviation)).sum();
        let sum: f64 = told.iter().map(|(size, sd)| size * weight(*sd)).sum();
        let off = |(size, sd): &(f64, f64)| (size - sum / weights).powi(2) * weight(*sd);
        let square: f64 = told.iter().map(off).sum();
        (-0.5 * square).exp().max(DISAGREED)
    }

    fn sizes(&self) -> [f64; CAUSES] {
        let windows = self.windows();
        let mut sizes = [0.0; CAUSES];
        for band in &self.bands {
            for (size, sum) in sizes.iter_mut().zip(band.sizes) {
                *size += sum / windows.max(1) as f64;
            }
        }
        sizes
    }
}

impl Band {
    fn tells_sizes(&self) -> bool {
        self.significance > TELLS_A_SIZE * self.windows as f64 && self.windows > 0
    }

    /// Mean size of a cause, and how far it may be off: a cause that explains the departure is told as surely as that departs.
    fn size(&self, cause: usize) -> (f64, f64) {
        let windows = self.windows as f64;
        let size = self.sizes.get(cause).map_or(0.0, |sum| sum / windows);
        let share = (windows / self.significance).hypot(SIZE_ERROR);
        (size, size.abs() * share)
    }

    fn add(&mut self, isolation: &Isolation) {
        self.windows += 1;
        self.significance += f64::from(isolation.significance);
        let (probabilities, unknown) = isolation.probabilities();
        self.unknown += f64::from(unknown);
        for (sum, x) in self.probabilities.iter_mut().zip(probabilities) {
            *sum += f64::from(x);
        }
        for (sum, x) in self.sizes.iter_mut().zip(isolation.sizes) {
            *sum += f64::from(x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use monitor::{ALL_CAUSES, Cause};

    /// Ten windows that depart by so many standard deviations: probability and size of each of two causes.
    fn band(significance: f64, told: [(Cause, f64, f64); 2]) -> Band {
        let mut band = Band {
            windows: 10,
            significance: 10.0 * significance,
            ..Band::default()
        };
        for (cause, probability, size) in told {
            let k = place(cause);
            band.probabilities[k] = 10.0 * probability;
            band.sizes[k] = 10.0 * size;
        }
        band
    }

    fn place(cause: Cause) -> usize {
        let place = ALL_CAUSES.iter().position(|c| *c == cause);
        place.expect("one of all")
    }

    fn told_by(first: Band, second: Band) -> Causes {
        Causes {
            bands: [Band::default(), first, second, Band::default()],
            torque_is_known: true,
        }
    }

    fn shares(told: &Causes) -> [f64; 2] {
        let (shares, _) = told.probabilities();
        [Cause::RotorResistance, Cause::SpeedGain].map(|cause| shares[place(cause)])
    }

    /// A cage's resistance that has risen by 72 to 76 % was read as a speed that is 4.2 % wrong at one load and 1 % at the next.
    #[test]
    fn a_cause_whose_size_changes_from_load_to_load_is_unlikely() {
        let (rotor, speed) = (Cause::RotorResistance, Cause::SpeedGain);
        let told = |size, gain| [(rotor, 0.4, size), (speed, 0.6, gain)];
        let differing = [band(7.0, told(0.72, -0.042)), band(9.0, told(0.76, -0.010))];
        let mut all = told_by(differing[0], differing[1]);
        let [its_rotor, its_speed] = shares(&all);
        assert!(
            its_rotor > 0.95 && its_speed < 0.05,
            "{its_rotor} {its_speed}"
        );
        let not_compared = |causes: &Causes| {
            let [its_rotor, its_speed] = shares(causes);
            // 0.4^2 to 0.6^2: the bands multiply.
            assert!(
                (its_speed / its_rotor - 2.25).abs() < 1e-6,
                "{its_rotor} {its_speed}"
            );
        };
        not_compared(&told_by(differing[0], differing[0]));
        // A load at which hardly anything departs tells no size.
        not_compared(&told_by(differing[0], band(2.0, told(0.76, -0.010))));
        all.torque_is_known = false;
        not_compared(&all);
    }
}
