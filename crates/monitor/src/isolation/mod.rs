//! Which cause explains what a calibrated motor shows: the direction of the evidence, in units of its uncertainty.
//!
//! Residuals `(r2, e_d, e_q)` and the negative and zero sequence form one vector. Each cause moves it in a direction of
//! its own ([`directions`]); what calibration left uncertain and the range of winding temperature give its covariance.
//! A departure that is long in units of that covariance lights FAULT; its direction names the cause.

pub(crate) mod calibrated;
mod cause;
mod directions;
mod evidence;
mod fit;
mod healthy;
mod negative;
mod range;
mod temperature;
mod weighing;

#[cfg(test)]
mod tests;

pub use cause::{ALL_CAUSES, CAUSES, Cause};
use cause::{FIRST_CHANNEL, OF_ALL_PHASES};
pub use healthy::{Healthy, ROWS, Row, Uncertainty};
pub(crate) use range::length;
pub use range::{Beyond, CalibratedRange, Conditions};
pub use temperature::Heating;

use covariance::dot;
pub(crate) use directions::{Bench, impedance};
pub use evidence::Evidence;
pub(crate) use evidence::{PositiveEvidence, Rows, rows_of, rows_of_currents};
use fit::LEAST_INFORMATION;
use temperature::MOST_APART;
pub(crate) use temperature::Temperature;
use weighing::Weighing;

/// What one window says about the causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isolation {
    /// Logarithm of how much better each cause explains the window than health does, in the order of [`ALL_CAUSES`].
    pub scores: [f32; CAUSES],
    /// The same for "something else": a departure in any direction.
    pub unknown: f32,
    /// Change of each quantity that explains the window best, as a share of its healthy value.
    pub sizes: [f32; CAUSES],
    /// Length of the departure along the best cause, or of all of it, in standard deviations of the healthy motor.
    pub significance: f32,
    /// The same departure if the winding could have any temperature: without what was known of it before the window.
    pub at_any_temperature: f32,
    /// Rise of the resistances that explains the window best, and how surely this window alone tells it: winding temperature.
    pub heating: Heating,
    /// How much more the cage's resistance has risen than the winding's, told in the same way.
    pub apart: Heating,
}

impl Isolation {
    /// Weighs all causes, given what is known of the winding's temperature; the cage is as much warmer as in the calibration.
    pub fn of(evidence: &Evidence, healthy: &Healthy, expected: Heating) -> Self {
        Isolation::of_two(evidence, healthy, [expected, Heating::default()])
    }

    /// Weighs all causes, given what is known of the winding's temperature and of how much more the cage has warmed.
    #[inline(never)]
    pub(crate) fn of_two(
        evidence: &Evidence,
        healthy: &Healthy,
        [expected, apart]: [Heating; 2],
    ) -> Self {
        let resistances = evidence.resistances();
        let deviations = [expected.deviation, apart.deviation];
        let covariance = evidence.covariance(healthy, &resistances, deviations);
        let cholesky = covariance.factorise();
        let departure = evidence.departure_at(&resistances, [expected.rise, apart.rise]);
        let weighing = Weighing::new(evidence, &cholesky, &departure);
        let judged = weighing.judged();
        let (square, known) = (judged.total.square, judged.total.known);
        let resistances = resistances.map(|direction| cholesky.whiten(direction));
        let along = Warmth::new(&resistances.heating(), judged.white);
        let parting = Warmth::new(&resistances.parting(), judged.white);
        let mut isolation = Isolation {
            scores: [0.0; CAUSES],
            unknown: weighing.anything(),
            sizes: [0.0; CAUSES],
            significance: weighing.significance(),
            at_any_temperature: significance_of_anything(
                along.square_at_any(square, healthy, expected),
                known,
            ),
            heating: along.implied(Heating::any(healthy).deviation, expected),
            apart: parting.implied(MOST_APART, apart),
        };
        let white = |cause: Cause| match cause {
            Cause::StatorResistance => resistances.stator,
            Cause::RotorResistance => resistances.rotor,
            other => cholesky.whiten(&evidence.direction(other)),
        };
        let mut longest = 0.0_f32;
        let places = isolation.scores.iter_mut().zip(&mut isolation.sizes);
        for ((score, size), cause) in places.zip(ALL_CAUSES) {
            let direction = white(cause);
            let across = evidence.across(cause);
            let across = across.map(|rows| cholesky.whiten(&rows));
            let weighed = weighing.weigh(cause, &direction, across.as_ref());
            *score = weighed.score;
            *size = weighed.size;
            longest = weighed.square.max(longest);
        }
        isolation.significance = processor::sqrtf(longest).max(isolation.significance);
        if weighing.zero_sequence_has_moved() && isolation.is_in_a_phase() {
            isolation.doubt_phase(&weighing, &white);
        }
        isolation.doubt_heating(expected.rise, Heating::any(healthy).deviation);
        isolation
    }

