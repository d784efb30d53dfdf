//! All causes weighed against one white departure, with the supply's neutral where it was, and with it displaced.
//!
//! Voltages against earth or the supply's neutral hold its displacement `V_0`, which no motor without a neutral feels. What it does
//! is the supply's affair, not a fault of the motor: FAULT rests on the other rows. A voltage channel moves `V_0` and the negative
//! sequence together, and is named by both.

use covariance::{Cholesky, dot};

use super::fit::{Departure, Direction, Fit, Total, of_both};
use super::{Cause, Evidence, ROWS, Row, Rows, ln, score_of_anything, significance_of_anything};

/// Logarithm of how often a supply's neutral has moved since the calibration, against all other times: one in ten, a belief as the next one.
const LN_DISPLACED: f32 = -core::f32::consts::LN_10;
/// A displacement that is usual, as a share of the voltage; a larger one is rare in proportion. As large as the negative sequence
/// that EN 50160 allows a public supply; it sets the zero sequence no limit.
pub(super) const USUAL_DISPLACEMENT: f32 = 0.02;
/// Logarithm of [`USUAL_DISPLACEMENT`].
pub(super) const LN_USUAL_DISPLACEMENT: f32 = -3.912_023;
/// The zero sequence of the voltages is the end of the rows: without it a white vector is its beginning.
const BEFORE_ZERO_VOLTAGE: usize = Row::ZeroVoltage as usize;

/// Where the zero sequence of the currents begins.
const ZERO_CURRENT: usize = Row::ZeroCurrent as usize;

/// Beyond so many standard deviations, one window in 3000, the neutral has moved, whatever else has happened.
const MOVED: f32 = 4.0;

/// A departure in white rows.
pub(super) struct Weighing {
    white: Rows,
    /// Of all rows, and of those before `V_0`.
    totals: [Total; 2],
    /// `None` where `V_0` cannot be told from other rows.
    neutral: Option<Neutral>,
}

/// The supply's neutral beside the one of the calibration.
struct Neutral {
    /// Logarithm of how much better a displaced one explains `V_0` where nothing else has changed.
    better: f32,
    /// What that explanation costs, as a squared length: how rare a displacement of this size is.
    cost: f32,
    has_moved: bool,
}

/// What is said of one cause.
pub(super) struct Weighed {
    /// Logarithm of the Bayes factor against health.
    pub score: f32,
    /// Relative change.
    pub size: f32,
    /// Squared length of the departure that it explains, where its sign is possible.
    pub square: f32,
}

impl Weighing {
    /// `departure`: before it was made white by the factor.
    pub fn new(evidence: &Evidence, cholesky: &Cholesky<ROWS>, departure: &Rows) -> Self {
        let white = cholesky.whiten(departure);
        let known = *evidence.known();
        let is_known = |row: Row| known.get(row as usize).copied().unwrap_or(false);
        let both = is_known(Row::ZeroVoltage) && is_known(Row::Negative);
        let total = |rows: usize| Total::of(first(&white, rows), first(&known, rows));
        Weighing {
            neutral: both.then(|| Neutral::of(cholesky, departure, &white)),
            totals: [total(ROWS), total(BEFORE_ZERO_VOLTAGE)],
            white,
        }
    }

