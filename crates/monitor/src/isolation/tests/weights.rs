//! Scores, significance and temperature against what they stand for: densities, quantiles and Bayes' rule in double precision.

use core::f64::consts::TAU;

use super::plant::{Plant, evidence, statistics};
use crate::checks::sensors::Phase;
use crate::isolation::fit::{Departure, Direction, Fit, IMPOSSIBLE, Total};
use crate::isolation::weighing::{LN_USUAL_DISPLACEMENT, USUAL_DISPLACEMENT};
use crate::isolation::{
    ALL_CAUSES, Cause, Heating, Isolation, LN_UNKNOWN, ROWS, UNKNOWN_SPREAD, Warmth, probabilities,
    score_of_anything, significance_of_anything,
};
use covariance::dot;

#[test]
fn logarithms_that_are_written_out_are_those_of_their_numbers() {
    // Single precision keeps seven digits.
    let close = |x: f32, y: f64| assert!((f64::from(x) - y).abs() < 1e-6 * y.abs(), "{x} {y}");
    close(LN_USUAL_DISPLACEMENT, f64::from(USUAL_DISPLACEMENT).ln());
    close(LN_UNKNOWN, (1.0 + f64::from(UNKNOWN_SPREAD).powi(2)).ln());
}

/// Density of a normal distribution of this variance.
fn normal(x: f64, variance: f64) -> f64 {
    (-0.5 * x * x / variance).exp() / (TAU * variance).sqrt()
}

/// Logarithm of the Bayes factor of a change of `size`, normal around 0 with deviation `typical`, against none, when one
/// row shows `x` with deviation 1 and moves by `direction` per unit: the integral over all sizes.
fn integrated(x: f64, direction: f64, typical: f64) -> f64 {
    let step = typical / 2000.0;
    let sizes = (-20_000..=20_000).map(|k| f64::from(k) * step);
    let likelihood =
        |size: f64| normal(x - size * direction, 1.0) * normal(size, typical * typical);
    (sizes.map(likelihood).sum::<f64>() * step / normal(x, 1.0)).ln()
}

fn rows(values: &[f32]) -> [f32; ROWS] {
    let mut rows = [0.0; ROWS];
    rows[..values.len()].copy_from_slice(values);
    rows
}

/// Rows that are not 0 are known.
fn fit(along: &[f32], across: Option<&[f32]>, departure: &[f32], cause: Cause) -> Fit {
    let (along, departure) = (rows(along), rows(departure));
    let across = across.map(rows);
    let known = departure.map(|x| x != 0.0);
    let direction = Direction {
        along: &along,
        across: across.as_ref().map(|across| &across[..]),
    };
    let departure = Departure {
        white: &departure,
        total: Total::of(&departure, &known),
    };
    Fit::of(cause, &direction, &departure)
}

fn score(direction: &[f32], departure: &[f32], cause: Cause) -> f64 {
    f64::from(fit(direction, None, departure, cause).score())
}

/// Two directions at right angles: the product of both Bayes factors, each of a part that only adds.
#[test]
fn a_second_direction_has_a_bayes_factor_of_its_own() {
    let cause = Cause::Turns(Phase::A);
    let found = fit(&[30.0], Some(&[0.0, 30.0]), &[6.0, 4.0], cause);
    let typical = f64::from(cause.typical_size());
    let both = integrated(6.0, 30.0, typical) + integrated(4.0, 30.0, typical);
    let expected = both + 2.0 * 2.0_f64.ln();
    let got = f64::from(found.score());
    assert!((got - expected).abs() < 1e-3 * expected, "{got} {expected}");
    let size = 6.0_f32.hypot(4.0) / 30.0;
    assert!((found.size() - size).abs() < 1e-6, "{found:?}");
    // All of it lies in the plane.
    assert!((found.square() - 52.0).abs() < 1e-4, "{found:?}");
}

