//! Plants that share no code with the library, beliefs wrong by 5 %, two recordings, one with a coast-down.
//!
//! The whole table: `cargo test --release -p discovery --test own_plants -- --ignored --nocapture`.

mod foreign;

use discovery::{ExplainReport, Verdict, explain, explain_without};
use foreign::{COAST, Hidden, LOADS, beliefs, record};
use recording::Source;

/// Every hidden effect, under the name that the library gives it.
fn cases() -> Vec<(&'static str, Hidden)> {
    let none = Hidden::default();
    vec![
        (
            "magnetizing-saturation",
            Hidden {
                saturation: 0.15,
                ..none
            },
        ),
        (
            "leakage-saturation",
            Hidden {
                leakage: 0.3,
                ..none
            },
        ),
        ("core-loss", Hidden { core: 8e-4, ..none }),
        (
            "rotor-heating",
            Hidden {
                rotor_rise: 0.2,
                ..none
            },
        ),
        (
            "coulomb-friction",
            Hidden {
                coulomb: 0.7,
                ..none
            },
        ),
        (
            "windage",
            Hidden {
                windage: 1.5,
                ..none
            },
        ),
        (
            "load-pulsation",
            Hidden {
                pulsation: 0.7,
                ..none
            },
        ),
        (
            "shaft-compliance",
            Hidden {
                torsion_hz: 33.0,
                ..none
            },
        ),
        (
            "stator-asymmetry",
            Hidden {
                phase_b: 0.2,
                ..none
            },
        ),
        (
            "rotor-asymmetry",
            Hidden {
                rotor_bar: 0.05,
                ..none
            },
        ),
        (
            "phase-voltage-gain",
            Hidden {
                gain_vc: -0.02,
                ..none
            },
        ),
        (
            "phase-current-gain",
            Hidden {
                gain_ia: 0.03,
                ..none
            },
        ),
        (
            "current-offset",
            Hidden {
                offset_ib: 0.2,
                ..none
            },
        ),
        (
            "sample-delay",
            Hidden {
                delay: 1.5e-4,
                ..none
            },
        ),
        (
            "speed-scale",
            Hidden {
                speed_scale: 0.006,
                ..none
            },
        ),
        (
            "speed-ripple",
            Hidden {
                speed_ripple: 1.2,
                ..none
            },
        ),
    ]
}

fn explained(hidden: &Hidden, seed: u64) -> ExplainReport {
    let a = Source::Recording(record(hidden, &COAST, 2 * seed));
    let b = Source::Recording(record(hidden, &LOADS, 2 * seed + 1));
    explain(&[a, b], &beliefs(seed), &mut |_, _| {}).unwrap()
}

/// Whether the first step names the truth alone, or at least within its ties.
fn judged(report: &ExplainReport, name: &str) -> (bool, bool) {
    let Some(step) = report.steps.first() else {
        return (false, false);
    };
    let unique = step.effect == name && step.tied_with.is_empty();
    let tie = step.effect == name || step.tied_with.iter().any(|t| t == name);
    (unique && report.steps.len() == 1, tie)
}

fn show(name: &str, seed: u64, report: &ExplainReport) {
    let error = |f: &Option<discovery::FitReport>| {
        f.as_ref().map_or(f64::NAN, |f| f.held_out_error_over_noise)
    };
    let (before, after) = (error(&report.baseline), error(&report.final_));
    println!(
        "{name:24} {seed:3} {:?} {before:.3} -> {after:.3}: {}",
        report.verdict, report.summary
    );
}

#[test]
#[ignore = "the whole table takes minutes"]
fn the_whole_table() {
    let seeds = 1..=std::env::var("SEEDS").map_or(2, |s| s.parse().unwrap());
    let (mut tie, mut unique, mut all, mut false_effects, mut healthy) = (0, 0, 0, 0, 0);
    for seed in seeds {
        for (name, hidden) in cases() {
            let report = explained(&hidden, seed);
            let (is_unique, in_tie) = judged(&report, name);
            (all, tie, unique) = (
                all + 1,
                tie + usize::from(in_tie),
                unique + usize::from(is_unique),
            );
            show(name, seed, &report);
        }
        let report = explained(&Hidden::default(), seed);
        healthy += 1;
        false_effects += usize::from(!report.steps.is_empty());
        show("nothing", seed, &report);
    }
    println!(
        "in the tie set {tie}/{all}, unique {unique}/{all}, false effects {false_effects}/{healthy}"
    );
    assert!(tie * 100 >= all * 95 && unique * 100 >= all * 85 && false_effects == 0);
}

