//! Motors with iron losses, and with contacts that follow no effect of the library but a law: a fault to the plain motor
//! file, nothing to the one that adopted them.

mod common;

use common::{Program, Seen, plain, variant};
use motor::motor_file::Frame;
use scenario::{Fault, Scenario};

const END_S: f64 = 2.0;

/// Programs whose motor file adopted what their motor does: an effect of the library, a curve of 18 knots.
const ADOPTED: [&str; 2] = ["core-loss", "contact"];

/// The motor of a program, whatever another program knows of it.
fn motor_of(program: &Program, faults: &[(&str, f64)]) -> Scenario {
    let mut scenario = Scenario::of(program.motor.clone(), END_S);
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
fn what_the_motor_file_does_not_know_lights_a_lamp() {
    for name in ADOPTED {
        let scenario = motor_of(&variant(name), &[]);
        let seen = check(&plain(), &scenario, &format!("{name}, plain motor file"));
        assert!(!seen.lit().is_empty(), "{name}");
    }
}

#[test]
fn what_was_adopted_lights_nothing() {
    for name in ADOPTED {
        let program = variant(name);
        let seen = check(&program, &motor_of(&program, &[]), name);
        let (levels, _) = seen.observed.last().expect("observations");
        assert_eq!(
            levels,
            &[true, false, false, false, false, false, false, false, false],
            "{name}"
        );
    }
}

#[test]
fn a_fault_beside_what_was_adopted_still_lights_a_lamp() {
    for name in ADOPTED {
        let program = variant(name);
        let scenario = motor_of(&program, &[("Rs", 50.0)]);
        let seen = check(&program, &scenario, &format!("{name} adopted, Rs +50 %"));
        assert!(seen.lit().contains(&"fault"), "{name}: {:?}", seen.lit());
    }
}
