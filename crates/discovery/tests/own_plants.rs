//! Plants that share no code with the library, priors wrong by 5 %, two recordings.
//!
//! A cut of the whole table, which `cargo run --release -p discovery --example evidence` prints.

mod foreign;

use discovery::Verdict;
use foreign::cases::single;
use foreign::evidence::{Answer, Question, Setting, double, with_twins};

/// Seeds of this file; the table uses others.
const SEED: u64 = 11;

fn asked(name: &str, setting: Setting, seed: u64) -> Answer {
    let case = single(seed).into_iter().find(|c| c.name == name).unwrap();
    let answer = Question::of(&case, setting, seed).ask();
    println!("{}", answer.line());
    answer
}

#[test]
fn a_healthy_machine_with_wrong_priors_is_adequate() {
    for setting in [Setting::CoastDown, Setting::Loads, Setting::Steady] {
        let answer = Question::healthy(setting, false, SEED).ask();
        println!("{}", answer.line());
        assert_eq!(answer.report.verdict, Verdict::Adequate);
        assert!(answer.report.steps.is_empty());
    }
}

#[test]
fn friction_of_another_form_is_named_after_a_coast_down() {
    assert!(asked("coulomb-friction", Setting::CoastDown, SEED + 1).is_found());
}

#[test]
fn saturation_of_another_form_is_named() {
    assert!(asked("magnetizing-saturation", Setting::Loads, SEED + 2).is_unique_but_for_twins());
}

#[test]
fn a_cage_of_layers_is_named_a_deep_bar() {
    assert!(asked("deep-bar", Setting::Loads, SEED).is_found());
}

#[test]
fn dead_time_of_another_form_is_named() {
    assert!(asked("inverter-dead-time", Setting::Loads, SEED + 1).is_unique());
}

#[test]
fn one_steady_load_names_nothing_that_is_not_there() {
    for name in ["windage", "rotor-heating", "speed-scale"] {
        assert!(!asked(name, Setting::Steady, SEED).is_wrong());
    }
}

#[test]
fn two_effects_at_once_are_both_named() {
    let answer = double(SEED).swap_remove(0).ask();
    println!("{}", answer.line());
    assert!(answer.is_found() && !answer.is_wrong());
}

#[test]
fn without_the_truth_in_the_library_nothing_is_named() {
    for name in [
        "magnetizing-saturation",
        "shaft-compliance",
        "rotor-asymmetry",
    ] {
        let case = single(SEED).into_iter().find(|c| c.name == name).unwrap();
        let mut question = Question::of(&case, Setting::CoastDown, SEED);
        question.without = with_twins(name);
        let answer = question.ask();
        println!("{}", answer.line());
        assert!(answer.report.steps.is_empty());
    }
}