#[test]
fn a_healthy_machine_with_wrong_beliefs_is_adequate() {
    let report = explained(&Hidden::default(), 11);
    show("nothing", 11, &report);
    assert_eq!(report.verdict, Verdict::Adequate);
    assert!(report.steps.is_empty());
}

#[test]
fn friction_of_another_form_is_named_after_a_coast_down() {
    let hidden = Hidden {
        coulomb: 0.7,
        ..Hidden::default()
    };
    let report = explained(&hidden, 12);
    show("coulomb-friction", 12, &report);
    assert!(judged(&report, "coulomb-friction").1);
}

#[test]
fn saturation_of_another_form_is_named() {
    let hidden = Hidden {
        saturation: 0.15,
        ..Hidden::default()
    };
    let report = explained(&hidden, 13);
    show("magnetizing-saturation", 13, &report);
    assert!(judged(&report, "magnetizing-saturation").0);
}

#[test]
#[ignore = "takes minutes"]
fn two_effects_at_once() {
    let seeds = 21..=20 + std::env::var("SEEDS").map_or(1, |s| s.parse::<u64>().unwrap());
    let none = Hidden::default();
    let pairs = [
        (
            ["magnetizing-saturation", "phase-voltage-gain"],
            Hidden {
                saturation: 0.15,
                gain_vc: 0.02,
                ..none
            },
        ),
        (
            ["shaft-compliance", "rotor-heating"],
            Hidden {
                torsion_hz: 50.0,
                rotor_rise: 0.2,
                ..none
            },
        ),
        (
            ["load-pulsation", "current-offset"],
            Hidden {
                pulsation: 0.7,
                offset_ib: 0.25,
                ..none
            },
        ),
        (
            ["core-loss", "rotor-asymmetry"],
            Hidden {
                core: 8e-4,
                rotor_bar: 0.05,
                ..none
            },
        ),
        (
            ["windage", "stator-asymmetry"],
            Hidden {
                windage: 1.5,
                phase_b: 0.2,
                ..none
            },
        ),
        (
            ["coulomb-friction", "speed-scale"],
            Hidden {
                coulomb: 0.7,
                speed_scale: 0.006,
                ..none
            },
        ),
    ];
    let (mut both, mut all, mut third) = (0, 0, 0);
    for seed in seeds {
        for (names, hidden) in &pairs {
            let report = explained(hidden, seed);
            let named = |name: &str| {
                let mut steps = report.steps.iter();
                steps.any(|s| s.effect == name || s.tied_with.iter().any(|t| t == name))
            };
            all += 1;
            both += usize::from(names.iter().all(|name| named(name)));
            third += usize::from(report.steps.len() > 2);
            show(&names.join("+"), seed, &report);
        }
    }
    println!("both found {both}/{all}, a third named {third}/{all}");
    assert!(both * 100 >= all * 85 && third * 100 <= all * 5);
}

#[test]
#[ignore = "takes minutes"]
fn without_the_truth_in_the_library_nothing_is_named() {
    let (mut wrong, mut all) = (0, 0);
    for (name, hidden) in cases() {
        let a = Source::Recording(record(&hidden, &COAST, 62));
        let b = Source::Recording(record(&hidden, &LOADS, 63));
        let report = explain_without(&[a, b], &beliefs(31), &[name], &mut |_, _| {}).unwrap();
        all += 1;
        wrong += usize::from(!report.steps.is_empty());
        show(&format!("without {name}"), 31, &report);
    }
    println!("a wrong name {wrong}/{all}");
    // A low-pass of the same lag is the delay's twin at one supply frequency; everything else must stay unnamed.
    assert!(wrong <= 1);
}