    /// The rows that speak of motor and instrument: all of them while the neutral stays, which also tells the channels' gains from
    /// what the motor does.
    pub fn judged(&self) -> Departure<'_> {
        let [all, without] = self.departures();
        let has_moved = self.neutral.as_ref().is_some_and(|it| it.has_moved);
        if has_moved { without } else { all }
    }

    /// All rows, and those before `V_0`.
    fn departures(&self) -> [Departure<'_>; 2] {
        let [all, without] = self.totals;
        let of = |rows: usize, total: Total| Departure {
            white: first(&self.white, rows),
            total,
        };
        [of(ROWS, all), of(BEFORE_ZERO_VOLTAGE, without)]
    }

    /// Weighs one cause by its white directions.
    pub fn weigh(&self, cause: Cause, along: &Rows, across: Option<&Rows>) -> Weighed {
        let fit = |departure: &Departure<'_>| {
            let rows = departure.white.len();
            let direction = Direction {
                along: first(along, rows),
                across: across.map(|across| first(across, rows)),
            };
            Fit::of(cause, &direction, departure)
        };
        let [all, without] = self.departures();
        let all = fit(&all);
        let square = all.square();
        let Some(neutral) = self.neutral.as_ref().filter(|it| it.matters(square)) else {
            return Weighed::new(&all, square);
        };
        let without = fit(&without);
        let square = neutral.either(square, without.square());
        let health = neutral.better.max(0.0);
        let mut weighed = if without.score() + neutral.better > all.score() {
            let mut weighed = Weighed::new(&without, square);
            weighed.score += neutral.better;
            weighed
        } else {
            Weighed::new(&all, square)
        };
        weighed.score -= health;
        weighed
    }

    /// Whether the voltages show their neutral elsewhere than in the calibration, or the currents a zero sequence that three wires do not carry.
    pub fn zero_sequence_has_moved(&self) -> bool {
        let current = self.white.get(ZERO_CURRENT..BEFORE_ZERO_VOLTAGE);
        let current = current.unwrap_or_default();
        self.neutral.as_ref().is_some_and(|it| it.has_moved)
            || dot(current, current) > MOVED * MOVED
    }

    /// Score of a channel with another cause beside it, by their white directions, and the channel's size: what the zero sequences show is the channel's.
    pub fn weigh_both(&self, causes: [Cause; 2], [along, other]: [&Rows; 2]) -> (f32, f32) {
        let [all, _] = self.departures();
        let directions = Direction {
            along,
            across: Some(other),
        };
        let (score, size) = of_both(causes, &directions, &all);
        let better = self.neutral.as_ref().map_or(0.0, |it| it.better.max(0.0));
        (score - better, size)
    }

    /// Length of the whole departure as a standard deviation that is as rare.
    pub fn significance(&self) -> f32 {
        let [all, without] = self
            .totals
            .map(|it| significance_of_anything(it.square, it.known));
        let Some(neutral) = &self.neutral else {
            return all;
        };
        // Shorter than most departures is negative.
        let longer = without.max(0.0);
        all.min(processor::sqrtf(
            neutral.either(f32::INFINITY, longer * longer),
        ))
    }

    /// Logarithm of the Bayes factor of a departure in any direction.
    pub fn anything(&self) -> f32 {
        let [all, without] = self.totals.map(|it| score_of_anything(it.square, it.known));
        let Some(neutral) = &self.neutral else {
            return all;
        };
        all.max(without + neutral.better) - neutral.better.max(0.0)
    }
}

impl Weighed {
    fn new(fit: &Fit, square: f32) -> Self {
        Weighed {
            score: fit.score(),
            size: fit.change(),
            square,
        }
    }
}

impl Neutral {
    /// Densities of `V_0`: normal with the spread of a displacement, against that of the healthy motor given the rows before.
    fn of(cholesky: &Cholesky<ROWS>, departure: &Rows, white: &Rows) -> Self {
        let square_of_end = |rows: &Rows| {
            let end = rows.get(BEFORE_ZERO_VOLTAGE..).unwrap_or_default();
            dot(end, end)
        };
        let displacement = square_of_end(departure);
        let spread = processor::sqrtf(displacement).max(USUAL_DISPLACEMENT);
        let own: f32 = cholesky
            .deviations()
            .skip(BEFORE_ZERO_VOLTAGE)
            .map(ln)
            .sum();
        // Rare in proportion to its size, in two rows of that spread.
        let there = -0.5 * displacement / (spread * spread) - 3.0 * ln(spread);
        let against = -there - own - LN_DISPLACED - LN_USUAL_DISPLACEMENT;
        let variance: f32 = cholesky.variances().skip(BEFORE_ZERO_VOLTAGE).sum();
        Neutral {
            better: 0.5 * square_of_end(white) - against,
            cost: 2.0 * against.max(0.0),
            has_moved: displacement > 0.5 * MOVED * MOVED * variance,
        }
    }

    /// Whether a displaced neutral may change what is said of a departure of this squared length: one that costs more than all of
    /// it explains nothing.
    fn matters(&self, square: f32) -> bool {
        self.has_moved || self.better > 0.0 || square > self.cost
    }

    /// A squared length that a healthy motor may owe to its own neutral or to a displaced one.
    fn either(&self, all: f32, without: f32) -> f32 {
        if self.has_moved {
            without
        } else {
            all.min(without + self.cost)
        }
    }
}

fn first<T>(rows: &[T; ROWS], count: usize) -> &[T] {
    rows.get(..count).unwrap_or_default()
}

const _: () = assert!(BEFORE_ZERO_VOLTAGE + 2 == ROWS);
