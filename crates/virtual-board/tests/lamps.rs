//! The lamps of the board are the lamps of the host on the same samples.

mod common;

use common::{Seen, motor, scenario, watch};
use motor::motor_file::Frame;
use scenario::{Change, Fault, Piecewise, PlantKind, Scenario, Start};

const FAULT_FROM_S: f64 = 0.8;
const END_S: f64 = 2.0;

fn faulty(name: &str, percent: f64) -> Scenario {
    let mut scenario = scenario(END_S);
    let mut fault = Fault::percent(name, percent, Frame::RotorFlux).expect("a known fault");
    fault.from_s = FAULT_FROM_S;
    scenario.faults = vec![fault];
    scenario
}

fn check(scenario: &Scenario, what: &str) -> Seen {
    let mut seen = watch(scenario);
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
fn a_healthy_motor_shows_run_and_nothing_else_at_every_supply() {
    for (load, supply) in [
        (0.1, 1.0),
        (0.5, 1.0),
        (1.0, 1.0),
        (1.5, 1.0),
        (1.0, 0.9),
        (1.0, 1.1),
    ] {
        let mut scenario = scenario(1.0);
        scenario.supply.amplitude_volt =
            Piecewise::constant(supply * motor().nameplate.phase_voltage_amplitude());
        // This motor file declares its load (kind "friction"): another load is Table 1's row B_l, not healthy.
        scenario.load.friction_factor = load;
        let seen = check(&scenario, &format!("load {load}, supply {supply}"));
        if load == 1.0 {
            let lamps = seen.host.last().expect("samples");
            assert!(lamps.is_quiet(), "load {load}, supply {supply}: {lamps:?}");
            let (levels, _) = seen.observed.last().expect("observations");
            assert_eq!(
                levels,
                &[true, false, false, false, false, false, false, false, false]
            );
        }
    }
}

#[test]
fn every_row_of_table_1_lights_the_hosts_lamps() {
    let rows = ["Rs", "Rr", "Lls", "Llr", "Lm", "B", "Bl", "Iq", "Vq", "wr"];
    for name in rows {
        for percent in [50.0, -50.0] {
            let seen = check(&faulty(name, percent), &format!("{name} {percent:+} %"));
            assert!(
                !seen.lit().is_empty(),
                "{name} {percent:+} % lights nothing at all"
            );
        }
    }
}

#[test]
fn the_linear_plants_inductances_light_the_hosts_lamps() {
    for name in ["Ls", "Lr"] {
        for percent in [50.0, -50.0] {
            let mut scenario = faulty(name, percent);
            scenario.plant = PlantKind::Linear;
            let seen = check(&scenario, &format!("{name} {percent:+} % (linear)"));
            assert!(!seen.lit().is_empty(), "{name} {percent:+} %");
        }
    }
}

#[test]
fn each_dead_sensor_lights_sensor_within_half_a_second() {
    for name in ["va", "vb", "vc", "ia", "ib", "ic", "speed"] {
        let mut scenario = faulty(name, 0.0);
        scenario.faults[0].change = Change::Factor(0.0);
        let seen = check(&scenario, &format!("{name} dead"));
        let within = ((FAULT_FROM_S + 0.5) * 1e4) as usize;
        let lit = |(levels, taken): &([bool; 9], usize)| levels[5] && *taken <= within;
        assert!(
            seen.observed.iter().any(lit),
            "{name} dead: {:?}",
            seen.lit()
        );
    }
}

#[test]
fn a_lost_supply_lights_line_and_no_sensor() {
    let mut scenario = scenario(END_S);
    scenario
        .supply
        .amplitude_volt
        .change(FAULT_FROM_S, 0.0, 0.0);
    let seen = check(&scenario, "supply lost");
    assert_eq!(seen.lit(), ["line"]);
}

#[test]
fn a_start_from_rest_lights_nothing() {
    let mut scenario = scenario(END_S);
    scenario.start = Start::Standstill;
    scenario.supply.switch_on_s = 0.3;
    let seen = check(&scenario, "start");
    let after_start = seen.host.iter().skip(4_000);
    for lamps in after_start {
        let lit: Vec<_> = lamps.lit_names().filter(|name| *name != "line").collect();
        assert!(lit.is_empty(), "{lit:?}");
    }
}
