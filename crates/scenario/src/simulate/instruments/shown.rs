//! Effects on the instruments: what they would have shown, from whole signals that were true.

use super::sensing::Instruments;
use crate::simulate::{SimSample, SimulationError, Truth};
use crate::{Scenario, SpeedSensor};
use motor::dynamic::{clarke, phases};
use motor::effect::{EffectConfig, Hook, Inputs, Outputs, Rated, rated};
use num_complex::Complex64;

/// An effect turns what was shown into what was true; the other way around takes a few rounds, a gain error of 10 % one for
/// each digit.
const ROUNDS: usize = 60;
/// Share of the rated voltage and torque at which a round changes nothing any more.
const CONVERGED: f64 = 1e-13;

/// The samples as faulty instruments show them; noise, resolution and `[[faults]]` come on top.
///
/// # Errors
/// An effect on the speed while an encoder counts edges, which such an effect leaves alone.
pub(in crate::simulate) fn shown(
    scenario: &Scenario,
    effects: &[EffectConfig],
    mut samples: Vec<SimSample>,
) -> Result<Vec<SimSample>, SimulationError> {
    let mut truths: Vec<Truth> = samples.iter().map(|sample| sample.truth).collect();
    change(scenario, effects, &mut truths);
    check_encoder(scenario, effects, &samples, &truths)?;
    let mut instruments = Instruments::new(scenario);
    for (sample, truth) in samples.iter_mut().zip(&truths) {
        sample.measured = instruments.read(sample.t, truth, &scenario.faults);
    }
    Ok(samples)
}

fn change(scenario: &Scenario, effects: &[EffectConfig], truths: &mut [Truth]) {
    let rated = rated(&scenario.motor);
    let t_sample = 1.0 / scenario.sample_rate_hz;
    let inputs = shown_inputs(effects, &rated, &true_inputs(truths, t_sample));
    let outputs = shown_outputs(effects, &rated, truths, &inputs, scenario.record_from_s);
    for (k, truth) in truths.iter_mut().enumerate() {
        truth.u_s_abc = phases(inputs.u_s[k]).map(|u| u + outputs.u_zero[k]);
        truth.tau_load = inputs.tau_load[k];
        truth.i_s_abc = outputs.i_s_abc[k];
        truth.omega_mech = outputs.omega_mech[k];
    }
}

fn uses(effects: &[EffectConfig], hook: Hook) -> impl Iterator<Item = &EffectConfig> {
    effects
        .iter()
        .filter(move |e| e.effect.hooks().contains(&hook))
}

fn true_inputs(truths: &[Truth], t_sample: f64) -> Inputs {
    Inputs {
        t_sample,
        u_s: truths.iter().map(|truth| clarke(truth.u_s_abc)).collect(),
        tau_load: truths.iter().map(|truth| truth.tau_load).collect(),
    }
}

/// The inputs that the effects turn into the true ones.
fn shown_inputs(effects: &[EffectConfig], rated: &Rated<f64>, truth: &Inputs) -> Inputs {
    let mut truth = truth.clone();
    let mut show = |e: &&EffectConfig| e.effect.shown_inputs(&e.values, rated, &mut truth);
    let others: Vec<&EffectConfig> = uses(effects, Hook::Inputs).filter(|e| !show(e)).collect();
    let mut shown = truth.clone();
    for _ in 0..ROUNDS {
        let mut back = shown.clone();
        for e in &others {
            e.effect.inputs(&e.values, rated, &mut back);
        }
        if step(&mut shown, &truth, &back, rated) < CONVERGED {
            break;
        }
    }
    shown
}

/// Moves `shown` by what is missing, and says how much that was at most.
fn step(shown: &mut Inputs, truth: &Inputs, back: &Inputs, rated: &Rated<f64>) -> f64 {
    let mut most = 0.0_f64;
    for (k, u) in shown.u_s.iter_mut().enumerate() {
        let missing: Complex64 = truth.u_s[k] - back.u_s[k];
        *u += missing;
        most = most.max(missing.norm() / rated.voltage);
    }
    for (k, tau) in shown.tau_load.iter_mut().enumerate() {
        let missing = truth.tau_load[k] - back.tau_load[k];
        *tau += missing;
        most = most.max(missing.abs() / rated.torque);
    }
    most
}

fn shown_outputs(
    effects: &[EffectConfig],
    rated: &Rated<f64>,
    truths: &[Truth],
    inputs: &Inputs,
    t_start: f64,
) -> Outputs {
    let mut outputs = Outputs {
        t_start,
        t_sample: inputs.t_sample,
        i_s_abc: truths.iter().map(|truth| truth.i_s_abc).collect(),
        omega_mech: truths.iter().map(|truth| truth.omega_mech).collect(),
        theta_mech: truths.iter().map(|truth| truth.theta_mech).collect(),
        u_zero: vec![0.0; truths.len()],
        u_measured: inputs.u_s.clone(),
    };
    for e in uses(effects, Hook::Outputs) {
        e.effect
            .outputs(&e.effect.prepared(&e.values, rated), rated, &mut outputs);
    }
    outputs
}

fn check_encoder(
    scenario: &Scenario,
    effects: &[EffectConfig],
    samples: &[SimSample],
    shown: &[Truth],
) -> Result<(), SimulationError> {
    let mut pairs = samples.iter().zip(shown);
    let moved = pairs.any(|(sample, truth)| sample.truth.omega_mech != truth.omega_mech);
    if !moved || scenario.sensors.speed != SpeedSensor::Encoder {
        return Ok(());
    }
    let names: Vec<&str> = effects.iter().map(|e| e.effect.descriptor().name).collect();
    Err(SimulationError::Effect {
        name: names.join(", "),
        key: "name".to_owned(),
        message: "an encoder counts edges, which no error of a tachometer changes: \
                  write speed = \"tachometer\" in [sensors]"
            .to_owned(),
    })
}
