//! The decision: a generalised likelihood ratio with the departures of a healthy motor marginalised.
//!
//! ```text
//! H = sum A' R^-1 A     b = -sum A' R^-1 z
//! absolute:  P = 1                m = m_0                     forgets a tenth a cycle         a fault that was there before
//! onset:     P = 1 + 0.3 H_old    m = P^-1 (0.3 b_old + m_0)  the latest four to eight cycles against all older ones
//! e = b - H m     u = P (P+H)^-1 e     W = H - H (P+H)^-1 H     T_h = v_h' u/sqrt(v_h' W v_h)
//! ```
//!
//! `m_0` is where the prior stands once the rows are taken at a winding temperature of their own. A cause of which the cycles say
//! next to nothing (`W` small) has T = 0.

use crate::departures::{ALL, HYPOTHESES, Hypothesis, UNKNOWNS, place};
use crate::information::{Factor, Information, Symmetric, Vector, White, dot};

/// What the absolute test keeps from one cycle to the next.
const ABSOLUTE_KEEP: f32 = 0.9;
/// The same for the baseline of the onset test.
const BASELINE_KEEP: f32 = 0.98;
/// Share of the baseline that counts: a healthy motor drifts against its own past.
const BASELINE_SHARE: f32 = 0.3;
/// Cycles from which on a baseline is one.
const LEAST_BASELINE: u16 = 10;
/// Cycles in a block of the onset test.
const BLOCK: u8 = 4;
/// Cycles running beyond the limit that raise an alarm.
const RUNNING: u8 = 2;
/// Cycles after which the cause is named.
const NAMED_AFTER: u8 = 20;
/// Healthy cycles that end an alarm.
const QUIET: u8 = 50;
/// Least information about a cause, in units of its prior.
const LEAST_INFORMATION: f32 = 1e-3;

/// Limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// `T` beyond which a cycle speaks of a fault.
    pub statistic: f32,
    /// The same for the squared length of a cycle's rows, nine degrees of freedom.
    pub square: f32,
}

/// What all causes score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores {
    /// `T` of each hypothesis.
    pub statistics: [f32; HYPOTHESES],
    /// `sqrt(v' W v)`: one over the standard deviation of the size, in units of the prior.
    weights: [f32; HYPOTHESES],
}

/// The likeliest cause with its statistic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    /// Place among [`ALL`].
    pub hypothesis: usize,
    /// `T`.
    pub statistic: f32,
}

/// The alarm's course.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Course {
    #[default]
    Quiet,
    /// Raised so many judged cycles ago.
    Raised(u8),
    /// Named; so many healthy cycles since.
    Named(u8),
}

/// All that the decision remembers: five times 252 numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decision {
    absolute: Information,
    baseline: Information,
    waiting: Information,
    latest: Information,
    /// What came since the alarm, for a name that its transient does not colour.
    since: Information,
    in_block: u8,
    baseline_cycles: u16,
    running: u8,
    course: Course,
    /// Prior mean of the heating, in units of its prior: minus what the rows are already taken at.
    heating_prior: f32,
}

/// What one judged cycle came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Largest `|T|`.
    pub best: Best,
    /// Squared length of the cycle's rows.
    pub square: f32,
    /// The alarm was raised with this cycle.
    pub raised: bool,
    /// Scores of the causes twenty judged cycles after the alarm.
    pub named: Option<Scores>,
    /// Heating against what the rows were taken at, and its standard deviation, in units of the prior.
    pub heating: [f32; 2],
}

impl Decision {
    /// Takes one judged cycle.
    #[inline(never)]
    pub fn take(&mut self, cycle: &White, limits: &Limits) -> Outcome {
        self.remember(cycle);
        let (absolute, heating) = self.absolute(&self.absolute);
        let scores = absolute.strongest(&self.onset());
        let best = scores.best_of(|_, _| true);
        let square = squared_length(cycle);
        let beyond = best.statistic.abs() > limits.statistic || square > limits.square;
        let raised = self.follow(beyond);
        let named = self.name(&scores);
        Outcome {
            best,
            square,
            raised,
            named,
            heating,
        }
    }

    /// A cycle that cannot be judged: the absolute test forgets.
    pub fn pass(&mut self) {
        self.absolute.fade(ABSOLUTE_KEEP);
        self.running = 0;
    }

