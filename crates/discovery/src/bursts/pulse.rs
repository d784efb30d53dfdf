//! Bursts: where an amount over time is there, and where it is gone.

/// Share of the time that bursts take at most: more is the normal state.
const MOST_OF_THE_TIME: f64 = 0.5;
/// Fewest bursts that come and go.
pub(crate) const FEWEST: usize = 3;
/// Most bursts: beyond that they are an oscillation.
const MOST: usize = 200;
/// Threshold above the amount between bursts, in its typical sizes ...
const ABOVE_THE_REST: f64 = 5.0;
/// ... and as a share of what the large ones reach.
const OF_THE_LARGE: f64 = 0.2;
/// Shortest burst and shortest pause, s.
const SHORTEST: f64 = 4e-3;
/// What is left between bursts, root mean square over that inside them.
const QUIET: f64 = 0.35;
/// Share of the area of bursts that those have which end before the recording does, and begin after it.
const THAT_GO: f64 = 0.5;
/// Share of the area of bursts that has one sign: a contact that opens never closes more than before.
const OF_ONE_SIGN: f64 = 0.8;

/// One burst.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulse {
    /// Beginning, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// Amount, in the unit of its place.
    pub size: f64,
}

impl Pulse {
    /// Length, s.
    pub fn length(&self) -> f64 {
        self.to - self.from
    }

    /// Amount times length, in the unit of its place times s.
    pub fn area(&self) -> f64 {
        self.size * self.length()
    }

    /// Share of it within half a step about `t`, s.
    pub fn share(&self, t: f64, step: f64) -> f64 {
        let (from, to) = (t - 0.5 * step, t + 0.5 * step);
        ((self.to.min(to) - self.from.max(from)) / step).clamp(0.0, 1.0)
    }
}

/// The amount of all bursts at the beginning of each of `count` steps.
pub(crate) fn drawn(pulses: &[Pulse], step: f64, count: usize) -> Vec<f64> {
    let mut amount = vec![0.0; count];
    for pulse in pulses {
        let first = (pulse.from / step).floor().max(0.0) as usize;
        let last = ((pulse.to / step).ceil() as usize + 1).min(count);
        for (k, a) in amount.iter_mut().enumerate().take(last).skip(first) {
            *a += pulse.size * pulse.share(k as f64 * step, step);
        }
    }
    amount
}

/// The bursts of an amount; empty where it does not come and go.
pub(crate) fn pulses(amount: &[f64], step: f64) -> Vec<Pulse> {
    let sizes: Vec<f64> = amount.iter().map(|x| x.abs()).collect();
    let large = quantile(&sizes, 0.99);
    // Half of the time is quiet: the typical size there is half way up the lower half.
    let rest = quantile(&sizes, 0.25 * (1.0 + (1.0 - MOST_OF_THE_TIME)));
    let threshold = (ABOVE_THE_REST * rest).max(OF_THE_LARGE * large);
    let mut found = runs(amount, threshold, (SHORTEST / step) as usize);
    found.retain(|run| (run.len() as f64) * step >= SHORTEST);
    let pulses: Vec<Pulse> = found.iter().map(|run| of_run(amount, run, step)).collect();
    let end = (amount.len().saturating_sub(1)) as f64 * step;
    let comes_and_goes = (FEWEST..=MOST).contains(&pulses.len())
        && is_quiet(amount, &pulses, step)
        && mostly_go(&pulses, end)
        && have_one_sign(&pulses);
    match comes_and_goes {
        true => pulses,
        false => Vec::new(),
    }
}

/// The value below which a share of the values lie; zero for none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (share * sorted.len().saturating_sub(1) as f64) as usize;
    sorted.get(at).copied().unwrap_or(0.0)
}

/// Ranges of one sign above the threshold; pauses shorter than `pause` steps belong to them.
fn runs(amount: &[f64], threshold: f64, pause: usize) -> Vec<std::ops::Range<usize>> {
    let mut all: Vec<std::ops::Range<usize>> = Vec::new();
    for (k, x) in amount
        .iter()
        .enumerate()
        .filter(|(_, x)| x.abs() > threshold)
    {
        match all.last_mut() {
            Some(run) if k - run.end < pause.max(1) && amount[run.start].signum() == x.signum() => {
                run.end = k + 1;
            }
            _ => all.push(k..k + 1),
        }
    }
    all
}

/// The burst of a range: its mean, and the places where it passes half of it.
fn of_run(amount: &[f64], run: &std::ops::Range<usize>, step: f64) -> Pulse {
    let inside = &amount[run.clone()];
    let sorted: Vec<f64> = inside.iter().map(|x| x.abs()).collect();
    let level = quantile(&sorted, 0.6);
    let passes = |x: &f64| x.abs() > 0.5 * level;
    let first = inside.iter().position(passes).unwrap_or(0);
    let last = inside.iter().rposition(passes).unwrap_or(inside.len() - 1);
    let sign = inside.iter().sum::<f64>().signum();
    Pulse {
        from: (run.start + first) as f64 * step,
        to: (run.start + last + 1) as f64 * step,
        size: sign * level,
    }
}

