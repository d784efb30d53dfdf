//! What all windows since the alarm say together about the cause, on a calibrated motor.

use monitor::{CAUSES, Isolation, Report, Witness, magnitude};

/// Bands of current, as shares of rated: windows in one band share their systematic errors and count as one witness;
/// bands are witnesses of their own.
const BANDS: [f32; 3] = [0.4, 0.7, 1.0];

/// What a band of windows cannot rule out by itself.
const DOUBT: f64 = 1e-3;

/// Sums over one band.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Band {
    windows: u64,
    probabilities: [f64; CAUSES],
    unknown: f64,
    sizes: [f64; CAUSES],
}

/// Evidence about the cause.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Causes {
    bands: [Band; BANDS.len() + 1],
}

impl Causes {
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

    /// Windows of one band vote, bands multiply: a cause that one band rules out stays ruled out.
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
        let sum = shares.iter().sum::<f64>() + unknown;
        (shares.map(|share| share / sum), unknown / sum)
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
    fn add(&mut self, isolation: &Isolation) {
        self.windows += 1;
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
