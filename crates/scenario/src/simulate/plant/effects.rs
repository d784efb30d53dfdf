//! The effects of a motor file and of a scenario inside the simulated motor.

use super::full::Make;
use super::presence::{EXTRA_STATES, common_series};
use super::waveform::Waveform;
use crate::simulate::SimulationError;
use crate::{Asymmetry, Fault, Scenario, Target};
use motor::MotorFile;
use motor::dynamic::Dynamic;
use motor::effect::{
    Descriptor, EffectConfig, EffectStack, Hook, Side, Timeline, extra_states, from_entry, rated,
};
use motor::effects::asymmetry_of;
use motor::motor_file::EffectEntry;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

/// The supply frequency is told to effects this often, s.
const TIMELINE_S: f64 = 1e-3;

/// Effects inside the motor or between it and the supply.
pub(super) fn inside(scenario: &Scenario) -> Result<Vec<EffectConfig>, SimulationError> {
    let mut effects = configs(scenario)?;
    effects.retain(|config| !config.effect.is_of_instruments());
    Ok(effects)
}

/// Effects on the instruments.
pub(in crate::simulate) fn of_instruments(
    scenario: &Scenario,
) -> Result<Vec<EffectConfig>, SimulationError> {
    let mut effects = configs(scenario)?;
    effects.retain(|config| config.effect.is_of_instruments());
    Ok(effects)
}

/// All effects in force, those of the motor file first.
fn configs(scenario: &Scenario) -> Result<Vec<EffectConfig>, SimulationError> {
    let entries = scenario.motor.effects.iter().chain(&scenario.effects);
    let effects: Vec<_> = entries
        .map(|entry| {
            check_entry(&scenario.motor, entry).map_err(|(key, message)| SimulationError::Effect {
                name: entry.name.clone(),
                key,
                message,
            })
        })
        .collect::<Result<_, _>>()?;
    if extra_states(&effects) > EXTRA_STATES {
        return Err(SimulationError::Effect {
            name: effects.last().map_or(String::new(), |last| {
                last.effect.descriptor().name.to_owned()
            }),
            key: "name".to_owned(),
            message: format!(
                "all effects together need more than {EXTRA_STATES} states: remove one"
            ),
        });
    }
    Ok(effects)
}

/// One entry as an effect, or the key to blame and why.
pub(crate) fn check_entry(
    motor: &MotorFile,
    entry: &EffectEntry,
) -> Result<EffectConfig, (String, String)> {
    from_entry(entry, &rated(motor)).map_err(|error| (error.key().to_owned(), error.to_string()))
}

/// What the faults of a scenario bring along when all of them are present, checked.
pub(in crate::simulate) fn of_faults(
    scenario: &Scenario,
) -> Result<Vec<EffectConfig>, SimulationError> {
    let faults: Vec<&Fault> = scenario.faults.iter().collect();
    let effect = |entry: EffectEntry| {
        check_entry(&scenario.motor, &entry).map_err(|(key, message)| SimulationError::Effect {
            name: entry.name,
            key,
            message: format!("{message}: give the fault another size"),
        })
    };
    broken_symmetry(&faults).into_iter().map(effect).collect()
}

/// Faults of symmetry as effects.
fn broken_symmetry(faults: &[&Fault]) -> Vec<EffectEntry> {
    let sum = |side: Side, part: fn(Asymmetry, f64) -> Option<Complex64>| {
        let parts = faults.iter().filter_map(|fault| match fault.target {
            Target::Asymmetry(asymmetry) => part(asymmetry, fault.share()),
            _ => None,
        });
        let k: Complex64 = parts.sum();
        let effect = asymmetry_of(side)?;
        (k.norm_sqr() > 0.0).then_some((effect.descriptor(), k))
    };
    // Relative to the resistance that `common_series` has raised already.
    let stator = sum(Side::Stator, series_in_phase)
        .map(|(effect, k)| (effect, k / (1.0 + common_series(faults))));
    let rotor = sum(Side::Rotor, bars);
    let entry = |(effect, k): (&'static Descriptor, Complex64)| {
        let keys = effect.parameters.iter().map(|parameter| parameter.name);
        EffectEntry::with_numbers(effect.name, keys.zip([k.re, k.im]))
    };
    stator.into_iter().chain(rotor).map(entry).collect()
}

/// The second term of [`super::presence::common_series`].
fn series_in_phase(asymmetry: Asymmetry, share: f64) -> Option<Complex64> {
    let Asymmetry::Series(phase) = asymmetry else {
        return None;
    };
    let gamma = [0.0, TAU / 3.0, 2.0 * TAU / 3.0][phase % 3];
    Some(Complex64::from_polar(share / 3.0, 2.0 * gamma))
}

fn bars(asymmetry: Asymmetry, share: f64) -> Option<Complex64> {
    (asymmetry == Asymmetry::RotorBars).then_some(share.into())
}

/// Builds the motor with its effects, again whenever a fault changes its parameters.
pub(super) fn factory(
    scenario: &Scenario,
    effects: Vec<EffectConfig>,
) -> Make<EffectStack<EXTRA_STATES>> {
    let rated = rated(&scenario.motor);
    let timeline = Arc::new(timeline(scenario));
    let file = scenario.motor.clone();
    Arc::new(move |motor, mechanics, faults| {
        let mut motor = *motor;
        // Checked by `of_faults`. They have no states of their own: those of the others stay where they are.
        let broken = broken_symmetry(faults).into_iter();
        let broken = broken.filter_map(|entry| check_entry(&file, &entry).ok());
        let effects: Vec<_> = effects.iter().cloned().chain(broken).collect();
        for effect in &effects {
            if effect.effect.hooks().contains(&Hook::Motor) {
                effect.effect.motor(&effect.values, &rated, &mut motor);
            }
        }
        let stack = EffectStack::new(&effects, &motor, &rated, timeline.clone());
        Dynamic::with_effects(&motor, mechanics, stack)
    })
}

fn timeline(scenario: &Scenario) -> Timeline {
    let waveform = Waveform::new(&scenario.supply);
    // Bounded: a scenario lasts at most a day.
    let count = (scenario.duration_s / TIMELINE_S).ceil() as u32 + 1;
    Timeline {
        t_sample: TIMELINE_S,
        omega_sync: (0..count)
            .map(|k| waveform.omega_sync(f64::from(k) * TIMELINE_S))
            .collect(),
        theta_mech: Vec::new(),
        cuts: Vec::new(),
    }
}