    /// Whether something in one phase of the motor is the likeliest cause.
    fn is_in_a_phase(&self) -> bool {
        let mut best = (self.unknown, false);
        for (score, cause) in self.scores.iter().zip(ALL_CAUSES) {
            if *score > best.0 {
                best = (*score, cause.phase().is_some() && !cause.is_sensor());
            }
        }
        best.1
    }

    /// Where a short or a contact seems to have come together with a zero sequence, which neither makes: a channel's gain beside a change of the whole
    /// motor shows the same, and makes it.
    #[inline(never)]
    fn doubt_phase(&mut self, weighing: &Weighing, white: &dyn Fn(Cause) -> Rows) {
        let all = self.scores.iter_mut().zip(&mut self.sizes).zip(ALL_CAUSES);
        for ((score, size), channel) in all.skip(FIRST_CHANNEL) {
            let along = white(channel);
            for other in ALL_CAUSES.into_iter().take(OF_ALL_PHASES) {
                let both = weighing.weigh_both([channel, other], [&along, &white(other)]);
                if both.0 > *score {
                    (*score, *size) = both;
                }
            }
        }
    }

    /// Where a large rise was taken for heat and one of the two resistances seems to have fallen by most of it, the other one has risen alone, from
    /// before the first window on: a resistance does not fall.
    fn doubt_heating(&mut self, rise: f32, any: f32) {
        let [its_stator, its_rotor, ..] = &mut self.scores;
        let [stator, rotor, ..] = &mut self.sizes;
        if rise < DOUBTED * any {
            return;
        }
        let was = [(*its_stator, *stator), (*its_rotor, *rotor)];
        for (score, size, fallen) in [(its_stator, stator, was[1]), (its_rotor, rotor, was[0])] {
            let (other, change) = alone(fallen, rise, any);
            if fallen.1 < -TAKEN_BACK * rise && other > *score {
                (*score, *size) = (other, change);
            }
        }
    }

    /// Whether the instrument is a likelier cause than the motor.
    pub fn points_to_sensor(&self) -> bool {
        let (probabilities, _) = self.probabilities();
        let sensors = probabilities.iter().zip(ALL_CAUSES);
        let sum: f32 = sensors
            .filter(|(_, cause)| cause.is_sensor())
            .map(|(p, _)| p)
            .sum();
        sum > 0.5
    }

    /// Probabilities of the causes in the order of [`ALL_CAUSES`], and of "something else"; all held equally likely
    /// beforehand.
    #[inline(never)]
    pub fn probabilities(&self) -> ([f32; CAUSES], f32) {
        probabilities(&self.scores, self.unknown)
    }
}

/// Score and size of a resistance that has risen alone, where a rise of both and a fall of the other one (`score`, `size`) explain the window: a
/// winding that is as warm as the other one is likelier by how much nearer to the calibration that is.
fn alone((score, size): (f32, f32), rise: f32, any: f32) -> (f32, f32) {
    let heat = rise + size;
    let likelier = 0.5 * (rise * rise - heat * heat) / (any * any).max(LEAST_INFORMATION);
    let change = (1.0 + rise) / (1.0 + heat).max(LEAST_LEFT) - 1.0;
    (score + likelier, change)
}

