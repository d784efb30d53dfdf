//! Intervals after each step, over many motors.

use std::sync::OnceLock;

use nameplate::Interval;
use nameplate::measured::{ALL, NAMES, Tested};
use rayon::prelude::*;

use crate::drawn::{Motor, truths};
use crate::machine::Laws;
use crate::{full_set, on_a_bench, told};

const STEPS: [&str; 6] = [
    "plate",
    "dc-resistance",
    "no-load",
    "locked-rotor",
    "load",
    "coast-down",
];

type All = Vec<(Motor, Tested)>;

fn tested(count: u64, laws: Laws) -> All {
    let one = |seed: u64| {
        on_a_bench(seed, laws, |motor, plate, mut bench| {
            full_set(&mut bench);
            (motor.clone(), told(plate, &bench.table))
        })
    };
    (0..count).into_par_iter().map(one).collect()
}

/// Motors with the laws that are fitted.
fn fitted() -> &'static All {
    static ALL: OnceLock<All> = OnceLock::new();
    let cases = std::env::var("CASES").ok().and_then(|n| n.parse().ok());
    ALL.get_or_init(|| tested(cases.unwrap_or(200), Laws::Fitted))
}

fn held(all: &All, step: usize, k: usize) -> f64 {
    let holds = |(motor, tested): &&(Motor, Tested)| {
        tested.steps[step].parameters[k].holds(truths(motor)[k])
    };
    all.iter().filter(holds).count() as f64 / all.len() as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn half_width(all: &All, step: usize, k: usize) -> f64 {
    let factor = |interval: &Interval| interval.high / interval.value;
    median(
        all.iter()
            .map(|(_, t)| factor(&t.steps[step].parameters[k]))
            .collect(),
    )
}

fn error(all: &All, k: usize) -> f64 {
    let error =
        |(motor, t): &(Motor, Tested)| (t.parameters()[k].value / truths(motor)[k]).ln().abs();
    median(all.iter().map(error).collect())
}

fn print(all: &All) {
    println!(
        "{:27}{}",
        "",
        STEPS.map(|step| format!("{step:>17}")).concat()
    );
    for (k, name) in NAMES.iter().enumerate() {
        let cell = |step| {
            format!(
                "{:7.1} % x{:<7.3}",
                100.0 * held(all, step, k),
                half_width(all, step, k)
            )
        };
        let cells: String = (0..STEPS.len()).map(cell).collect();
        println!(
            "{name:27}{cells} median error {:.1} %",
            100.0 * error(all, k)
        );
    }
    println!("contradictions named for {} of {}", accused(all), all.len());
}

fn accused(all: &All) -> usize {
    all.iter()
        .filter(|(_, tested)| !tested.doubts.is_empty())
        .count()
}

/// Of 1000 motors 92 to 98 % are held in 86 of the 90 cells (docs/first-steps.md has the others); here the scatter of 200 comes to that, 1.5
/// points of one standard deviation in each cell.
#[test]
fn intervals_hold_the_truth_after_each_step() {
    let all = fitted();
    print(all);
    let mut shares = Vec::new();
    for (step, after) in STEPS.iter().enumerate() {
        for (k, name) in NAMES.iter().enumerate() {
            let share = held(all, step, k);
            assert!(share >= 0.9, "{name} after {after}: {share}");
            shares.push(share);
        }
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    assert!((0.935..=0.965).contains(&mean), "{mean}");
    assert!(accused(all) * 33 < all.len(), "{}", accused(all));
}

/// A step that names a contradiction, or a fit that leaves a wrong valley, may widen some.
#[test]
fn intervals_do_not_grow_much_with_a_further_step() {
    let mut growths: Vec<f64> = Vec::new();
    for (_, tested) in fitted() {
        for pair in tested.steps.windows(2) {
            let spread = |step: usize, k: usize| pair[step].parameters[k].log_spread();
            growths.extend((0..ALL).map(|k| spread(1, k) / spread(0, k)));
        }
    }
    growths.sort_by(f64::total_cmp);
    let at = |share: f64| growths[(share * (growths.len() - 1) as f64) as usize];
    println!(
        "growth: 95 % below {:.3}, 98 % below {:.3}, 99 % below {:.3}",
        at(0.95),
        at(0.98),
        at(0.99)
    );
    assert!(
        at(0.95) < 1.05 && at(0.98) < 1.15,
        "{} {}",
        at(0.95),
        at(0.98)
    );
}

#[test]
fn a_full_set_gives_the_main_parameters_within_a_few_percent() {
    let of = |name: &str| {
        error(
            fitted(),
            NAMES.iter().position(|known| *known == name).unwrap(),
        )
    };
    for (name, most) in [
        ("stator_resistance_ohm", 0.035),
        ("rotor_resistance_ohm", 0.04),
        ("stator_leakage_henry", 0.035),
        ("rotor_leakage_henry", 0.03),
        ("magnetizing_inductance_henry", 0.015),
        ("core_loss_resistance_ohm", 0.06),
        ("windage_nm_s2", 0.02),
        ("inertia_kg_m2", 0.015),
    ] {
        assert!(of(name) < most, "{name}: {}", of(name));
    }
}

/// Bars after Field, iron with a knee, leakage by a describing function. How the leakage is split between stator and both cages is
/// of the form and not of the motor: what the terminals show is the sum.
#[test]
fn motors_with_other_laws_are_held_and_not_accused() {
    let all = tested(60, Laws::Others);
    print(&all);
    let of_form = [
        "stator_leakage_henry",
        "rotor_leakage_henry",
        "second_cage_share",
        "second_cage_leakage_ratio",
        "leakage_drop",
    ];
    for (k, name) in NAMES
        .iter()
        .enumerate()
        .filter(|(_, name)| !of_form.contains(name))
    {
        let share = held(&all, STEPS.len() - 1, k);
        assert!(share >= 0.85, "{name}: {share}");
    }
    let leakage = |(motor, t): &(Motor, Tested)| {
        let (found, truth) = (t.parameters(), truths(motor));
        ((found[2].value + found[3].value) / (truth[2] + truth[3]))
            .ln()
            .abs()
    };
    assert!(median(all.iter().map(leakage).collect()) < 0.08);
    assert!(accused(&all) <= 4, "{}", accused(&all));
}