/// A turn of a standard deviation moves the row sideways by its length: a normal distribution of that width beside the first factor.
#[test]
fn a_direction_that_may_be_turned_has_the_bayes_factor_of_the_turn() {
    let cause = Cause::SeriesResistance(Phase::A);
    let found = fit(&[30.0], Some(&[0.0, 9.0]), &[6.0, 2.0], cause);
    let size = 6.0_f32 / 30.0;
    let turned = integrated(2.0, 9.0 * f64::from(size), 1.0);
    let expected = integrated(6.0, 30.0, f64::from(cause.typical_size())) + turned + 2.0_f64.ln();
    let got = f64::from(found.score());
    assert!((got - expected).abs() < 1e-3 * expected, "{got} {expected}");
    // The turn is no size.
    assert!((found.size() - size).abs() < 1e-6, "{found:?}");
    assert!((found.square() - 40.0).abs() < 1e-4, "{found:?}");
}

/// Directions 60 degrees apart, `a = (2, 0)` and `b = (1, sqrt 3)`: what lies outside the quarter between them has one of them alone,
/// or none.
#[test]
fn two_parts_that_only_add_stay_between_their_directions() {
    let cause = Cause::Turns(Phase::B);
    let b = [1.0, 3.0_f32.sqrt()];
    let of = |departure: [f32; 2]| fit(&[2.0, 0.0], Some(&b), &departure, cause);
    let close =
        |got: f32, expected: f32| assert!((got - expected).abs() < 1e-5, "{got} {expected}");
    // 0.5 a + 1.5 b.
    let between = of([2.5, 1.5 * 3.0_f32.sqrt()]);
    close(between.size(), 0.5_f32.hypot(1.5));
    close(between.square(), 2.5 * 2.5 + 2.25 * 3.0);
    // Below a: a alone, which explains (2, 0) of it.
    let below = of([2.0, -1.0]);
    close(below.size(), 1.0);
    close(below.square(), 4.0);
    // Beyond b: b alone; (-1, 3) . b = 3 sqrt 3 - 1 over |b|^2 = 4.
    let beyond = of([-1.0, 3.0]);
    close(beyond.size(), (3.0 * 3.0_f32.sqrt() - 1.0) / 4.0);
    close(beyond.square(), 4.0 * beyond.size().powi(2));
    assert_eq!(of([-1.0, -1.0]).score(), IMPOSSIBLE);
}

#[test]
fn a_score_in_one_row_is_the_bayes_factor() {
    for (x, direction) in [(4.0, 20.0), (-4.0, 20.0), (0.5, 3.0), (7.0, 30.0)] {
        for cause in [Cause::StatorResistance, Cause::Friction] {
            let got = score(&[direction], &[x], cause);
            let typical = f64::from(cause.typical_size());
            let expected = integrated(f64::from(x), f64::from(direction), typical);
            assert!(
                (got - expected).abs() < 1e-3 * (1.0 + expected.abs()),
                "{got} {expected}"
            );
        }
    }
}

/// What a cause of all phases leaves in the negative sequence counts as nothing explained; of a cause in one phase it may be a
/// direction that is a little wrong.
#[test]
fn a_cause_of_all_phases_does_not_reach_the_negative_sequence() {
    let cause = Cause::StatorResistance;
    let departure = [6.0, 1.5, -0.7, 5.0, -4.0];
    let got = score(&[20.0], &departure, cause);
    let expected = score(&[20.0], &departure[..3], cause);
    assert!((got - expected).abs() < 1e-6, "{got} {expected}");
    let one = Cause::CurrentChannel(Phase::A);
    assert!(score(&[20.0], &departure, one) > score(&[20.0], &departure[..3], one));
}

/// A size beyond the typical one is rare in proportion: normal with the scale `s`, of which `1/s^2` is left to larger ones. What the
/// score takes is the scale of the size itself, which is within a factor of three of the integral over all scales.
#[test]
fn a_large_size_is_rare_and_not_impossible() {
    for (x, direction) in [(12.0, 20.0), (-15.0, 5.0), (9.0, 3.0), (6.0, 100.0)] {
        for cause in [Cause::StatorResistance, Cause::SpeedGain] {
            let typical = f64::from(cause.typical_size());
            // u = typical/s is uniform.
            let scales = (1..=200).map(|k| typical * 200.0 / (f64::from(k) - 0.5));
            let all: Vec<f64> = scales.map(|s| integrated(x, direction, s)).collect();
            let best = all.iter().copied().fold(f64::MIN, f64::max);
            let sum: f64 = all.iter().map(|ln| (ln - best).exp()).sum();
            let expected = best + (sum / 200.0).ln();
            let got = score(&[direction as f32], &[x as f32], cause);
            assert!((got - expected).abs() < 3.0_f64.ln(), "{got} {expected}");
        }
    }
}

