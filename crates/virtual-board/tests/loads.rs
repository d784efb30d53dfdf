//! A healthy motor shows RUN and nothing else, whatever it drives and whatever the supply.
//!
//! A motor file that declares a load (kind "friction") rightly complains of another one: it is Table 1's row `Bl`. What
//! drives anything says so: kind "free".

mod common;

use common::variant;
use scenario::{Piecewise, Scenario, Start};

/// The supply comes after the board has found none.
const SWITCH_ON_S: f64 = 0.3;
const END_S: f64 = 1.5;
/// Instants that the firmware throws away, and those before the supply comes.
const SILENT: usize = 3_000;
const HEALTHY: [bool; 9] = [true, false, false, false, false, false, false, false, false];

#[test]
fn from_start_to_load_a_healthy_motor_lights_run_alone() {
    let program = variant("free-load");
    for supply in [0.9, 1.0, 1.1] {
        for load in [0.1, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5] {
            let what = format!("load {load}, supply {supply}");
            let mut scenario = Scenario::of(program.motor.clone(), END_S);
            scenario.seed = 11;
            scenario.start = Start::Standstill;
            scenario.supply.switch_on_s = SWITCH_ON_S;
            let rated = program.motor.nameplate.phase_voltage_amplitude();
            scenario.supply.amplitude_volt = Piecewise::constant(supply * rated);
            scenario.load.friction_factor = load;
            let mut seen = program.watch(&scenario);
            seen.assert_as_on_the_host(&what);
            for lamps in seen.host.iter().skip(SILENT) {
                let lit: Vec<_> = lamps.lit_names().filter(|name| *name != "line").collect();
                assert!(lit.is_empty(), "{what}: {lit:?}");
            }
            assert_eq!(seen.board.lamps(), HEALTHY, "{what}, at the end");
            let tally = seen.board.tally();
            assert_eq!(
                (tally.missed_triggers, tally.resets),
                (0, 0),
                "{what}: {tally:?}"
            );
        }
    }
}
