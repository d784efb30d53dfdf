//! The decision: a generalised likelihood ratio with the departures of a healthy motor marginalised.
//!
//! ```text
//! H = sum A' R^-1 A     b = -sum A' R^-1 z
//! absolute:  P = 1                m = m_0                     forgets a tenth a cycle         a fault that was there before
//! onset:     P = 1 + 0.3 H_old    m = P^-1 (0.3 b_old + m_0)  the latest four to eight cycles against all older ones
//! e = b - H m     u = P (P+H)^-1 e     W = H - H (P+H)^-1 H     T_h = v_h' u/sqrt(v_h' W v_h)
//! ```
//!
//! With `k = P m` and `x = (P+H)^-1 (b + k)` is `u = P x - k`, and `W = P - P (P+H)^-1 P`: one factor a test, no inverse of P.
//!
//! `m_0` is where the prior stands once the rows are taken at a winding temperature of their own. A cause of which the cycles say
//! next to nothing (`W` small) has T = 0.

use crate::departures::{ALL, HYPOTHESES, Hypothesis, UNKNOWNS, place};
pub(crate) mod alarm;

use monitor::Covariance;

use crate::information::{ABREAST, Factor, Information, ROWS, Symmetric, Vector, White, dot};

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
    /// Forgets everything, store by store.
    #[inline(never)]
    pub fn begin_anew(&mut self) {
        let Decision {
            absolute,
            baseline,
            waiting,
            latest,
            since,
            in_block,
            baseline_cycles,
            running,
            course,
            heating_prior,
        } = self;
        for store in [absolute, baseline, waiting, latest, since] {
            *store = Information::default();
        }
        (*in_block, *baseline_cycles, *running) = (0, 0, 0);
        (*course, *heating_prior) = (Course::Quiet, 0.0);
    }

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

    #[inline(never)]
    fn remember(&mut self, cycle: &White) {
        let mut own = Information::default();
        own.add(cycle);
        self.absolute.fade(ABSOLUTE_KEEP);
        self.absolute.merge(&own);
        self.latest.merge(&own);
        if matches!(self.course, Course::Raised(_)) {
            self.since.merge(&own);
            return;
        }
        self.in_block += 1;
        if self.in_block >= BLOCK {
            self.end_block();
        }
    }

    /// The oldest block joins the baseline.
    #[inline(never)]
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
    #[inline(never)]
    fn absolute(&self, seen: &Information) -> (Scores, [f32; 2]) {
        let known = self.prior_mean();
        let mut all = seen.matrix.with_prior(1.0);
        let factor = all.factorise();
        let estimate = factor.solve(&sum(&seen.vector, &known));
        let mut unit = [0.0; UNKNOWNS];
        set(&mut unit, place::HEATING, 1.0);
        let white = factor.whiten(&unit, place::HEATING);
        let mean = entry(&estimate, place::HEATING);
        let deviation = processor::sqrtf(dot(&white, &white));
        let scores = score(None, &factor, &estimate, &known);
        (scores, [mean, deviation])
    }

    /// The latest cycles against all older ones.
    #[inline(never)]
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
        let mut all = prior;
        all.add(&self.waiting.matrix);
        all.add(&self.latest.matrix);
        let seen = sum(&self.waiting.vector, &self.latest.vector);
        let factor = all.factorise();
        let estimate = factor.solve(&sum(&seen, &known));
        score(Some(&prior), &factor, &estimate, &known)
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

    #[inline(never)]
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

fn sum(a: &Vector, b: &Vector) -> Vector {
    let mut sum = *a;
    for (x, y) in sum.iter_mut().zip(b) {
        *x += y;
    }
    sum
}

/// `T_h` of every cause from `x` and `k`; without a prior P is the unit matrix.
#[inline(never)]
fn score(prior: Option<&Symmetric>, factor: &Factor<'_>, x: &Vector, k: &Vector) -> Scores {
    let mut scores = Scores::NOTHING;
    let statistics = scores.statistics.chunks_mut(ABREAST);
    let places = statistics.zip(scores.weights.chunks_mut(ABREAST));
    for (hypotheses, (statistics, weights)) in ALL.chunks(ABREAST).zip(places) {
        let mut columns = [[0.0; ABREAST]; UNKNOWNS];
        // `v' P v` and `v' u`.
        let mut along = [[0.0; 2]; ABREAST];
        for ((n, hypothesis), along) in hypotheses.iter().enumerate().zip(&mut along) {
            let mut column = [0.0; UNKNOWNS];
            match prior {
                Some(prior) => prior.add_columns(hypothesis.first, hypothesis.count, &mut column),
                None => hypothesis.add_direction(&mut column),
            }
            for (row, p) in columns.iter_mut().zip(column) {
                set(row, n, p);
            }
            *along = [
                hypothesis.along(&column),
                dot(&column, x) - hypothesis.along(k),
            ];
        }
        let firsts = hypotheses.iter().map(|hypothesis| hypothesis.first);
        let first = match prior {
            Some(_) => 0,
            None => firsts.min().unwrap_or_default(),
        };
        let explained = factor.squared_lengths(&mut columns, first);
        let places = statistics.iter_mut().zip(weights);
        let all = hypotheses.iter().zip(explained).zip(along).zip(places);
        for (((hypothesis, explained), [believed, shown]), (statistic, weight)) in all {
            let information = believed - explained;
            if information > LEAST_INFORMATION * believed {
                *weight = processor::sqrtf(information);
                *statistic = admitted(hypothesis, shown / *weight);
            }
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

/// `z' (1 + A A')^-1 z`: nine degrees of freedom on a healthy motor.
#[inline(never)]
fn squared_length(cycle: &White) -> f32 {
    let mut covariance = Covariance::of_independent(&[1.0; ROWS]);
    for unknown in 0..UNKNOWNS {
        let mut moved = cycle.sensitivities.iter();
        let moves = [(); ROWS].map(|()| moved.next().map_or(0.0, |row| entry(row, unknown)));
        covariance.add(&moves, 1.0);
    }
    let white = covariance.factorise().whiten(&cycle.rows);
    dot(&white, &white)
}

fn entry(x: &[f32], k: usize) -> f32 {
    x.get(k).copied().unwrap_or_default()
}

fn set(x: &mut [f32], k: usize, value: f32) {
    if let Some(place) = x.get_mut(k) {
        *place = value;
    }
}