/// A contact or a short only adds: its size is positive for certain, which is worth a factor of two; the other sign is
/// impossible.
#[test]
fn a_cause_that_only_adds_gains_a_bit_and_has_one_sign() {
    let cause = Cause::SeriesResistance(Phase::B);
    let expected = integrated(5.0, 20.0, f64::from(cause.typical_size())) + 2.0_f64.ln();
    assert!((score(&[20.0], &[5.0], cause) - expected).abs() < 1e-3 * expected);
    assert_eq!(score(&[20.0], &[-5.0], cause), f64::from(IMPOSSIBLE));
    assert!(score(&[20.0], &[-5.0], Cause::StatorResistance) > 0.0);
}

/// Beside its direction a cause may leave a share of its own length in every other row, normally distributed.
#[test]
fn what_lies_beside_the_direction_costs_as_much_as_its_density() {
    for cause in [Cause::StatorResistance, Cause::Turns(Phase::A)] {
        let (along, beside) = (6.0, [1.5, -0.7]);
        let spread = (f64::from(cause.looseness()) * along).powi(2);
        let mut expected = integrated(along, 20.0, f64::from(cause.typical_size()));
        for x in beside {
            expected += (normal(x, 1.0 + spread) / normal(x, 1.0)).ln();
        }
        expected += if cause.only_adds() { 2.0_f64.ln() } else { 0.0 };
        let got = score(&[20.0], &[6.0, 1.5, -0.7], cause);
        assert!(
            (got - expected).abs() < 2e-3 * expected.abs(),
            "{got} {expected}"
        );
    }
}

#[test]
fn a_direction_without_length_explains_nothing() {
    let found = fit(&[], None, &[3.0], Cause::Leakage);
    assert_eq!((found.size(), found.square()), (0.0, 0.0));
}

/// Something else: a hundred standard deviations in every row.
#[test]
fn the_score_of_anything_is_that_of_a_wide_normal_distribution() {
    for departure in [&[3.0, -8.0][..], &[0.1, 0.2, 0.3, 20.0]] {
        let square = departure.iter().map(|x| x * x).sum::<f64>();
        let expected: f64 = departure
            .iter()
            .map(|x| (normal(*x, 1.0 + 1e4) / normal(*x, 1.0)).ln())
            .sum();
        let got = f64::from(score_of_anything(square as f32, departure.len() as f32));
        assert!(
            (got - expected).abs() < 1e-3 * (1.0 + expected.abs()),
            "{got} {expected}"
        );
    }
}

/// Chance that a sum of `2 half` squares exceeds `x`: a sum of Poisson's.
fn survival(x: f64, half: u32) -> f64 {
    let mut term = (-0.5 * x).exp();
    let mut sum = term;
    for k in 1..half {
        term *= 0.5 * x / f64::from(k);
        sum += term;
    }
    sum
}