    /// Whether the alarm is on.
    pub fn is_alarmed(&self) -> bool {
        self.course != Course::Quiet
    }

    fn remember(&mut self, cycle: &White) {
        self.absolute.fade(ABSOLUTE_KEEP);
        self.absolute.add(cycle);
        self.latest.add(cycle);
        if matches!(self.course, Course::Raised(_)) {
            self.since.add(cycle);
            return;
        }
        self.in_block += 1;
        if self.in_block >= BLOCK {
            self.end_block();
        }
    }

    /// The oldest block joins the baseline.
    fn end_block(&mut self) {
        let blocks = libm::powf(BASELINE_KEEP, f32::from(self.in_block));
        self.baseline.fade(blocks);
        self.baseline.merge(&self.waiting);
        let counted = u16::from(self.in_block);
        self.baseline_cycles = self.baseline_cycles.saturating_add(counted);
        self.waiting = core::mem::take(&mut self.latest);
        self.in_block = 0;
    }

    /// Against the priors alone; and what that says of the heating.
    fn absolute(&self, seen: &Information) -> (Scores, [f32; 2]) {
        let prior = self.prior_mean();
        let none = Symmetric::default();
        let factor = seen.matrix.with_prior(1.0).factorise();
        let e = beyond(seen, &prior);
        let moved = factor.solve(&e);
        let mut unit = [0.0; UNKNOWNS];
        set(&mut unit, place::HEATING, 1.0);
        let white = factor.whiten(&unit);
        let mean = entry(&moved, place::HEATING) + self.heating_prior;
        let deviation = libm::sqrtf(dot(&white, &white));
        let scores = score(&none.with_prior(1.0), &factor, &moved);
        (scores, [mean, deviation])
    }

    /// The latest cycles against all older ones.
    fn onset(&self) -> Scores {
        let baseline = self.baseline_cycles;
        if baseline < LEAST_BASELINE + 2 * u16::from(BLOCK) {
            return Scores::NOTHING;
        }
        let prior = self.baseline.matrix.with_prior(BASELINE_SHARE);
        let mut known = self.prior_mean();
        for (x, b) in known.iter_mut().zip(self.baseline.vector) {
            *x += BASELINE_SHARE * b;
        }
        let mean = prior.factorise().solve(&known);
        let mut seen = self.waiting;
        seen.merge(&self.latest);
        let factor = prior.plus(&seen.matrix).factorise();
        let moved = factor.solve(&beyond(&seen, &mean));
        score(&prior, &factor, &moved)
    }

    fn prior_mean(&self) -> Vector {
        let mut mean = [0.0; UNKNOWNS];
        set(&mut mean, place::HEATING, self.heating_prior);
        mean
    }

    /// Two cycles running raise the alarm.
    fn follow(&mut self, beyond: bool) -> bool {
        self.running = if beyond {
            self.running.saturating_add(1)
        } else {
            0
        };
        match self.course {
            Course::Quiet if self.running >= RUNNING => {
                self.course = Course::Raised(0);
                self.since = Information::default();
                return true;
            }
            Course::Named(_) if beyond => self.course = Course::Named(0),
            Course::Named(QUIET) => self.course = Course::Quiet,
            Course::Named(quiet) => self.course = Course::Named(quiet + 1),
            Course::Quiet | Course::Raised(_) => {}
        }
        false
    }

    fn name(&mut self, scores: &Scores) -> Option<Scores> {
        let Course::Raised(cycles) = self.course else {
            return None;
        };
        if cycles < NAMED_AFTER {
            self.course = Course::Raised(cycles + 1);
            return None;
        }
        self.course = Course::Named(0);
        let (since, _) = self.absolute(&self.since);
        let named = scores.strongest(&since);
        // What follows is judged against a past of its own.
        (self.waiting, self.latest) = (Information::default(), Information::default());
        (self.baseline, self.baseline_cycles, self.in_block) = (Information::default(), 0, 0);
        Some(named)
    }

    /// From now on the rows are taken at a rise that lies `delta` further on, in units of the prior.
    #[inline(never)]
    pub fn revise_heating(&mut self, delta: f32) {
        self.heating_prior -= delta;
        for store in [
            &mut self.absolute,
            &mut self.baseline,
            &mut self.waiting,
            &mut self.latest,
            &mut self.since,
        ] {
            store.shift(place::HEATING, delta);
        }
    }
}

