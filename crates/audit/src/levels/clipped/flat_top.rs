//! Flat tops: many samples at one extreme level, hardly any just below it.
//!
//! What a smooth signal does near its peak follows a power: within `b` of a peak of order `p` it stays for
//! `2 (b/k)^(1/p)`, so that the band next to the top holds `2^(1/p) - 1` of what the top holds: 1/2.4 of it for an ordinary
//! peak, 1/8.2 where third, fifth and seventh harmonic flatten it up to the sixth order. A cut top holds its whole width,
//! the band below only the flanks. Noise ahead of the cut vanishes at the top: one code then repeats; noise behind it
//! widens the level, and the band with it.
//!
//! Counting needs instants all over the top: several on each, or sampling that drifts through the period.

use std::ops::Range;

/// One channel, as far as its tops are concerned.
pub(super) struct Tops<'x> {
    pub t: &'x [f64],
    pub x: &'x [f64],
    /// Usual time between samples, s.
    pub t_sample: f64,
    /// Samples per period of the supply.
    pub period: f64,
    /// Step of the converter, in the channel's unit.
    pub step: f64,
    /// Standard deviation of the noise of one sample, in the channel's unit.
    pub sigma: f64,
}

/// Where one polarity is cut off.
pub(super) struct Cut {
    /// Magnitude of the level.
    pub level: f64,
    pub places: Vec<Range<usize>>,
}

/// One polarity of a channel and the level that it may be cut off at.
struct Level {
    sign: f64,
    value: f64,
    band: f64,
    /// From here on a sample belongs to the top.
    floor: f64,
}

/// Samples at the top over samples in the fullest band of the same width below it. The sixth order reaches 8, and 14
/// where sampling happens to be synchronous and just six samples lie on the top.
const CROWDED: usize = 15;
/// Samples at the top over samples in the three bands below it: the sixth order reaches 4 to 5 from ten samples on.
const CROWDED_NEAR: usize = 10;
/// Consecutive samples on a top: fewer do not tell its shape against the fullest band, ...
const FEWEST_SAMPLES: usize = 6;
/// ... or against the three bands below.
const FEWEST_SAMPLES_NEAR: usize = 10;
/// Tops that must be flat: two may be chance.
const FEWEST_TOPS: usize = 3;
/// Samples at the top where fewer lie on each, and the share of half periods that must have one.
const FEWEST_SPREAD: (usize, f64) = (60, 0.6);
/// Parts of a sampling time that zero crossings must fall into when sampling drifts through the period.
const PARTS: usize = 16;
/// Samples that may lie beyond the level without being it.
const OUTLIERS: usize = 2;
/// Width of a level behind which there is noise, in standard deviations: four to either side.
const NOISE_BAND: f64 = 8.0;
/// Widest band, as a share of the level: beyond it nothing is told from the peak's own roundness.
const WIDEST: f64 = 0.05;
/// Share of the level down to which bands are counted: flanks, not the crossings of zero.
const FLANKS: f64 = 0.5;
/// Rounding of a conversion from codes, as a share of the level.
const ROUNDING: f64 = 1e-9;
/// Longest top, in periods.
const LONGEST_TOP: f64 = 0.6;
/// Samples per period below which a peak has no top.
const FEWEST_PER_PERIOD: f64 = 10.0;
/// Tops this many periods apart belong to one stretch: a sensor recovers slowly.
const TOGETHER_PERIODS: f64 = 3.0;

/// Samples that are looked at together.
const PART: usize = 32;

