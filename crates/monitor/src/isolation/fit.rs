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
    /// `known`: which rows are known.
    pub(super) fn of(
        cause: Cause,
        direction: &Direction<'_>,
        departure: &[f32],
        known: &[bool],
    ) -> Self {
        let along = direction.along;
        let information = dot(along, along);
        let projected = |rows: &[f32]| dot(rows, along) / information.max(LEAST_INFORMATION);
        let (rows, is_added) = match direction.across {
            Some(Across::Turned(rows)) => (rows, false),
            Some(Across::Added(rows)) => (rows, true),
            None => (&[][..], false),
        };
        let overlap = projected(rows);
        let aside = |k: usize| {
            rows.get(k)
                .map_or(0.0, |row| row - overlap * entry(along, k))
        };
        let numbered = || departure.iter().enumerate();
        let square: f32 = numbered().map(|(k, _)| aside(k) * aside(k)).sum();
        let found: f32 = numbered().map(|(k, x)| aside(k) * x).sum();
        let change = found / square.max(LEAST_INFORMATION);
        let change = if is_added { change.max(0.0) } else { change };
        let both = projected(departure);
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
            return Fit::of(cause, &second_alone, departure, known);
        }
        let reach = match cause.phase() {
            Some(_) => departure.len(),
            None => Row::Negative as usize,
        };
        let left = |(k, x): (usize, &f32)| x - both * entry(along, k) - change * aside(k);
        let beside = numbered().take(reach).map(left).map(|x| x * x).sum();
        let reached = known.iter().take(reach).filter(|known| **known).count();
        let directions = if square > 0.0 { 2.0 } else { 1.0 };
        Fit {
            along: alone,
            first: information * both * both,
            information,
            second: Second {
                information: square,
                change,
                is_added,
            },
            beside,
            others: (reached as f32 - directions).max(0.0),
        }
    }

    /// Change that explains the departure best.
    pub(super) fn size(&self) -> f32 {
        if self.second.is_added {
            libm::hypotf(self.along, self.second.change)
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

fn entry(rows: &[f32], k: usize) -> f32 {
    rows.get(k).copied().unwrap_or(0.0)
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// A direction without length says nothing about its cause.
pub(super) const LEAST_INFORMATION: f32 = 1e-12;
/// Score of a cause whose sign is impossible.
pub(super) const IMPOSSIBLE: f32 = -1e3;