fn quantile(chance: f64, half: u32) -> f64 {
    let (mut low, mut high) = (0.0, 200.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if survival(middle, half) > chance {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Wilson and Hilferty's cube root errs by less than 0.06 standard deviations up to three of them, by 0.15 at four.
#[test]
fn a_squared_length_becomes_the_standard_deviation_that_is_as_rare() {
    for half in [1, 2, 3, 4] {
        for (sigma, chance) in [
            (1.0, 0.158_655),
            (2.0, 0.022_750),
            (3.0, 1.349_9e-3),
            (4.0, 3.167_1e-5),
        ] {
            let square = quantile(chance, half) as f32;
            let got = f64::from(significance_of_anything(square, 2.0 * half as f32));
            let most = if sigma > 3.0 { 0.15 } else { 0.06 };
            assert!(
                (got - sigma).abs() < most,
                "{got} for {sigma} of {} rows",
                2 * half
            );
        }
    }
    assert_eq!(significance_of_anything(9.0, 0.0), 0.0);
}

#[test]
fn probabilities_stand_to_each_other_as_their_scores_say() {
    let mut scores = [0.0; ALL_CAUSES.len()];
    scores[4] = 3.0;
    scores[7] = 1.0;
    let (shares, unknown) = probabilities(&scores, 2.0);
    let ratio = |a: f32, b: f32| f64::from(a / b).ln();
    assert!((ratio(shares[4], shares[7]) - 2.0).abs() < 1e-5);
    assert!((ratio(unknown, shares[7]) - 1.0).abs() < 1e-5);
    assert!((ratio(shares[7], shares[0]) - 1.0).abs() < 1e-5);
}

/// One row that shows `x`, moves by `d` per unit of rise and scatters by 1; the winding's rise is known as `expected`.
struct OneRow {
    x: f64,
    d: f64,
    expected: Heating,
}

impl OneRow {
    /// Departure from what is expected, and its variance with the temperature's share.
    fn off(&self) -> (f64, f64) {
        let (rise, deviation) = (
            f64::from(self.expected.rise),
            f64::from(self.expected.deviation),
        );
        (self.x - rise * self.d, 1.0 + (deviation * self.d).powi(2))
    }

    fn warmth(&self) -> Warmth {
        let (off, variance) = self.off();
        Warmth {
            information: (self.d * self.d / variance) as f32,
            along: (self.d * off / variance) as f32,
        }
    }
}

fn one_rows() -> impl Iterator<Item = OneRow> {
    let expected = [(0.0, 0.1), (0.08, 0.02), (-0.05, 0.2)];
    expected.into_iter().flat_map(|(rise, deviation)| {
        [(4.0, 20.0), (-1.0, 30.0), (0.0, 12.0)].map(|(x, d)| OneRow {
            x,
            d,
            expected: Heating { rise, deviation },
        })
    })
}

/// Bayes' rule for a normal rise seen through one row: precisions add up.
#[test]
fn the_implied_rise_is_the_mean_of_what_was_known_and_what_is_seen() {
    let healthy = statistics();
    let any = f64::from(healthy.uncertainty.heating);
    for row in one_rows() {
        let (rise, deviation) = (
            f64::from(row.expected.rise),
            f64::from(row.expected.deviation),
        );
        let (before, seen) = (deviation.powi(-2), row.d * row.d);
        let mean = (before * rise + seen * row.x / row.d) / (before + seen);
        let implied = row.warmth().implied(any as f32, row.expected);
        assert!(
            (f64::from(implied.rise) - mean).abs() < 1e-5,
            "{implied:?} {mean}"
        );
        // The window alone leaves what it would leave of any temperature.
        let alone = (any.powi(-2) + seen).powf(-0.5);
        assert!(
            (f64::from(implied.deviation) / alone - 1.0).abs() < 1e-3,
            "{implied:?} {alone}"
        );
    }
}

/// With any temperature allowed the row's variance is `1 + (any d)^2`, and its mean that of the calibration.
#[test]
fn the_length_at_any_temperature_is_that_of_the_wider_variance() {
    let healthy = statistics();
    let any = f64::from(healthy.uncertainty.heating);
    for row in one_rows() {
        let (off, variance) = row.off();
        let square = (off * off / variance) as f32;
        let expected = row.x * row.x / (1.0 + (any * row.d).powi(2));
        let got = f64::from(row.warmth().square_at_any(square, &healthy, row.expected));
        assert!(
            (got - expected).abs() < 1e-3 * (1.0 + f64::from(square)),
            "{got} {expected}"
        );
    }
}

/// A departure that no cause explains well is as significant as its length, one along a cause as its length along it.
#[test]
fn significance_is_the_longer_of_both() {
    let mut plant = Plant::healthy();
    plant.gains[3] = 1.02;
    let evidence = evidence(&plant);
    let isolation = Isolation::of(&evidence, &statistics(), Heating::any(&statistics()));
    let white = evidence
        .covariance(
            &statistics(),
            &evidence.resistances(),
            [statistics().uncertainty.heating, 0.0],
        )
        .factorise()
        .whiten(&evidence.departure);
    let length = processor::sqrtf(dot(&white, &white));
    // One current channel explains nearly all of it.
    assert!(
        isolation.significance <= length * 1.001,
        "{} {length}",
        isolation.significance
    );
    assert!(
        isolation.significance > 0.95 * length,
        "{} {length}",
        isolation.significance
    );
}
