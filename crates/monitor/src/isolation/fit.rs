//! How well one cause explains a departure, all in white rows.

use core::f32::consts::LN_2;
use covariance::dot;

use super::cause::Cause;
use super::healthy::Row;
use super::ln;

/// Where a cause moves the white rows, per relative change.
pub(super) struct Direction<'a> {
    pub along: &'a [f32],
    /// A second direction: see [`Cause::adds_across`].
    pub across: Option<&'a [f32]>,
}

/// A departure in white rows.
#[derive(Clone, Copy)]
pub(super) struct Departure<'a> {
    /// The rows.
    pub white: &'a [f32],
    /// What they come to.
    pub total: Total,
}

/// What all rows of a departure come to.
#[derive(Clone, Copy)]
pub(super) struct Total {
    /// Squared length.
    pub square: f32,
    /// How many rows are known.
    pub known: f32,
    /// How many of these are of the positive sequence.
    known_positive: f32,
}

impl Total {
    /// Of these rows, of which those are known.
    pub(super) fn of(white: &[f32], known: &[bool]) -> Self {
        let count = |known: &[bool]| known.iter().filter(|known| **known).count() as f32;
        Total {
            square: dot(white, white),
            known: count(known),
            known_positive: count(known.get(..POSITIVE).unwrap_or_default()),
        }
    }
}

impl Departure<'_> {
    /// What a cause of all phases may leave, which makes no negative and no zero sequence: squared length, and in how many rows.
    fn positive_beside(&self, along: &[f32], size: f32) -> (f32, f32) {
        let rows = self.white.iter().zip(along).take(POSITIVE);
        let left = rows.map(|(x, along)| x - size * along);
        (left.map(|x| x * x).sum(), self.total.known_positive)
    }
}

/// Rows of the positive sequence come first.
const POSITIVE: usize = Row::Negative as usize;

/// Least squares along a cause's directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    cause: Cause,
    /// Squared length of the direction per unit change.
    information: f32,
    /// Change along the direction, beside the one across it.
    along: f32,
    /// Squared length of the departure along the direction.
    square: f32,
    /// The part across it, where there is one.
    across: Option<Across>,
    /// Squared length of the departure that is left over in the rows that a wrong direction may reach.
    beside: f32,
    /// How many those are, beside the directions.
    others: f32,
}

/// What of a departure lies across a direction.
#[derive(Clone, Copy, Debug)]
struct Across {
    /// Squared length of the second direction beside the first, per unit change.
    information: f32,
    change: f32,
    /// How much of the first direction a unit of the second has in it.
    overlap: f32,
}

impl Fit {
    /// Of one cause.
    #[inline(never)]
    pub(super) fn of(cause: Cause, direction: &Direction<'_>, departure: &Departure<'_>) -> Self {
        let fit = Fit::along(cause, direction.along, departure);
        let Some(rows) = direction.across else {
            return fit;
        };
        let mut across = fit.across(direction.along, rows, departure);
        let mut along = fit.along;
        if cause.adds_across() {
            across.change = across.change.max(0.0);
            along -= across.overlap * across.change;
        }
        if along < 0.0 && across.change > 0.0 && cause.adds_across() {
            return Fit::along(cause, rows, departure);
        }
        Fit {
            along,
            beside: (fit.beside - across.square()).max(0.0),
            others: (fit.others - 1.0).max(0.0),
            across: Some(across),
            ..fit
        }
    }

    fn along(cause: Cause, direction: &[f32], departure: &Departure<'_>) -> Self {
        let information = dot(direction, direction);
        let along = dot(direction, departure.white) / information.max(LEAST_INFORMATION);
        let square = information * along * along;
        let (beside, rows) = match cause.phase() {
            Some(_) => (departure.total.square - square, departure.total.known),
            None => departure.positive_beside(direction, along),
        };
        Fit {
            cause,
            information,
            along,
            square,
            across: None,
            beside: beside.max(0.0),
            others: (rows - 1.0).max(0.0),
        }
    }

    /// Beside this fit along `first`.
    fn across(&self, first: &[f32], second: &[f32], departure: &Departure<'_>) -> Across {
        let overlap = dot(second, first) / self.information.max(LEAST_INFORMATION);
        let length = dot(second, second);
        let own = length - overlap * overlap * self.information;
        let information = if own > LEAST_ASIDE * length { own } else { 0.0 };
        let found = dot(second, departure.white) - overlap * self.along * self.information;
        let change = if information > 0.0 {
            found / information
        } else {
            0.0
        };
        Across {
            information,
            change,
            overlap,
        }
    }

