//! Time stamps of an even clock that were written with few decimals.
//!
//! At 4 kHz stamps of 0.1 ms go on in steps of 0.2 and 0.3 ms. No single step tells the rate, a straight line through all does:
//! where no stamp lies off it by more than rounding, the line is the clock. Gaps part the stamps into runs of one rate.

use std::ops::Range;

/// An even clock behind rounded stamps.
pub struct Even {
    /// The times on the line, s.
    pub t: Vec<f64>,
    /// Time between two samples, s.
    pub step_s: f64,
    /// What the stamps are rounded to, s.
    pub rounding_s: f64,
}

/// Spread of the stamps about the line, in roundings: rounding alone spreads them over one.
const SPREAD: f64 = 1.1;
/// Share of a step that a rounding must exceed to matter.
const NOTABLE: f64 = 1e-4;
/// Most samples that may share a stamp.
const SHARED: f64 = 4.0;
/// Roundings that the stamps must span for a line to have a rate.
const LONG: f64 = 1e3;
/// Most gaps, as a share of the samples.
const GAPS: f64 = 0.1;
/// Share of the steps below which longer ones are no rounding where a lost row would look the same.
const RARE: f64 = 0.02;
/// Share of a rounding by which a double may miss its decimals.
const DOUBLE: f64 = 0.01;
/// Most decimals of a second that are looked for.
const DECIMALS: i32 = 9;

impl Even {
    /// What was assumed, in words.
    pub fn told(&self) -> String {
        let rate_hz = 1.0 / self.step_s;
        let digits = (5.0 - rate_hz.log10().floor()).clamp(0.0, 6.0) as i32;
        let scale = 10_f64.powi(digits);
        format!(
            "time stamps are rounded to {}; {} Hz from first to last",
            time(self.rounding_s),
            (scale * rate_hz).round() / scale
        )
    }
}

/// A decimal of a second in the unit that leaves few zeros.
fn time(decimal_s: f64) -> String {
    let units = [(1.0, "s"), (1e3, "ms"), (1e6, "us"), (1e9, "ns")];
    let largest = units
        .into_iter()
        .find(|(factor, _)| factor * decimal_s > 0.05);
    let (factor, unit) = largest.unwrap_or((1e9, "ns"));
    format!("{} {unit}", (10.0 * factor * decimal_s).round() / 10.0)
}

/// The even clock of time stamps, s, where one explains each of them and is not what they say already.
pub fn even(t: &[f64]) -> Option<Even> {
    let (first, last) = (*t.first()?, *t.last()?);
    let mean = (last - first) / (t.len() - 1) as f64;
    let rounding_s = rounding(t, NOTABLE * mean)?;
    let runs = runs(t, rounding_s)?;
    let step_s = slope(t, &runs)?;
    let spreads = runs.iter().map(|run| spread(t, run, step_s));
    let widest = spreads.fold(0.0, f64::max);
    let is_rounded = (2.0 * DOUBLE * rounding_s..SPREAD * rounding_s).contains(&widest);
    let is_known = last - first > LONG * rounding_s && SHARED * step_s > rounding_s;
    (is_rounded && is_known).then(|| Even {
        t: runs
            .iter()
            .flat_map(|run| on_line(t, run, step_s))
            .collect(),
        step_s,
        rounding_s,
    })
}

/// The coarsest decimal of a second, above a least one, of which all stamps are multiples behind the first.
fn rounding(t: &[f64], least: f64) -> Option<f64> {
    let mut decimals = 0;
    for x in t {
        while !is_multiple(x - t[0], decimals) {
            decimals += 1;
            if decimals > DECIMALS || 10_f64.powi(-decimals) < least {
                return None;
            }
        }
    }
    Some(10_f64.powi(-decimals))
}

fn is_multiple(x: f64, decimals: i32) -> bool {
    let counts = x * 10_f64.powi(decimals);
    (counts - counts.round()).abs() < DOUBLE
}

/// Stamps without a gap between them: an even clock's steps differ by one rounding.
fn runs(t: &[f64], rounding_s: f64) -> Option<Vec<Range<usize>>> {
    let longest = longest_step(t, rounding_s)?;
    let gaps = (1..t.len()).filter(|k| t[*k] - t[k - 1] > longest);
    let mut begins: Vec<usize> = std::iter::once(0).chain(gaps).collect();
    if begins.len() as f64 > 1.0 + GAPS * t.len() as f64 {
        return None;
    }
    begins.push(t.len());
    Some(begins.windows(2).map(|pair| pair[0]..pair[1]).collect())
}

/// The longest step that rounding makes, s. Where a step is hardly longer than a rounding, a row that is lost or comes twice
/// looks like one: then only what is usual is rounding.
fn longest_step(t: &[f64], rounding_s: f64) -> Option<f64> {
    let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let twentieth = steps.len() / 20;
    let least = *steps.select_nth_unstable_by(twentieth, f64::total_cmp).1;
    let longer = steps.iter().filter(|x| **x > least + 0.5 * rounding_s);
    let are_rare = (longer.count() as f64) < RARE * steps.len() as f64;
    let mut shorter = steps.iter().filter(|x| **x < least - 0.5 * rounding_s);
    match least < 1.5 * rounding_s {
        true if shorter.next().is_some() => None,
        true if are_rare => Some(least + 0.5 * rounding_s),
        _ => Some(least + 1.5 * rounding_s),
    }
}