/// `b - H m`.
fn beyond(seen: &Information, mean: &Vector) -> Vector {
    let mut e = seen.vector;
    for (x, expected) in e.iter_mut().zip(seen.matrix.times(mean)) {
        *x -= expected;
    }
    e
}

/// `T_h` of every cause: with `y = (P+H)^-1 e` is `u = P y`, and `W = P - P (P+H)^-1 P`.
#[inline(never)]
fn score(prior: &Symmetric, factor: &Factor, y: &Vector) -> Scores {
    let u = prior.times(y);
    let mut scores = Scores::NOTHING;
    let places = scores.statistics.iter_mut().zip(&mut scores.weights);
    for (hypothesis, (statistic, weight)) in ALL.iter().zip(places) {
        let v = hypothesis.direction();
        let p = prior.times(&v);
        let white = factor.whiten(&p);
        let information = dot(&v, &p) - dot(&white, &white);
        if information > LEAST_INFORMATION * dot(&v, &p) {
            *weight = libm::sqrtf(information);
            *statistic = admitted(hypothesis, dot(&v, &u) / *weight);
        }
    }
    scores
}

/// A resistance in series only ever adds.
fn admitted(hypothesis: &Hypothesis, statistic: f32) -> f32 {
    if hypothesis.cause.only_adds() {
        statistic.max(0.0)
    } else {
        statistic
    }
}

impl Scores {
    const NOTHING: Scores = Scores {
        statistics: [0.0; HYPOTHESES],
        weights: [0.0; HYPOTHESES],
    };

    /// Of each cause the stronger of two statistics.
    fn strongest(&self, other: &Scores) -> Scores {
        let mut both = *self;
        let places = both.statistics.iter_mut().zip(&mut both.weights);
        for ((t, w), (t_other, w_other)) in places.zip(other.statistics.iter().zip(&other.weights))
        {
            if t_other.abs() > t.abs() {
                (*t, *w) = (*t_other, *w_other);
            }
        }
        both
    }

    /// The cause with the largest `|T|` among those of which `admits` accepts the size, in units of the prior.
    pub fn best_of(&self, admits: impl Fn(&Hypothesis, f32) -> bool) -> Best {
        let mut best = Best {
            hypothesis: 0,
            statistic: 0.0,
        };
        let all = ALL.iter().zip(self.statistics.iter().zip(&self.weights));
        for (k, (hypothesis, (t, w))) in all.enumerate() {
            let size = t / w.max(f32::MIN_POSITIVE);
            if t.abs() > best.statistic.abs() && admits(hypothesis, size) {
                (best.hypothesis, best.statistic) = (k, *t);
            }
        }
        best
    }
}

impl Scores {
    /// Probability of one cause among those of which `admits` accepts the size: each explains the rows with the likelihood ratio
    /// `exp(T^2/2)`, and none is likelier beforehand.
    pub fn probability(&self, of: &Best, admits: impl Fn(&Hypothesis, f32) -> bool) -> f32 {
        let best = of.statistic * of.statistic;
        let all = ALL.iter().zip(self.statistics.iter().zip(&self.weights));
        let weights = all.map(|(hypothesis, (t, w))| {
            let size = t / w.max(f32::MIN_POSITIVE);
            match admits(hypothesis, size) {
                true => libm::expf(0.5 * (t * t - best)),
                false => 0.0,
            }
        });
        1.0 / weights.sum::<f32>().max(1.0)
    }
}

/// `z' (1 + A A')^-1 z = z'z - b' (1 + A'A)^-1 b`: nine degrees of freedom on a healthy motor.
fn squared_length(cycle: &White) -> f32 {
    let mut own = Information::default();
    own.add(cycle);
    let explained = own.matrix.with_prior(1.0).factorise().whiten(&own.vector);
    dot(&cycle.rows, &cycle.rows) - dot(&explained, &explained)
}

fn entry(x: &[f32], k: usize) -> f32 {
    x.get(k).copied().unwrap_or_default()
}

fn set(x: &mut [f32], k: usize, value: f32) {
    if let Some(place) = x.get_mut(k) {
        *place = value;
    }
}
