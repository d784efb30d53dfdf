//! Motors of published catalogues: their circuits, and the intervals that a plate alone gives.

mod support;

use nameplate::contradiction::{BEYOND, Contradiction};
use nameplate::plate::Plate;
use nameplate::prior::Prior;
use nameplate::{COLUMN_KEYS, Estimate, physical};
use rayon::prelude::*;
use support::{Published, fitted_prior, motors};

#[test]
fn the_prior_is_that_of_the_shipped_catalogues() {
    let (fitted, shipped) = (fitted_prior(&motors()), Prior::REAL_MOTORS);
    let near = |a: f64, b: f64| assert!((a - b).abs() <= 5.1e-5, "{a} {b}");
    for k in 0..6 {
        (0..3).for_each(|j| near(fitted.mean[k][j], shipped.mean[k][j]));
        (0..6).for_each(|j| near(fitted.correlation[k][j], shipped.correlation[k][j]));
        near(fitted.spread[k], shipped.spread[k]);
    }
    (0..4).for_each(|k| near(fitted.inertia[k], shipped.inertia[k]));
    near(fitted.inertia_spread, shipped.inertia_spread);
}

/// Median and share within 5 % of the worst errors.
fn summary(estimates: &[Estimate]) -> (f64, f64) {
    let mut worst: Vec<f64> = estimates.iter().map(|e| e.fit.worst).collect();
    worst.sort_by(f64::total_cmp);
    let within = worst.iter().filter(|w| **w <= BEYOND).count() as f64 / worst.len() as f64;
    (worst[worst.len() / 2], within)
}

fn estimates(of: impl Fn(&Published) -> Plate + Sync) -> Vec<Estimate> {
    let estimate = |motor: &Published| Estimate::of(&of(motor)).unwrap();
    motors().par_iter().map(estimate).collect()
}

#[test]
fn catalogue_motors_are_met_or_their_contradiction_is_named() {
    let six = estimates(|motor| Plate {
        current_amp: None,
        ..motor.plate
    });
    let (median, within) = summary(&six);
    println!(
        "six values: median {:.4} %, within 5 % {:.1} %",
        100.0 * median,
        100.0 * within
    );
    assert!(median <= 0.001 && within >= 0.93);
    // Power, voltage, current, efficiency and power factor are one number too many: their rounding cannot be met.
    let all = estimates(|motor| motor.plate);
    let (median, within) = summary(&all);
    println!(
        "with the printed current: median {:.4} %, within 5 % {:.1} %",
        100.0 * median,
        100.0 * within
    );
    assert!(median <= 0.002 && within >= 0.93);
    for estimate in six.iter().chain(&all).filter(|e| e.fit.worst > BEYOND) {
        let named = estimate.contradictions.iter().any(|c| {
            matches!(
                c,
                Contradiction::Odd { .. } | Contradiction::Impossible { .. }
            )
        });
        assert!(
            named,
            "{:?} {:?}",
            estimate.completed.plate, estimate.contradictions
        );
    }
}

/// The plate without breakdown and locked-rotor values.
fn bare(plate: &Plate) -> Plate {
    Plate {
        breakdown_torque_ratio: None,
        locked_rotor_torque_ratio: None,
        locked_rotor_current_ratio: None,
        ..*plate
    }
}

/// For each quantity how many intervals hold, and the mean half width as a factor.
fn coverage(makers: &[&str]) -> Vec<(String, usize, usize, f64)> {
    let all = motors();
    let mut rows: Vec<(String, usize, usize, f64)> = Vec::new();
    for maker in makers {
        let (tested, learnt): (Vec<Published>, Vec<Published>) =
            all.iter().cloned().partition(|m| m.maker == *maker);
        let prior = fitted_prior(&learnt);
        let found: Vec<Vec<(String, bool, f64)>> =
            tested.par_iter().filter_map(|m| one(m, &prior)).collect();
        for motor in found {
            for (k, (name, holds, width)) in motor.into_iter().enumerate() {
                if rows.len() <= k {
                    rows.push((name, 0, 0, 0.0));
                }
                rows[k].1 += usize::from(holds);
                rows[k].2 += 1;
                rows[k].3 += width;
            }
        }
    }
    rows
}

/// What the bare plate's intervals say of one motor against what its full data give.
fn one(motor: &Published, prior: &Prior) -> Option<Vec<(String, bool, f64)>> {
    let full = Estimate::of(&motor.plate).unwrap();
    if full.fit.worst > 0.05 {
        return None;
    }
    let estimate = Estimate::with_prior(&bare(&motor.plate), prior).unwrap();
    let printed = motor.plate.numbers();
    let columns = (7..10).map(|k| {
        let interval = estimate.columns[k];
        let truth = printed[k].unwrap().value;
        (
            COLUMN_KEYS[k].to_owned(),
            interval.holds(truth),
            interval.log_spread(),
        )
    });
    let mut truths = full.parameters.map(|interval| interval.value);
    let equal = physical::with_equal_leakages([truths[1], truths[2], truths[3], truths[4]]);
    truths[1..5].copy_from_slice(&equal);
    let parameters = (0..physical::PHYSICAL - 1).map(|k| {
        let interval = estimate.parameters[k];
        (
            physical::KEYS[k].to_owned(),
            interval.holds(truths[k]),
            interval.log_spread(),
        )
    });
    Some(columns.chain(parameters).collect())
}

/// Binomial scatter of 293 motors at 95 % is 1.3 points; the promise is 92 to 98 %. Intervals of ratios are wider: these
/// makers are more alike than all makers are (`between_makers`), and the sum of the leakages is known better than its interval says.
#[test]
fn intervals_of_the_plate_alone_hold_for_makers_left_out() {
    let makers = [
        "Leroy-Somer",
        "Siemens",
        "textbook",
        "Bonfiglioli",
        "Oddesse",
    ];
    for (name, holds, of, width) in coverage(&makers) {
        let share = holds as f64 / of as f64;
        println!(
            "{name:30} {:5.1} % of {of}, x{:.2}",
            100.0 * share,
            (1.96 * width / of as f64).exp()
        );
        let least = if name == "second_cage_leakage_ratio" {
            0.88
        } else {
            0.92
        };
        assert!((least..=1.0).contains(&share), "{name}");
    }
}
