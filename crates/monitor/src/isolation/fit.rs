//! How well one cause explains a departure, all in white rows.

use core::f32::consts::LN_2;

use super::cause::Cause;
use super::healthy::Row;
use super::ln;

/// Where a cause moves the white rows.
pub(super) struct Direction<'a> {
    /// Per relative change.
    pub along: &'a [f32],
    /// A second direction, where there is one.
    pub across: Option<Across<&'a [f32]>>,
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

/// A second direction of a cause.
#[derive(Clone, Copy)]
pub(crate) enum Across<T> {
    /// Where a standard deviation of what turns the direction moves it sideways, per relative change.
    Turned(T),
    /// A part of its own, per relative change, that only adds.
    Added(T),
}

impl<T> Across<T> {
    /// The same kind of direction, passed through `f`.
    pub(super) fn map<'a, U>(&'a self, f: impl FnOnce(&'a T) -> U) -> Across<U> {
        match self {
            Across::Turned(rows) => Across::Turned(f(rows)),
            Across::Added(rows) => Across::Added(f(rows)),
        }
    }
}

/// Least squares along a cause's directions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fit {
    /// Squared length of the direction per unit change.
    information: f32,
    /// Change along the direction, beside the one across it.
    along: f32,
    /// Squared length of the departure along the direction.
    first: f32,
    /// The part across it.
    second: Second,
    /// Squared length of the departure that is left over in the rows that a wrong direction may reach.
    beside: f32,
    /// How many those are, beside the directions.
    others: f32,
}

/// What of a departure lies across a direction.
#[derive(Clone, Copy, Debug, Default)]
struct Second {
    /// Squared length of the second direction beside the first, per unit change.
    information: f32,
    change: f32,
    /// Whether its change is one of the cause's size and not a share of that.
    is_added: bool,
}

impl Fit {
    /// Of one cause.
    #[inline(never)]
    pub(super) fn of(cause: Cause, direction: &Direction<'_>, departure: &Departure<'_>) -> Self {
        let (along, white) = (direction.along, departure.white);
        let information = dot(along, along);
        let both = dot(along, white) / information.max(LEAST_INFORMATION);
        let first = information * both * both;
        let Some(across) = direction.across else {
            let (beside, others) = match cause.phase() {
                Some(_) => (departure.total.square - first, departure.total.known),
                None => departure.positive_beside(along, both),
            };
            return Fit {
                information,
                along: both,
                first,
                second: Second::default(),
                beside: beside.max(0.0),
                others: (others - 1.0).max(0.0),
            };
        };
        let (rows, is_added) = match across {
            Across::Turned(rows) => (rows, false),
            Across::Added(rows) => (rows, true),
        };
        let overlap = dot(rows, along) / information.max(LEAST_INFORMATION);
        let length = dot(rows, rows);
        let beside = length - overlap * overlap * information;
        let aside = if beside > LEAST_ASIDE * length {
            beside
        } else {
            0.0
        };
        let found = dot(rows, white) - overlap * both * information;
        let change = found / aside.max(LEAST_INFORMATION);
        let change = if aside <= 0.0 || is_added && change < 0.0 {
            0.0
        } else {
            change
        };
        let alone = if is_added {
            both - overlap * change
        } else {
            both
        };
        if alone < 0.0 && change > 0.0 && is_added {
            let second_alone = Direction {
                along: rows,
                across: None,
            };
            return Fit::of(cause, &second_alone, departure);
        }
        Fit {
            along: alone,
            first,
            information,
            second: Second {
                information: aside,
                change,
                is_added,
            },
            beside: (departure.total.square - first - aside * change * change).max(0.0),
            others: (departure.total.known - 2.0).max(0.0),
        }
    }

    /// Change that explains the departure best.
    pub(super) fn size(&self) -> f32 {
        if self.second.is_added {
            let (first, second) = (self.along, self.second.change);
            libm::sqrtf(first * first + second * second)
        } else {
            self.along
        }
    }

    /// Squared length of the departure along the directions.
    pub(super) fn square(&self) -> f32 {
        let second = self.second.information * self.second.change * self.second.change;
        self.first + if self.second.is_added { second } else { 0.0 }
    }

    /// The same where the sign of the change is possible, else 0.
    pub(super) fn possible_square(&self, cause: Cause) -> f32 {
        if self.is_impossible(cause) {
            0.0
        } else {
            self.square()
        }
    }

    fn is_impossible(&self, cause: Cause) -> bool {
        cause.only_adds() && self.along < 0.0
    }

    /// Logarithm of the Bayes factor against health for a change of the cause's typical size, normally distributed, or of a
    /// larger one, rare in proportion: a loose contact may have any resistance. The direction is only roughly the computed one.
    pub(super) fn score(&self, cause: Cause) -> f32 {
        if self.is_impossible(cause) {
            return IMPOSSIBLE;
        }
        let size = self.size().abs();
        let spread = size.max(cause.typical_size());
        let rarity = ln(spread / cause.typical_size());
        let first = wider(self.information * spread * spread, self.first);
        let astray = cause.looseness() * cause.looseness() * self.square();
        let across = self.second.information * self.second.change * self.second.change;
        let second = if self.second.information <= 0.0 {
            0.0
        } else if self.second.is_added {
            wider(self.second.information * spread * spread, across)
        } else {
            wider(astray + self.second.information * size * size, across)
        };
        let straight = 0.5 * self.beside * (astray / (1.0 + astray));
        let beside = straight - 0.5 * self.others * ln(1.0 + astray);
        let signs = match (cause.only_adds(), self.second.is_added) {
            (true, true) => 2.0 * LN_2,
            (true, false) => LN_2,
            (false, _) => 0.0,
        };
        first + second + beside + signs - rarity
    }
}

/// Logarithm of how much better a normal distribution with the variance `more` beside 1 explains one direction's squared length.
fn wider(more: f32, square: f32) -> f32 {
    // The share first: products of lengths may exceed single precision.
    0.5 * square * (more / (1.0 + more)) - 0.5 * ln(1.0 + more)
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Share of its length that a second direction must have beside the first: single precision tells no less.
const LEAST_ASIDE: f32 = 1e-5;
/// A direction without length says nothing about its cause.
pub(super) const LEAST_INFORMATION: f32 = 1e-12;
/// Score of a cause whose sign is impossible.
pub(super) const IMPOSSIBLE: f32 = -1e3;