/// Share of the rise that the fall takes back at least.
const TAKEN_BACK: f32 = 0.5;
/// Rise, in deviations of what a calibration foresees, from which it is asked whether it is heat.
const DOUBTED: f32 = 1.25;
/// Least share of a resistance that is left where it seems to have fallen.
const LEAST_LEFT: f32 = 0.1;

/// Probabilities from logarithmic scores; their sum is 1.
pub fn probabilities(scores: &[f32; CAUSES], unknown: f32) -> ([f32; CAUSES], f32) {
    let best = scores.iter().fold(unknown, |a, b| a.max(*b));
    let mut weights = *scores;
    for weight in &mut weights {
        *weight = exp(*weight - best);
    }
    let rest = exp(unknown - best);
    let sum = weights.iter().sum::<f32>() + rest;
    weights.iter_mut().for_each(|weight| *weight /= sum);
    (weights, rest / sum)
}

/// Departures of an unknown kind are held to be this many standard deviations long in every row.
const UNKNOWN_SPREAD: f32 = 100.0;
/// Logarithm of `1 + UNKNOWN_SPREAD^2`.
const LN_UNKNOWN: f32 = 9.210_44;

/// Logarithm of the Bayes factor of a departure of this squared length in any direction.
fn score_of_anything(square: f32, known: f32) -> f32 {
    let k = UNKNOWN_SPREAD * UNKNOWN_SPREAD;
    0.5 * square * (k / (1.0 + k)) - 0.5 * known * LN_UNKNOWN
}

/// The squared length as an equally rare standard deviation (Wilson and Hilferty, doi:10.1073/pnas.17.12.684).
#[inline(never)]
fn significance_of_anything(square: f32, n: f32) -> f32 {
    if n < 1.0 {
        return 0.0;
    }
    let spread = 2.0 / (9.0 * n);
    let mean_square = (square / n).max(f32::MIN_POSITIVE);
    let cube_root = exp(ln(mean_square) / 3.0);
    (cube_root - (1.0 - spread)) / processor::sqrtf(spread)
}

/// The departure along the direction of heating, in units of a covariance that holds heating's deviation already.
struct Warmth {
    /// Squared length of the direction per unit rise.
    information: f32,
    /// Departure along it.
    along: f32,
}

impl Warmth {
    /// Over the rows that `white` has.
    fn new(direction: &Rows, white: &[f32]) -> Self {
        let direction = direction.get(..white.len()).unwrap_or_default();
        Warmth {
            information: dot(direction, direction),
            along: dot(direction, white),
        }
    }

    /// Mean of the rise given the window and what was known; the deviation that the window alone would leave of any.
    fn implied(&self, any: f32, expected: Heating) -> Heating {
        let variance = expected.deviation * expected.deviation;
        // Sherman and Morrison: what the direction tells without heating's own share of the covariance.
        let own = self.information / (1.0 - variance * self.information).max(LEAST_INFORMATION);
        Heating {
            rise: expected.rise + variance * self.along,
            deviation: any / processor::sqrtf(1.0 + any * any * own),
        }
    }

    /// Squared length of the departure if the winding could have any temperature (Sherman and Morrison).
    fn square_at_any(&self, square: f32, healthy: &Healthy, expected: Heating) -> f32 {
        let any = Heating::any(healthy).deviation;
        let wider = any * any - expected.deviation * expected.deviation;
        let rise = expected.rise;
        let along = self.along + rise * self.information;
        let from_zero = square + rise * (self.along + along);
        from_zero - wider * along * along / (1.0 + wider * self.information)
    }
}

/// Called from many places: on the board one copy is enough.
#[inline(never)]
fn exp(x: f32) -> f32 {
    libm::expf(x)
}

#[inline(never)]
fn ln(x: f32) -> f32 {
    libm::logf(x)
}
