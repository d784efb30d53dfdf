//! The effects of a motor file and of a scenario inside the simulated motor.

use super::SimulationError;
use super::full::Make;
use super::plant::EXTRA_STATES;
use super::waveform::Waveform;
use crate::scenario::Scenario;
use motor::MotorFile;
use motor::dynamic::Dynamic;
use motor::effects::{EffectConfig, EffectStack, Hook, Timeline, extra_states, from_entry, rated};
use motor::motor_file::EffectEntry;
use std::sync::Arc;

/// The supply frequency is told to effects this often, s.
const TIMELINE_S: f64 = 1e-3;

/// Effects inside the motor or between it and the supply.
pub(super) fn inside(scenario: &Scenario) -> Result<Vec<EffectConfig>, SimulationError> {
    let mut effects = configs(scenario)?;
    effects.retain(|effect| !is_of_instruments(effect));
    Ok(effects)
}

/// Effects on the instruments.
pub(super) fn of_instruments(scenario: &Scenario) -> Result<Vec<EffectConfig>, SimulationError> {
    let mut effects = configs(scenario)?;
    effects.retain(is_of_instruments);
    Ok(effects)
}

fn is_of_instruments(config: &EffectConfig) -> bool {
    let mut hooks = config.effect.hooks().iter();
    hooks.any(|hook| matches!(hook, Hook::Inputs | Hook::Outputs))
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

/// Builds the motor with its effects, again whenever a fault changes its parameters.
pub(super) fn factory(
    scenario: &Scenario,
    effects: Vec<EffectConfig>,
) -> Make<EffectStack<EXTRA_STATES>> {
    let rated = rated(&scenario.motor);
    let timeline = Arc::new(timeline(scenario));
    Box::new(move |motor, mechanics| {
        let mut motor = *motor;
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
    }
}
