//! Times that a busy machine spoils least: two loops timed alternately, and shortest times.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Times of both loops, one pair after another.
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    first: Vec<f64>,
    second: Vec<f64>,
}

impl Pairs {
    /// Times `count` pairs; which loop goes first alternates.
    pub fn measure(
        count: usize,
        mut first: impl FnMut() -> Duration,
        mut second: impl FnMut() -> Duration,
    ) -> Pairs {
        let mut pairs = Pairs::default();
        for k in 0..count {
            let (a, b) = if k % 2 == 0 {
                let a = first();
                (a, second())
            } else {
                let b = second();
                (first(), b)
            };
            pairs.first.push(a.as_secs_f64());
            pairs.second.push(b.as_secs_f64());
        }
        pairs
    }

    /// Shortest times of the two loops, s: what disturbance can only lengthen.
    pub fn shortest(&self) -> [f64; 2] {
        [&self.first, &self.second].map(|times| times.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// Median times of the two loops, s.
    pub fn medians(&self) -> [f64; 2] {
        [&self.first, &self.second].map(|times| median(times.clone()))
    }

    /// How many times as fast the first loop is as the second: by the shortest times, and the median over pairs.
    pub fn speed_ratios(&self) -> [f64; 2] {
        let [first, second] = self.shortest();
        let paired = self.first.iter().zip(&self.second).map(|(a, b)| b / a);
        [second / first, median(paired.collect())]
    }
}

/// Shortest of `count` runs, s.
pub fn shortest<T>(count: usize, mut run: impl FnMut() -> T) -> f64 {
    let timed = |_| {
        let from = Instant::now();
        black_box(run());
        from.elapsed().as_secs_f64()
    };
    (0..count).map(timed).fold(f64::INFINITY, f64::min)
}

/// Shortest processor time of `count` runs on this thread, s: what others do on the same cores is not in it. Where the system does not
/// tell it (`/proc/thread-self/schedstat`), wall time.
///
/// The system counts in ticks of some milliseconds: a run that is short is repeated, and their mean counts.
pub fn shortest_on_processor<T>(count: usize, mut run: impl FnMut() -> T) -> f64 {
    const LONG_S: f64 = 0.1;
    let repeats = (LONG_S / shortest(2, &mut run)).ceil().max(1.0) as u32;
    let timed = |_| {
        let (from, used) = (Instant::now(), processor_ns());
        (0..repeats).for_each(|_| drop(black_box(run())));
        let spent = match (used, processor_ns()) {
            (Some(from), Some(to)) => (to - from) as f64 * 1e-9,
            _ => from.elapsed().as_secs_f64(),
        };
        spent / f64::from(repeats)
    };
    (0..count).map(timed).fold(f64::INFINITY, f64::min)
}

/// Processor time of this thread so far, ns.
fn processor_ns() -> Option<u64> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    told.split_whitespace().next()?.parse().ok()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
