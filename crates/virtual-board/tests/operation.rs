//! Healthy motors in operations that are no fault: backwards, behind a noisy front end, while the supply sinks.

mod common;

use common::{Program, Seen, Sensors, plain, scenario, variant};
use scenario::Scenario;

/// Order of the lamps on the wires: RUN, r1..r4, SENSOR, LINE, LOAD, FAULT.
const SENSOR: usize = 5;
const FAULT: usize = 8;
const DARK: [&str; 2] = ["SENSOR", "FAULT"];

/// The default motor, and the same calibrated.
fn programs() -> [(&'static str, Program); 2] {
    [("plain", plain()), ("calibrated", variant("calibrated"))]
}

/// The lamps are the host's all the time, and none of them ever shows a fault.
fn check(seen: &mut Seen, what: &str) {
    seen.assert_as_on_the_host(what);
    let tally = seen.board.tally();
    let trouble = (tally.missed_triggers, tally.resets);
    assert_eq!(trouble, (0, 0), "{what}: {tally:?}");
    println!("{what}: {:?}", seen.lit());
    for (lamp, name) in [SENSOR, FAULT].into_iter().zip(DARK) {
        let lit = seen.observed.iter().find(|(levels, _)| levels[lamp]);
        assert!(lit.is_none(), "{what}: {name} lights: {lit:?}");
    }
}

fn watch(program: &Program, scenario: &Scenario, backwards: bool) -> Seen {
    let sensors = Sensors::new(scenario);
    let sensors = if backwards {
        sensors.mirrored()
    } else {
        sensors
    };
    program.watch_sensors(sensors, scenario.duration_s)
}

#[test]
fn a_motor_that_runs_backwards_is_its_own_mirror_image() {
    for (name, program) in programs() {
        let mut seen = watch(&program, &scenario(1.6), true);
        check(&mut seen, &format!("{name}, backwards"));
        let shown = seen.board.lamps().map(u8::from);
        assert_eq!(shown, [1, 0, 0, 0, 0, 0, 0, 0, 0], "{name}");
    }
}

#[test]
fn a_noisy_front_end_lights_no_fault() {
    for (name, program) in programs() {
        for backwards in [false, true] {
            let mut scenario = scenario(1.6);
            scenario.motor.sensors.noise_sigma_fraction_of_full_scale = 0.01;
            let mut seen = watch(&program, &scenario, backwards);
            check(
                &mut seen,
                &format!("{name}, 1 % noise, backwards {backwards}"),
            );
        }
    }
}

#[test]
fn a_supply_that_sinks_lights_no_fault() {
    for (name, program) in programs() {
        for backwards in [false, true] {
            let mut scenario = scenario(5.0);
            let sunk = 0.9 * scenario.motor.nameplate.phase_voltage_amplitude();
            scenario.supply.amplitude_volt.change(1.0, sunk, 3.0);
            let mut seen = watch(&program, &scenario, backwards);
            check(
                &mut seen,
                &format!("{name}, supply -10 % in 3 s, backwards {backwards}"),
            );
        }
    }
}
