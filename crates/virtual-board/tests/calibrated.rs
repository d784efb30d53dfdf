//! A calibrated motor on the board: FAULT follows the direction of the evidence, as on the host.

mod common;

use common::{Program, scenario, variant};
use motor::motor_file::Frame;
use scenario::{Fault, Scenario};

/// The board has found the supply and knows the winding's temperature.
const FAULT_FROM_S: f64 = 0.8;
const END_S: f64 = 1.6;
const FAULT: usize = 8;
const SENSOR: usize = 5;

fn faulty(name: &str, percent: f64) -> Scenario {
    let mut scenario = scenario(END_S);
    let mut fault = Fault::percent(name, percent, Frame::RotorFlux).expect("a known fault");
    fault.from_s = FAULT_FROM_S;
    scenario.faults = vec![fault];
    scenario
}

/// Runs it, holds the lamps to the host's, and returns the wires at the end.
fn lamps(program: &Program, scenario: &Scenario, what: &str) -> [bool; 9] {
    let mut seen = program.watch(scenario);
    seen.assert_as_on_the_host(what);
    let tally = seen.board.tally();
    let trouble = (tally.missed_triggers, tally.resets);
    assert_eq!(trouble, (0, 0), "{what}: {tally:?}");
    println!("{what}: {:?}", seen.lit());
    seen.board.lamps()
}

#[test]
fn a_healthy_motor_shows_run_alone() {
    let healthy = lamps(&variant("calibrated"), &scenario(END_S), "healthy");
    assert_eq!(healthy.map(u8::from), [1, 0, 0, 0, 0, 0, 0, 0, 0]);
}

/// Sizes that the detection table calls detected; the first two are seen because a winding does not warm in a cycle.
#[test]
fn small_faults_light_the_hosts_lamps() {
    let program = variant("calibrated");
    for (name, percent) in [("Rr", 20.0), ("wr", 2.0), ("Lm", 10.0), ("Rsa", 20.0)] {
        let what = format!("{name} {percent:+} %");
        let shown = lamps(&program, &faulty(name, percent), &what);
        assert!(shown[FAULT], "{what}: {shown:?}");
    }
}

#[test]
fn a_gain_of_one_channel_is_a_sensors_fault() {
    let program = variant("calibrated");
    for name in ["ia", "vc"] {
        let what = format!("{name} +5 %");
        let shown = lamps(&program, &faulty(name, 5.0), &what);
        assert!(shown[FAULT] && shown[SENSOR], "{what}: {shown:?}");
    }
}

/// Blocks of four turns of twice the slip angle, the third lights.
#[test]
fn broken_bars_light_fault() {
    let program = variant("calibrated");
    let mut scenario = faulty("bars", 10.0);
    scenario.duration_s = 8.0;
    let shown = lamps(&program, &scenario, "bars +10 %");
    assert!(shown[FAULT], "{shown:?}");
}