    /// Relative change that explains the departure best.
    pub(super) fn change(&self) -> f32 {
        self.cause.change(self.size())
    }

    /// The same along the directions, as if rows grew in proportion.
    pub(super) fn size(&self) -> f32 {
        match &self.across {
            Some(across) if self.cause.adds_across() => {
                processor::sqrtf(self.along * self.along + across.change * across.change)
            }
            _ => self.along,
        }
    }

    /// Squared length of the departure along the directions, where the sign of the change is possible, else 0.
    pub(super) fn square(&self) -> f32 {
        match self.is_impossible() {
            true => 0.0,
            false => self.square + self.across.map_or(0.0, |across| across.square()),
        }
    }

    fn is_impossible(&self) -> bool {
        self.cause.only_adds() && self.along < 0.0
    }

    /// Logarithm of the Bayes factor against health for a change of the cause's typical size, normally distributed, or of a
    /// larger one, rare in proportion: a loose contact may have any resistance. The direction is only roughly the computed one.
    pub(super) fn score(&self) -> f32 {
        if self.is_impossible() {
            return IMPOSSIBLE;
        }
        let size = self.size().abs();
        let typical = self.cause.typical_size();
        let (spread, rarity) = if size > typical {
            (size, ln(size / typical))
        } else {
            (typical, 0.0)
        };
        let along = wider(self.information * spread * spread, self.square);
        let across = self.across.map_or(0.0, |across| {
            if self.cause.adds_across() {
                wider(across.information * spread * spread, across.square()) + LN_2
            } else {
                wider(across.information * size * size, across.square())
            }
        });
        let beside = astray(self.cause, self.square(), self.beside, self.others);
        let sign = if self.cause.only_adds() { LN_2 } else { 0.0 };
        along + across + beside + sign - rarity
    }
}

/// Logarithm of how much better a direction that is only roughly the computed one explains what is left over in other rows: its squared
/// length, and in how many.
#[inline(always)]
fn astray(cause: Cause, square: f32, beside: f32, others: f32) -> f32 {
    let astray = cause.looseness() * cause.looseness() * square;
    0.5 * beside * (astray / (1.0 + astray)) - 0.5 * others * ln(1.0 + astray)
}

/// Two causes at once: the logarithm of their Bayes factor against health, and the relative change of the first.
#[inline(never)]
pub(super) fn of_both(
    [first, second]: [Cause; 2],
    directions: &Direction<'_>,
    departure: &Departure<'_>,
) -> (f32, f32) {
    let fit = Fit::of(first, directions, departure);
    let Some(across) = fit.across else {
        return (IMPOSSIBLE, 0.0);
    };
    let size = fit.along - across.overlap * across.change;
    let spread = first.typical_size().max(size.abs());
    let own = wider(fit.information * spread * spread, fit.square);
    let spread = second.typical_size().max(across.change.abs());
    let more = wider(across.information * spread * spread, across.square());
    let beside = astray(first, fit.square + across.square(), fit.beside, fit.others);
    (own + more + beside - LN_SECOND, first.change(size))
}

/// Logarithm of how rarely something else is wrong at the same time: a belief, one in a hundred.
const LN_SECOND: f32 = 4.605_17;

impl Across {
    /// Squared length of the departure along it.
    fn square(&self) -> f32 {
        self.information * self.change * self.change
    }
}

/// Logarithm of how much better a normal distribution with the variance `more` beside 1 explains one direction's squared length.
fn wider(more: f32, square: f32) -> f32 {
    // The share first: products of lengths may exceed single precision.
    0.5 * square * (more / (1.0 + more)) - 0.5 * ln(1.0 + more)
}

/// Share of its length that a second direction must have beside the first: single precision tells no less.
const LEAST_ASIDE: f32 = 1e-5;
/// A direction without length says nothing about its cause.
pub(super) const LEAST_INFORMATION: f32 = 1e-12;
/// Score of a cause whose sign is impossible.
pub(super) const IMPOSSIBLE: f32 = -1e3;
