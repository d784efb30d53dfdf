//! Inputs of a start and what our own simulation makes of them, at full precision: what exported models are held against.
//!
//! Usage: `reference MOTOR.toml INPUTS.csv OUTPUTS.csv [smooth]`. The tables have a row every 100 us, the step of the simulation; inputs are held from
//! row to row, and the load comes after 60 % of the time. With `smooth` the inputs are what a solver with steps of its own sees: a voltage without
//! steps and a constant load, sampled every microsecond, of which our simulation takes two in a step.

use motor::MotorFile;
use motor::dynamic::{clarke, phases};
use motor::effect::{
    Between, Inputs, Plant, Run, SpeedSource, Timeline, from_motor_file, rated, simulate,
};
use num_complex::Complex64;
use std::error::Error;
use std::fmt::Write as _;
use std::sync::Arc;

/// Duration, s.
const DURATION_S: f64 = 0.4;
/// Time between samples that are held, and of a smooth supply, s.
const HELD_S: f64 = export::model::STEP_S;
const SMOOTH_S: f64 = 1e-6;
/// Smooth samples in a row of the tables.
const SMOOTH_ROW: usize = 100;
/// Load from here on, share of the start.
const LOADED_FROM: f64 = 0.6;
/// Load of each kind of start, share of the rated torque.
const LOAD: f64 = 0.8;
const SMOOTH_LOAD: f64 = 0.2;
/// Components of the supply: share of the rated voltage, order.
const SUPPLY: [(f64, f64); 3] = [(1.0, 1.0), (0.02, -5.0), (0.01, -1.0)];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (motor, inputs, outputs, between) = match arguments.as_slice() {
        [motor, inputs, outputs] => (motor, inputs, outputs, Between::Held),
        [motor, inputs, outputs, smooth] if smooth == "smooth" => {
            (motor, inputs, outputs, Between::Smooth)
        }
        _ => return Err("usage: reference MOTOR.toml INPUTS.csv OUTPUTS.csv [smooth]".into()),
    };
    let file = MotorFile::read(motor)?;
    let rated = rated(&file);
    let plant = Plant {
        motor: file.parameters,
        mechanics: file.mechanics,
        rated,
        effects: from_motor_file(&file, motor)?,
    };
    let (table, driven) = start(&plant, between);
    std::fs::write(inputs, table)?;
    std::fs::write(outputs, shown(&plant, &driven, between)?)?;
    Ok(())
}

/// Samples of a row.
fn row(between: Between) -> usize {
    match between {
        Between::Held => 1,
        Between::Smooth => SMOOTH_ROW,
    }
}

/// What the simulation makes of the inputs, as a table.
fn shown(plant: &Plant, inputs: &Inputs, between: Between) -> Result<String, std::fmt::Error> {
    let timeline = Arc::new(Timeline {
        t_sample: inputs.t_sample,
        ..Timeline::constant(plant.rated.omega_sync)
    });
    let run = Run {
        inputs,
        between,
        speed: SpeedSource::Free,
        timeline: &timeline,
        running_at: None,
        running_at_cuts: &[],
        offsets: &[],
        open: &[],
    };
    let shown = simulate(plant, &run);
    let mut table = "t,i_a,i_b,i_c,speed,angle\n".to_owned();
    let rows = shown.i_s_abc.iter().enumerate();
    for (k, [a, b, c]) in rows.step_by(row(between) / between.stride()) {
        let t = inputs.t_sample * (k * between.stride()) as f64;
        let (speed, angle) = (shown.omega_mech[k], shown.theta_mech[k]);
        writeln!(table, "{t:?},{a:?},{b:?},{c:?},{speed:?},{angle:?}")?;
    }
    Ok(table)
}

/// Voltage switched on a motor at rest: as a table, and as inputs of a simulation.
fn start(plant: &Plant, between: Between) -> (String, Inputs) {
    let rated = &plant.rated;
    let mut table = "t,u_a,u_b,u_c,tau_load,omega_sync\n".to_owned();
    let (t_sample, load, from) = match between {
        Between::Held => (HELD_S, LOAD, LOADED_FROM * DURATION_S),
        Between::Smooth => (SMOOTH_S, SMOOTH_LOAD, 0.0),
    };
    let mut inputs = Inputs {
        t_sample,
        ..Inputs::default()
    };
    let steps = (DURATION_S / t_sample).round() as usize;
    for k in 0..=steps {
        let t = t_sample * k as f64;
        let turned = |(size, order): (f64, f64)| {
            Complex64::from_polar(size * rated.voltage, order * rated.omega_sync * t)
        };
        let u = phases(SUPPLY.into_iter().map(turned).sum());
        let load = if t >= from { load * rated.torque } else { 0.0 };
        let ([a, b, c], omega) = (u, rated.omega_sync);
        if k % row(between) == 0 {
            // A string takes whatever is written.
            let _ = writeln!(table, "{t:?},{a:?},{b:?},{c:?},{load:?},{omega:?}");
        }
        inputs.u_s.push(clarke(u));
        inputs.tau_load.push(load);
    }
    (table, inputs)
}
