//! Faults that are switched while a simulation runs.

use crate::simulate::Simulation;
use crate::{Fault, Scenario};
use motor::MotorFile;
use motor::motor_file::Frame;

fn scenario() -> Scenario {
    let text = include_str!("../../../../../motors/assumed-300w.toml");
    Scenario::of(MotorFile::parse(text, "motor").expect("it ships"), 0.4)
}

fn fault(name: &str, percent: f64) -> Fault {
    Fault::percent(name, percent, Frame::RotorFlux).expect("a known name")
}

#[test]
fn a_fault_switched_on_by_hand_is_the_fault_of_a_scenario() {
    for name in ["Rs", "Rsb", "bars", "Bl", "ia"] {
        let timed = Fault {
            from_s: 0.1,
            to_s: 0.3,
            ..fault(name, 50.0)
        };
        let written = Scenario {
            faults: vec![timed],
            ..scenario()
        };
        let expected = Simulation::new(&written).expect("it runs");
        let mut by_hand = Simulation::endless(&scenario()).expect("it runs");
        for (k, expected) in expected.enumerate() {
            match k {
                1000 => by_hand.switch_faults(vec![fault(name, 50.0)]),
                3000 => by_hand.switch_faults(Vec::new()),
                _ => Ok(()),
            }
            .expect("a possible size");
            let sample = by_hand.next().expect("it never ends");
            assert_eq!(sample, expected, "{name}, sample {k}");
        }
    }
}

#[test]
fn another_size_of_the_same_fault_takes_effect() {
    let speed_after = |sizes: [f64; 2]| {
        let mut simulation = Simulation::endless(&scenario()).expect("it runs");
        let mut speed = 0.0;
        for size in sizes {
            let faults = vec![fault("Bl", size)];
            simulation.switch_faults(faults).expect("a possible size");
            speed = simulation.nth(5_000).expect("no end").truth.omega_mech;
        }
        speed
    };
    // Twice the friction costs this motor some 6 rad/s.
    assert!(speed_after([50.0, 100.0]) < speed_after([50.0, 50.0]) - 1.0);
}

#[test]
fn an_impossible_size_is_refused_and_changes_nothing() {
    let mut simulation = Simulation::endless(&scenario()).expect("it runs");
    let error = simulation.switch_faults(vec![fault("bars", 500.0)]);
    assert!(error.is_err(), "{error:?}");
    assert!(simulation.scenario().faults.is_empty());
}

#[test]
fn it_goes_on_beyond_the_duration() {
    let mut simulation = Simulation::endless(&scenario()).expect("it runs");
    let sample = simulation.nth(10_000).expect("it never ends");
    assert_eq!(sample.t, 1.0);
    assert!((simulation.now() - 1.0001).abs() < 1e-12);
}