impl Tops<'_> {
    /// The polarities that are cut off, negative first.
    pub fn cuts(&self) -> Vec<Cut> {
        if self.period < FEWEST_PER_PERIOD {
            return Vec::new();
        }
        let cuts = [-1.0, 1.0].into_iter().filter_map(|sign| self.cut(sign));
        cuts.collect()
    }

    fn cut(&self, sign: f64) -> Option<Cut> {
        let value = self.extreme(sign)?;
        let code = self.step.max(ROUNDING * value);
        let noise = NOISE_BAND * self.sigma + code;
        // Half a code below the top still rounds to it; a band of noise hangs from the highest sample.
        let bands = [(code, 0.5 * code), (noise, noise)];
        bands
            .into_iter()
            .filter(|(band, _)| *band < WIDEST * value)
            .find_map(|(band, below)| {
                let floor = value - below;
                let level = Level {
                    sign,
                    value,
                    band,
                    floor,
                };
                let tops = self.tops(&level);
                let drifting = || self.drifting(&level, &tops);
                self.resolved(&level, &tops).or_else(drifting)
            })
    }

    /// The largest value in one direction, but for outliers; `None` unless above 0.
    fn extreme(&self, sign: f64) -> Option<f64> {
        let mut largest = [f64::NEG_INFINITY; OUTLIERS + 1];
        for x in self.x {
            let x = sign * x;
            if x > largest[0] {
                largest[0] = x;
                largest.sort_unstable_by(f64::total_cmp);
            }
        }
        (largest[0] > 0.0).then_some(largest[0])
    }

    /// Tops of several samples each, wherever they are.
    fn resolved(&self, level: &Level, tops: &[Range<usize>]) -> Option<Cut> {
        let mut tops = tops.to_vec();
        tops.retain(|top| top.len() >= FEWEST_SAMPLES);
        if tops.len() < FEWEST_TOPS {
            return None;
        }
        let mut lengths: Vec<usize> = tops.iter().map(Range::len).collect();
        lengths.sort_unstable();
        let near = lengths[lengths.len() / 2] >= FEWEST_SAMPLES_NEAR;
        let places = self.joined(&tops);
        self.is_crowded(level, &places, near).then_some(Cut {
            level: level.value,
            places,
        })
    }

    /// Tops of few samples each, from the first to the last, while the sampling drifts through the period.
    fn drifting(&self, level: &Level, tops: &[Range<usize>]) -> Option<Cut> {
        let (fewest, share) = FEWEST_SPREAD;
        let (first, last) = (tops.first()?, tops.last()?);
        let place = first.start..last.end;
        let count: usize = tops.iter().map(Range::len).sum();
        let periods = place.len() as f64 / self.period;
        if count < fewest || (tops.len() as f64) < share * periods || !self.drifts(&place) {
            return None;
        }
        let places = vec![place];
        self.is_crowded(level, &places, true).then_some(Cut {
            level: level.value,
            places,
        })
    }

    fn is_crowded(&self, level: &Level, places: &[Range<usize>], near: bool) -> bool {
        let values = places.iter().flat_map(|place| &self.x[place.clone()]);
        let values = values
            .map(|x| level.sign * x)
            .filter(|y| *y > FLANKS * level.value);
        let (top, below): (Vec<f64>, Vec<f64>) = values.partition(|y| *y >= level.floor);
        let close = below
            .iter()
            .filter(|y| **y >= level.floor - 3.0 * level.band);
        let close = close.count().max(1);
        near && top.len() >= CROWDED_NEAR * close
            || top.len() >= CROWDED * fullest_band(below, level.band).max(1)
    }

    /// Runs of consecutive samples above the floor; what lasts longer than half a period stands still.
    fn tops(&self, level: &Level) -> Vec<Range<usize>> {
        let mut tops = self.runs(level);
        tops.retain(|top| (top.len() as f64) < LONGEST_TOP * self.period);
        tops.into_iter().flat_map(|top| self.pieces(top)).collect()
    }

    /// A run without its gaps in time.
    fn pieces(&self, run: Range<usize>) -> Vec<Range<usize>> {
        let mut pieces: Vec<Range<usize>> = Vec::new();
        for k in run {
            match pieces.last_mut() {
                Some(last) if !self.is_gap(k) => last.end = k + 1,
                _ => pieces.push(k..k + 1),
            }
        }
        pieces
    }

    fn runs(&self, level: &Level) -> Vec<Range<usize>> {
        let above = |x: &f64| level.sign * x >= level.floor;
        let (mut tops, mut from) = (Vec::new(), None);
        for (part, x) in self.x.chunks(PART).enumerate() {
            // Most of a wave is below its top.
            let any = x.iter().fold(false, |any, x| any | above(x));
            if !any && from.is_none() {
                continue;
            }
            for (k, x) in (part * PART..).zip(x) {
                let above = above(x);
                if let Some(begin) = from.filter(|_| !above) {
                    tops.push(begin..k);
                }
                from = above.then(|| from.unwrap_or(k));
            }
        }
        tops.extend(from.map(|begin| begin..self.x.len()));
        tops
    }

    fn is_gap(&self, k: usize) -> bool {
        self.t[k] - self.t[k - 1] >= 1.5 * self.t_sample
    }

    /// Whether zero crossings fall into every part of a sampling time.
    fn drifts(&self, place: &Range<usize>) -> bool {
        let mut seen = [0_usize; PARTS];
        for pair in self.x[place.clone()].windows(2) {
            if pair[0] < 0.0 && pair[1] >= 0.0 {
                let at = pair[0] / (pair[0] - pair[1]);
                seen[((at * PARTS as f64) as usize).min(PARTS - 1)] += 1;
            }
        }
        let crossings: usize = seen.iter().sum();
        seen.iter().all(|seen| 4 * PARTS * seen >= crossings) && crossings >= PARTS
    }

    /// Tops with half a period on either side, in one piece where they are near each other.
    fn joined(&self, tops: &[Range<usize>]) -> Vec<Range<usize>> {
        let half = (0.5 * self.period) as usize;
        let mut places: Vec<Range<usize>> = Vec::new();
        for top in tops {
            let start = top.start.saturating_sub(half);
            let end = (top.end + half).min(self.x.len());
            let near = |last: &Range<usize>| {
                top.start as f64 - (last.end as f64) < TOGETHER_PERIODS * self.period
            };
            match places.last_mut() {
                Some(last) if near(last) => last.end = end,
                _ => places.push(start..end),
            }
        }
        places
    }
}

/// The most values that lie within a band of this width.
fn fullest_band(mut values: Vec<f64>, width: f64) -> usize {
    values.sort_unstable_by(f64::total_cmp);
    let (mut first, mut fullest) = (0, 0);
    for (k, value) in values.iter().enumerate() {
        while value - values[first] >= width {
            first += 1;
        }
        fullest = fullest.max(k + 1 - first);
    }
    fullest
}