/// Whether most of what bursts do, amount times length, is known to come and to go: what stays until the recording ends at `end` (s) may be a
/// step.
fn mostly_go(pulses: &[Pulse], end: f64) -> bool {
    let goes = |p: &&Pulse| p.from > SHORTEST && p.to < end - SHORTEST;
    let area = |of: &mut dyn Iterator<Item = &Pulse>| of.map(|p| p.area().abs()).sum::<f64>();
    area(&mut pulses.iter().filter(goes)) >= THAT_GO * area(&mut pulses.iter())
}

/// Whether bursts are one thing that is there or not: nearly all have one sign.
pub(crate) fn have_one_sign<'a>(pulses: impl IntoIterator<Item = &'a Pulse>) -> bool {
    let (sum, all) = pulses
        .into_iter()
        .map(Pulse::area)
        .fold((0.0f64, 0.0), |(sum, all), area| {
            (sum + area, all + area.abs())
        });
    let sum = sum.abs();
    // Of one sign are `(all + sum) / 2`.
    all + sum >= 2.0 * OF_ONE_SIGN * all
}

/// Whether little is left between the bursts, and they are the exception.
fn is_quiet(amount: &[f64], pulses: &[Pulse], step: f64) -> bool {
    let inside = |k: usize| {
        let t = k as f64 * step;
        pulses
            .iter()
            .any(|p| (p.from - SHORTEST..p.to + SHORTEST).contains(&t))
    };
    let mean = |of: &dyn Fn(usize) -> bool| {
        let squares: Vec<f64> = (0..amount.len())
            .filter(|&k| of(k))
            .map(|k| amount[k].powi(2))
            .collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    };
    let time: f64 = pulses.iter().map(Pulse::length).sum();
    let rare = time < MOST_OF_THE_TIME * step * amount.len() as f64;
    rare && mean(&|k| !inside(k)) < QUIET * mean(&|k| inside(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 2e-4;

    fn three() -> Vec<Pulse> {
        let pulse = |from: f64, to: f64, size: f64| Pulse { from, to, size };
        vec![
            pulse(0.1, 0.13, 5.0),
            pulse(0.4, 0.42, 3.0),
            pulse(0.7, 0.75, 4.0),
        ]
    }

    #[test]
    fn bursts_are_found_with_their_edges_and_sizes() {
        let mut amount = drawn(&three(), STEP, 5000);
        // What a smoother leaves: some per cent everywhere.
        for (k, x) in amount.iter_mut().enumerate() {
            *x += 0.1 * (0.37 * k as f64).sin();
        }
        let found = pulses(&amount, STEP);
        assert_eq!(found.len(), 3);
        for (found, truth) in found.iter().zip(three()) {
            assert!((found.from - truth.from).abs() < 2.0 * STEP, "{found:?}");
            assert!((found.to - truth.to).abs() < 2.0 * STEP, "{found:?}");
            assert!((found.size / truth.size - 1.0).abs() < 0.05, "{found:?}");
        }
    }

    /// A sine, a step that stays and two bursts alone do not come and go.
    #[test]
    fn what_does_not_come_and_go_has_no_bursts() {
        let sine: Vec<f64> = (0..5000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        let step: Vec<f64> = (0..5000).map(|k| f64::from(u8::from(k > 1500))).collect();
        let two = drawn(&three()[..2], STEP, 5000);
        for amount in [sine, step, two, vec![0.0; 5000]] {
            assert!(pulses(&amount, STEP).is_empty());
        }
    }

    /// A resistance that begins to rise and stays: the beginning flickers, what counts does not go.
    #[test]
    fn a_step_that_flickers_as_it_begins_does_not_come_and_go() {
        let mut flickers = three();
        for (k, pulse) in flickers.iter_mut().enumerate() {
            *pulse = Pulse {
                from: 0.7 + 0.02 * k as f64,
                to: 0.71 + 0.02 * k as f64,
                size: 3.0,
            };
        }
        assert_eq!(pulses(&drawn(&flickers, STEP, 5000), STEP).len(), 3);
        flickers.push(Pulse {
            from: 0.77,
            to: 1.1,
            size: 5.0,
        });
        assert!(pulses(&drawn(&flickers, STEP, 5000), STEP).is_empty());
    }

    /// A model that is wrong in steps of the load needs torques of either sign there.
    #[test]
    fn what_pushes_to_both_sides_is_not_one_thing() {
        let mut other = three();
        assert!(have_one_sign(other.iter().chain(&three())));
        other.iter_mut().for_each(|pulse| pulse.size *= -1.0);
        assert!(have_one_sign(&other));
        assert!(!have_one_sign(other.iter().chain(&three())));
        assert!(have_one_sign(&[]));
        // One of three the other way round: nearly half of what the three do.
        let mut turned = three();
        turned[0].size *= -1.0;
        assert_eq!(pulses(&drawn(&three(), STEP, 5000), STEP).len(), 3);
        assert!(pulses(&drawn(&turned, STEP, 5000), STEP).is_empty());
    }

    /// Edges between steps count by their share: the area under a drawn burst is its own.
    #[test]
    fn a_drawn_burst_has_the_area_of_the_burst() {
        let pulse = Pulse {
            from: 0.10003,
            to: 0.13011,
            size: 2.0,
        };
        let area: f64 = drawn(&[pulse], STEP, 1000).iter().sum::<f64>() * STEP;
        assert!((area - 2.0 * pulse.length()).abs() < 1e-12);
    }
}
