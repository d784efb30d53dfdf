//! What each effect costs a simulation, beside the motor without effects in the same run:
//! `cargo run --release -p studies --example effect_cost`.
//!
//! Each set of effects takes turns with the bare motor, so that whatever else the machine does meets both; the shortest of
//! the runs counts.

use motor::MotorFile;
use motor::effect::{
    Between, EffectConfig, Inputs, Plant, Run, SpeedSource, Timeline, extra_states, rated, simulate,
};
use motor::effects::{ALL, find};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Supply, rad/s.
const OMEGA: f64 = TAU * 50.0;
/// Time between samples, s; a step spans two.
const T_SAMPLE: f64 = 1e-4;
/// Samples of a recording of two seconds.
const SAMPLES: usize = 20_001;
/// Runs of each set of effects and of the bare motor.
const RUNS: usize = 15;
/// Sets of several effects, as a search meets them.
const SETS: [&[&str]; 3] = [
    &["windage", "magnetizing-saturation"],
    &["core-loss", "magnetizing-saturation", "windage"],
    &["dc-link", "stator-heating", "shaft-compliance"],
];

/// A motor that ships, without its effects.
fn bare() -> Plant {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../motors/peer-2k2.toml");
    let motor = MotorFile::read(file).expect("it ships");
    Plant {
        motor: motor.parameters,
        mechanics: motor.mechanics,
        rated: rated(&motor),
        effects: Vec::new(),
    }
}

fn inputs() -> Inputs {
    let u = |k: usize| Complex64::from_polar(326.6, OMEGA * T_SAMPLE * k as f64);
    Inputs {
        t_sample: T_SAMPLE,
        u_s: (0..SAMPLES).map(u).collect(),
        tau_load: vec![10.0; SAMPLES],
    }
}

/// Supply frequency and measured angle at every sample, as a recording has them.
fn timeline() -> Arc<Timeline> {
    Arc::new(Timeline {
        t_sample: T_SAMPLE,
        omega_sync: vec![OMEGA; SAMPLES],
        theta_mech: (0..SAMPLES).map(|k| 150.0 * T_SAMPLE * k as f64).collect(),
        cuts: Vec::new(),
    })
}

/// Nanoseconds of one integration step.
fn step_ns(plant: &Plant, inputs: &Inputs, timeline: &Arc<Timeline>) -> f64 {
    let run = Run {
        inputs,
        between: Between::Smooth,
        speed: SpeedSource::Free,
        timeline,
        running_at: None,
        running_at_cuts: &[],
        offsets: &[],
        open: &[],
    };
    let begin = Instant::now();
    let steps = black_box(simulate(plant, &run)).omega_mech.len();
    begin.elapsed().as_secs_f64() * 1e9 / steps as f64
}

fn main() {
    let (inputs, timeline, bare) = (inputs(), timeline(), bare());
    let typical = |name: &&str| {
        let effect = find(name, "").expect("an effect of the library");
        EffectConfig::typical(effect, &bare.rated)
    };
    let alone = ALL.iter().map(|effect| {
        let d = effect.descriptor();
        let name = format!("{} {}", d.name, d.form);
        (name, vec![EffectConfig::typical(*effect, &bare.rated)])
    });
    let sets = SETS.map(|names| (names.join(" + "), names.iter().map(typical).collect()));
    println!(
        "{:62} {:>6} {:>9} {:>9}",
        "effects", "states", "ns a step", "/ bare"
    );
    for (name, effects) in alone.chain(sets) {
        let states = extra_states(&effects);
        let with = Plant {
            effects,
            ..bare.clone()
        };
        let pair = || {
            let both = [&bare, &with];
            both.map(|plant| step_ns(plant, &inputs, &timeline))
        };
        let runs: Vec<[f64; 2]> = (0..RUNS).map(|_| pair()).collect();
        let shortest = |k: usize| runs.iter().map(|run| run[k]).fold(f64::INFINITY, f64::min);
        let [bare, with] = [0, 1].map(shortest);
        println!("{name:62} {states:>6} {with:>9.0} {:>9.1}", with / bare);
    }
}
