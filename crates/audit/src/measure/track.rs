//! Follows the supply's fundamental through a recording, block by block.

use crate::measure::fit::{Basis, Fit};
use std::f64::consts::TAU;
use std::ops::Range;

/// Periods in a block: enough to tell the amplitude's slope from its phase, short against load steps.
pub(crate) const PERIODS: f64 = 3.0;
/// Share of the variance, adjusted for the parameters spent, that a fundamental must explain. A
/// two-level pulse pattern leaves it about half; noise has 0, scattered by a few over the samples.
const LOCKED_SHARE: f64 = 0.3;
/// Added to the share per sample of the block that is missing to many: noise fits short blocks.
const SHORT_BLOCK: f64 = 4.0;
/// Frequencies looked for when the clock's unit is taken at its word, Hz.
const RANGE_HZ: Range<f64> = 1.5..1000.0;
/// Step of the search, as a ratio: 3 periods resolve a third.
const RATIO: f64 = 1.12;
/// Samples per period below which a sinusoid cannot be told from its aliases.
const FEWEST_SAMPLES: f64 = 4.0;
/// Largest change of the frequency from one block to the next that is followed without a new search.
const FOLLOWED: f64 = 0.15;

/// Newton steps on the frequency of a block, and the change, a share of it, from which on no more is taken: a millionth of what
/// any check looks at.
const STEPS: usize = 4;
const EXACT: f64 = 1e-9;

/// A stretch of the recording over which the fundamental was found.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    pub range: Range<usize>,
    /// rad/s.
    pub omega: f64,
}

/// A block with what was found in it.
pub(crate) struct Found {
    pub span: Span,
    pub basis: Basis,
    /// One of each channel that was followed.
    pub fits: Vec<Fit>,
}

/// A block with a fundamental of some frequency.
struct Fitted {
    /// Frequency error, rad/s.
    error: f64,
    /// Share of the variance that the fundamental explains.
    share: f64,
    range: Range<usize>,
    basis: Basis,
    fits: Vec<Fit>,
}

/// The clock and the channels that carry the fundamental.
pub(crate) struct Tracked<'r> {
    pub t: &'r [f64],
    pub t_sample: f64,
    pub channels: Vec<&'r [f64]>,
}

impl Tracked<'_> {
    /// Every block over which the fundamental was found, in the order of time.
    pub fn spans(&self) -> Vec<Span> {
        let mut spans = Vec::new();
        self.for_each(&mut |found| spans.push(found.span.clone()));
        spans
    }

    /// Gives every block over which the fundamental was found, in the order of time.
    pub fn for_each(&self, give: &mut dyn FnMut(&Found)) {
        let (mut at, mut known) = (0, None);
        while at + 8 < self.t.len() {
            let followed = known.and_then(|omega| self.follow(at, omega));
            match followed.or_else(|| self.search(at, &self.candidates())) {
                Some(found) => {
                    at = found.span.range.end;
                    known = Some(found.span.omega);
                    give(&found);
                }
                None => {
                    known = None;
                    // A step in time can be more samples than there are numbers for.
                    at = at.saturating_add(self.step_when_lost()).min(self.t.len());
                }
            }
        }
    }

    /// The fundamental whatever the clock's unit: periods from a few samples to a third of the file.
    pub fn any_frequency(&self) -> Option<f64> {
        let longest = self.t.len() as f64 / PERIODS;
        let periods = ladder(FEWEST_SAMPLES, longest, RATIO);
        let omegas: Vec<f64> = periods.map(|n| TAU / (n * self.t_sample)).collect();
        self.search(0, &omegas).map(|found| found.span.omega)
    }

    fn candidates(&self) -> Vec<f64> {
        let highest = RANGE_HZ.end.min(1.0 / (FEWEST_SAMPLES * self.t_sample));
        ladder(RANGE_HZ.start, highest, RATIO)
            .map(|f| TAU * f)
            .collect()
    }

    /// A tenth of a second, or a hundredth of the recording, whichever is longer.
    fn step_when_lost(&self) -> usize {
        ((0.02 / self.t_sample) as usize)
            .max(self.t.len() / 400)
            .max(1)
    }

    fn follow(&self, at: usize, omega: f64) -> Option<Found> {
        self.refined(at, omega)
            .filter(|found| (found.span.omega / omega - 1.0).abs() < FOLLOWED)
    }

    fn search(&self, at: usize, omegas: &[f64]) -> Option<Found> {
        let coarse = omegas.iter().filter_map(|&omega| {
            let fitted = self.fitted(at, omega)?;
            Some((omega, fitted.share))
        });
        let (omega, _) = coarse.max_by(|a, b| a.1.total_cmp(&b.1))?;
        self.refined(at, omega)
    }

    /// Newton steps on the frequency, until one no longer changes it; the block follows its period.
    fn refined(&self, at: usize, mut omega: f64) -> Option<Found> {
        let mut fitted = self.fitted(at, omega)?;
        for _ in 0..STEPS {
            if fitted.error.abs() < EXACT * omega {
                break;
            }
            omega += fitted.error.clamp(-0.1 * omega, 0.1 * omega);
            fitted = self.fitted(at, omega)?;
        }
        let Fitted {
            share,
            range,
            basis,
            fits,
            ..
        } = fitted;
        let needed = LOCKED_SHARE + SHORT_BLOCK / range.len() as f64;
        (share > needed).then_some(Found {
            span: Span { range, omega },
            basis,
            fits,
        })
    }

    /// The block that begins at a sample with a fundamental of `omega`, rad/s.
    fn fitted(&self, at: usize, omega: f64) -> Option<Fitted> {
        let range = self.block(at, omega)?;
        let basis = Basis::new(&self.t[range.clone()], omega)?;
        let fits: Vec<Fit> = match self.channels[..] {
            [a, b, c] => basis
                .fit_each([a, b, c].map(|x| &x[range.clone()]))
                .to_vec(),
            _ => self
                .channels
                .iter()
                .map(|x| basis.fit(&x[range.clone()]))
                .collect(),
        };
        let total: f64 = fits.iter().map(|fit| fit.variance).sum();
        let rest: f64 = fits.iter().map(|fit| fit.rest).sum();
        let error = basis.frequency_error(&fits);
        let n = range.len() as f64;
        let share = 1.0 - rest / total * (n - 1.0) / (n - 5.0);
        (total > 0.0 && n > 5.0 && error.is_finite()).then_some(Fitted {
            error,
            share,
            range,
            basis,
            fits,
        })
    }

    fn block(&self, at: usize, omega: f64) -> Option<Range<usize>> {
        let end = self.t[at] + PERIODS * TAU / omega;
        if !omega.is_normal() || omega < 0.0 || end > self.t[self.t.len() - 1] + self.t_sample {
            return None;
        }
        let length = self.t[at..].partition_point(|t| *t < end - 0.5 * self.t_sample);
        // A gap inside the block leaves too few samples: half of them are asked for.
        let expected = PERIODS * TAU / (omega * self.t_sample);
        (length as f64 > 0.5 * expected).then_some(at..at + length)
    }
}

fn ladder(from: f64, to: f64, ratio: f64) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(from), move |x| Some(x * ratio)).take_while(move |x| *x <= to)
}
