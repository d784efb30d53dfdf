//! A motor with iron losses: a fault to the plain motor file, nothing to the one that adopted them.

mod common;

use common::{Program, Seen, plain, variant};
use motor::motor_file::Frame;
use scenario::{Fault, Scenario};

const END_S: f64 = 2.0;

/// The motor with its losses, whatever the program knows of them.
fn lossy(faults: &[(&str, f64)]) -> Scenario {
    let mut scenario = Scenario::of(variant("core-loss").motor, END_S);
    scenario.seed = 11;
    let fault = |(name, percent): &(&str, f64)| {
        let fault = Fault::percent(name, *percent, Frame::RotorFlux).expect("a known fault");
        Fault {
            from_s: 0.8,
            ..fault
        }
    };
    scenario.faults = faults.iter().map(fault).collect();
    scenario
}

fn check(program: &Program, scenario: &Scenario, what: &str) -> Seen {
    let mut seen = program.watch(scenario);
    seen.assert_as_on_the_host(what);
    let tally = seen.board.tally();
    assert_eq!(
        (tally.missed_triggers, tally.resets),
        (0, 0),
        "{what}: {tally:?}"
    );
    println!("{what}: {:?}", seen.lit());
    seen
}

#[test]
fn losses_that_the_motor_file_does_not_know_light_a_lamp() {
    let seen = check(&plain(), &lossy(&[]), "losses, plain motor file");
    assert!(!seen.lit().is_empty());
}

#[test]
fn adopted_losses_light_nothing() {
    let seen = check(&variant("core-loss"), &lossy(&[]), "losses, adopted");
    let (levels, _) = seen.observed.last().expect("observations");
    assert_eq!(
        levels,
        &[true, false, false, false, false, false, false, false, false]
    );
}

#[test]
fn a_fault_beside_adopted_losses_still_lights_a_lamp() {
    let seen = check(
        &variant("core-loss"),
        &lossy(&[("Rs", 50.0)]),
        "losses adopted, Rs +50 %",
    );
    assert!(seen.lit().contains(&"fault"), "{:?}", seen.lit());
}