/// Time between two samples by least squares over all runs, each with a beginning of its own.
fn slope(t: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let (mut product, mut square) = (0.0, 0.0);
    for run in runs {
        let middle = 0.5 * (run.len() as f64 - 1.0);
        let begin = t[run.start];
        for (k, x) in t[run.clone()].iter().enumerate() {
            product += (k as f64 - middle) * (x - begin);
            square += (k as f64 - middle).powi(2);
        }
    }
    (square > 0.0).then(|| product / square)
}

/// Times of a run on the line of a slope through its mean.
fn on_line(t: &[f64], run: &Range<usize>, step_s: f64) -> impl Iterator<Item = f64> + use<> {
    let stamps = &t[run.clone()];
    let count = stamps.len() as f64;
    let mean = stamps.iter().map(|x| x - stamps[0]).sum::<f64>() / count;
    let begin = stamps[0] + (mean - 0.5 * (count - 1.0) * step_s);
    (0..stamps.len()).map(move |k| begin + step_s * k as f64)
}

/// From the lowest to the highest stamp about that line, s.
fn spread(t: &[f64], run: &Range<usize>, step_s: f64) -> f64 {
    let stamps = &t[run.clone()];
    let off = on_line(t, run, step_s).zip(stamps).map(|(on, x)| x - on);
    let (low, high) = off.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(rate_hz: f64, decimals: i32, samples: u32) -> Vec<f64> {
        let scale = 10_f64.powi(decimals);
        let all = (0..samples).map(|k| f64::from(k) / rate_hz);
        all.map(|t| (scale * t).round() / scale).collect()
    }

    /// Share of a step that least squares can miss where every stamp is off by half a rounding: `r/2 sum|k| / sum k^2`.
    fn worst(even: &Even) -> f64 {
        1.5 * even.rounding_s / (even.t.len() as f64 * even.step_s)
    }

    #[test]
    fn a_line_through_rounded_stamps_has_the_rate() {
        let cases = [
            (3000.0, 3),
            (4000.0, 4),
            (7500.0, 4),
            (8000.0, 4),
            (12_800.0, 5),
            (12_800.0, 6),
            (16_000.0, 4),
        ];
        for (rate_hz, decimals) in cases {
            let t = stamps(rate_hz, decimals, 30_000);
            let even = even(&t).expect("an even clock");
            assert!(
                (even.step_s * rate_hz - 1.0).abs() < worst(&even),
                "{rate_hz}"
            );
            assert!((even.rounding_s - 10_f64.powi(-decimals)).abs() < 1e-12);
            assert!(
                even.told().contains(&format!("; {rate_hz} Hz")),
                "{}",
                even.told()
            );
            let truth = (0..t.len()).map(|k| k as f64 / rate_hz);
            let off = truth.zip(&even.t).map(|(a, b)| (a - b).abs());
            // The mean of rounded halves may lie off by half a rounding, the same for all.
            assert!(
                off.fold(0.0, f64::max) < 0.51 * even.rounding_s,
                "{rate_hz}"
            );
        }
    }

    #[test]
    fn roundings_are_told_in_their_unit() {
        let told = [1.0, 1e-1, 1e-3, 1e-4, 1e-6].map(time);
        assert_eq!(told, ["1 s", "0.1 s", "1 ms", "0.1 ms", "1 us"]);
    }

    #[test]
    fn what_is_exact_irregular_or_too_short_stays() {
        let exact = stamps(10_000.0, 4, 20_000);
        assert!(even(&exact).is_none());
        assert!(even(&stamps(4000.0, 4, 100)).is_none());
        let full: Vec<f64> = (0..9000).map(|k| f64::from(k) / 12_800.0).collect();
        assert!(even(&full).is_none());
        // Two rates, and steps that scatter by three roundings.
        let mut two = stamps(4000.0, 4, 10_000);
        two.extend(stamps(5000.0, 4, 10_000).iter().map(|t| t + 2.5));
        assert!(even(&two).is_none());
        let scattered: Vec<f64> = (0..10_000_u32)
            .map(|k| 1e-4 * f64::from(10 * k + (7 * k) % 4))
            .collect();
        assert!(even(&scattered).is_none());
    }

    #[test]
    fn a_row_that_comes_twice_is_no_rounding() {
        for rate_hz in [4000.0, 8000.0, 10_000.0, 16_000.0] {
            let mut t = stamps(rate_hz, 4, 20_000);
            t.insert(9000, t[9000]);
            assert!(even(&t).is_none(), "{rate_hz}");
        }
    }

    /// A lost row at 10 kHz steps by two roundings, as would a clock a little slower.
    #[test]
    fn a_row_that_is_lost_is_no_rounding() {
        for rate_hz in [5000.0, 8000.0, 10_000.0, 16_000.0] {
            let mut t = stamps(rate_hz, 4, 20_000);
            t.remove(9000);
            let is_kept = |even: Even| even.t[9000] - even.t[8999] > 1.5 * even.step_s;
            assert!(even(&t).is_none_or(is_kept), "{rate_hz}");
        }
    }

    #[test]
    fn gaps_stay_where_they_are() {
        let mut t = stamps(4000.0, 4, 20_000);
        t.drain(7000..7100);
        t.remove(12_000);
        let even = even(&t).expect("runs of one rate");
        let worst = worst(&even);
        assert!((even.step_s * 4000.0 - 1.0).abs() < worst);
        let step = |k: usize| 4000.0 * (even.t[k] - even.t[k - 1]);
        // The mean of a run is off by half a rounding at most, which is 0.2 steps.
        assert!((step(7000) - 101.0).abs() < 0.4 && (step(12_000) - 2.0).abs() < 0.4);
        let others = (1..t.len()).filter(|k| ![7000, 12_000].contains(k));
        assert!(others.into_iter().all(|k| (step(k) - 1.0).abs() < worst));
    }
}
