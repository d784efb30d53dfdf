//! A recording that nobody made yet: what drives it, and how well its instruments would see it.

use super::plan::Plan;
use estimation::data::case::{RELATIVE_CURRENT, Waveform};
use estimation::data::channels::N_CHANNELS;
use estimation::fit::nuisance::Nuisance;
use estimation::model::prediction::{Drive, SpeedObserver, run};
use motor::effect::{Inputs, Plant, Timeline};
use num_complex::Complex64;
use signal::{Supply, Windows};
use std::f64::consts::TAU;

/// A run of a plant, recorded as another recording was.
pub(super) fn virtual_waveform(plan: &Plan, like: &Waveform, plant: &Plant) -> Waveform {
    let t_sample = like.inputs.t_sample;
    let per_row = like.samples_per_row();
    let rows = (plan.duration_s / t_sample) as usize / per_row;
    let count = rows * per_row;
    let time = |k: usize| k as f64 * t_sample;
    let mut angle = 0.0;
    let u_s = (0..count).map(|k| {
        let u = Complex64::from_polar(plan.voltage(time(k)) * plant.rated.voltage, angle);
        angle += TAU * plan.frequency_hz(time(k)) * t_sample;
        u
    });
    let u_s: Vec<Complex64> = u_s.collect();
    let load = |k: usize| plan.load(time(k)) * plant.rated.torque;
    let first = TAU * plan.frequency_hz(0.0) / plant.mechanics.n_p;
    let mut waveform = Waveform {
        inputs: Inputs {
            t_sample,
            u_s,
            tau_load: (0..count).map(load).collect(),
        },
        timeline: Timeline {
            t_sample,
            omega_sync: (0..count)
                .map(|k| TAU * plan.frequency_hz(time(k)))
                .collect(),
            theta_mech: Vec::new(),
            cuts: Vec::new(),
        }
        .into(),
        speed: Vec::new(),
        speed_is_input: false,
        running_at: (!plan.starts).then_some(first),
        running_at_cuts: Vec::new(),
        settles: !plan.starts,
        open: plan.open(t_sample, count),
        measured: Vec::new(),
        weight: Vec::new(),
        supply: Supply::default(),
        coarse: None,
        load_windows: Windows::default(),
        speed_windows: Windows::default(),
        between: like.between,
        decimation: like.decimation,
        block: like.block,
        finer: like.finer,
        input_noise: like.input_noise,
        speed_held_s: 0.0,
        inverter: plan.drive,
        speed_scale_is_free: like.speed_scale_is_free,
        nuisance: Nuisance::default(),
    };
    see(&mut waveform, like, plant, rows);
    waveform
}

/// What the instruments would show of the believed plant, and their noise.
fn see(waveform: &mut Waveform, like: &Waveform, plant: &Plant, rows: usize) {
    let outputs = run(waveform, plant, &Drive::of(waveform), SpeedObserver::Off);
    let noise = noise(like);
    let omega: Vec<f64> = outputs.omega_mech.clone();
    for row in 0..rows {
        let k = row * waveform.decimation;
        let [a, b, c] = outputs.i_s_abc[k];
        let measured = [a, b, c, outputs.omega_mech[k], 0.0];
        let weight = |channel: usize| match (noise[channel], channel) {
            (0.0, _) => 0.0,
            (sigma, 0..3) => 1.0 / sigma.hypot(RELATIVE_CURRENT * measured[channel]),
            (sigma, _) => 1.0 / sigma,
        };
        waveform.measured.push(measured);
        waveform.weight.push(core::array::from_fn(weight));
    }
    if like.speed_is_input {
        // What the motor carries is not measured: its speed is.
        let stride = waveform.between.stride();
        let last = omega.len() - 1;
        waveform.speed = (0..waveform.inputs.u_s.len())
            .map(|k| omega[(k / stride).min(last)])
            .collect();
        waveform.speed_is_input = true;
    }
}

/// Standard deviation of each channel where its value is small; zero where it is not judged.
fn noise(like: &Waveform) -> [f64; N_CHANNELS] {
    let largest = |channel: usize| like.weight.iter().map(|w| w[channel]).fold(0.0, f64::max);
    core::array::from_fn(|channel| match largest(channel) {
        0.0 => 0.0,
        weight => 1.0 / weight,
    })
}
