//! Inputs of a start and what our own simulation makes of them, at full precision: what exported models are held against.
//!
//! Usage: `reference MOTOR.toml INPUTS.csv OUTPUTS.csv`. Both tables have a row every 100 us, the step of the simulation; inputs are held from row
//! to row.

use motor::MotorFile;
use motor::dynamic::{clarke, phases};
use motor::effect::{
    Between, Inputs, Plant, Run, SpeedSource, Timeline, from_motor_file, rated, simulate,
};
use num_complex::Complex64;
use std::error::Error;
use std::fmt::Write as _;
use std::sync::Arc;

/// Step, s.
const STEP_S: f64 = export::model::STEP_S;
/// Steps: 0.4 s.
const STEPS: usize = 4000;
/// Load from here on, share of the start.
const LOADED_FROM: f64 = 0.6;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [motor, inputs, outputs] = arguments.as_slice() else {
        return Err("usage: reference MOTOR.toml INPUTS.csv OUTPUTS.csv".into());
    };
    let file = MotorFile::read(motor)?;
    let rated = rated(&file);
    let plant = Plant {
        motor: file.parameters,
        mechanics: file.mechanics,
        rated,
        effects: from_motor_file(&file, motor)?,
    };
    let (table, driven) = start(&plant);
    std::fs::write(inputs, table)?;
    let timeline = Arc::new(Timeline::constant(rated.omega_sync));
    let shown = simulate(
        &plant,
        &Run {
            inputs: &driven,
            between: Between::Held,
            speed: SpeedSource::Free,
            timeline: &timeline,
            running_at: None,
            running_at_cuts: &[],
            open: &[],
        },
    );
    let mut table = "t,i_a,i_b,i_c,speed,angle\n".to_owned();
    for (k, [a, b, c]) in shown.i_s_abc.iter().enumerate() {
        let t = STEP_S * k as f64;
        let (speed, angle) = (shown.omega_mech[k], shown.theta_mech[k]);
        writeln!(table, "{t:?},{a:?},{b:?},{c:?},{speed:?},{angle:?}")?;
    }
    std::fs::write(outputs, table)?;
    Ok(())
}

/// Rated voltage switched on a motor at rest, with a fifth harmonic and some unbalance; rated torque later. The table and the same as inputs of
/// a simulation.
fn start(plant: &Plant) -> (String, Inputs) {
    let rated = &plant.rated;
    let mut table = "t,u_a,u_b,u_c,tau_load,omega_sync\n".to_owned();
    let mut inputs = Inputs {
        t_sample: STEP_S,
        ..Inputs::default()
    };
    for k in 0..=STEPS {
        let t = STEP_S * k as f64;
        let turned = |size: f64, order: f64| {
            Complex64::from_polar(size * rated.voltage, order * rated.omega_sync * t)
        };
        let u = phases(turned(1.0, 1.0) + turned(0.02, -5.0) + turned(0.01, -1.0));
        let load = match k as f64 >= LOADED_FROM * STEPS as f64 {
            true => 0.8 * rated.torque,
            false => 0.0,
        };
        let [a, b, c] = u;
        let omega = rated.omega_sync;
        // A string takes whatever is written.
        let _ = writeln!(table, "{t:?},{a:?},{b:?},{c:?},{load:?},{omega:?}");
        inputs.u_s.push(clarke(u));
        inputs.tau_load.push(load);
    }
    (table, inputs)
}
