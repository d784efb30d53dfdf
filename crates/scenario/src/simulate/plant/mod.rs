//! The motor of a scenario, whichever equations stand in for it.

pub(super) mod effects;
mod full;
mod linear;
mod presence;
mod waveform;

use super::{SimulationError, Truth};
use crate::{Fault, PlantKind, Scenario};
use full::Full;
use linear::Linear;
use motor::dynamic::{Dynamic, NoEffects};
use motor::effect::EffectStack;
use motor::{Mechanics, TParams};
use presence::EXTRA_STATES;
use std::fmt;
use std::sync::Arc;

#[derive(Clone)]
pub(super) enum Plant {
    Plain(Full<NoEffects>),
    Effects(Box<Full<EffectStack<EXTRA_STATES>>>),
    Linear(Linear),
}

impl fmt::Debug for Plant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Plant::Plain(_) => "Plain",
            Plant::Effects(_) => "Effects",
            Plant::Linear(_) => "Linear",
        })
    }
}

impl Plant {
    pub(super) fn new(scenario: &Scenario) -> Result<Plant, SimulationError> {
        if scenario.plant == PlantKind::Linear {
            return Ok(Plant::Linear(Linear::new(scenario)));
        }
        let effects = effects::inside(scenario)?;
        if effects.is_empty() && effects::of_faults(scenario)?.is_empty() {
            let make = |motor: &TParams<f64>, mechanics: &Mechanics<f64>, _: &[&Fault]| {
                Dynamic::new(motor, mechanics)
            };
            return Ok(Plant::Plain(Full::new(scenario, Arc::new(make))?));
        }
        let make = effects::factory(scenario, effects);
        Ok(Plant::Effects(Box::new(Full::new(scenario, make)?)))
    }

    /// A motor that may get any fault while it runs: its equations always have room for effects.
    pub(super) fn switchable(scenario: &Scenario) -> Result<Plant, SimulationError> {
        if scenario.plant == PlantKind::Linear {
            return Plant::new(scenario);
        }
        effects::of_faults(scenario)?;
        let make = effects::factory(scenario, effects::inside(scenario)?);
        Ok(Plant::Effects(Box::new(Full::new(scenario, make)?)))
    }

    /// The list of faults is another one: whatever was in force is put in force anew.
    pub(super) fn forget_faults(&mut self) {
        match self {
            Plant::Plain(full) => full.forget_faults(),
            Plant::Effects(full) => full.forget_faults(),
            Plant::Linear(linear) => linear.forget_faults(),
        }
    }

    /// Puts the faults that are present at `t` in force.
    pub(super) fn switch_faults(&mut self, faults: &[Fault], t: f64) {
        match self {
            Plant::Plain(full) => full.switch_faults(faults, t),
            Plant::Effects(full) => full.switch_faults(faults, t),
            Plant::Linear(linear) => linear.switch_faults(faults, t),
        }
    }

    /// Everything at the instant `t`, s.
    pub(super) fn truth(&self, t: f64) -> Truth {
        match self {
            Plant::Plain(full) => full.truth(t),
            Plant::Effects(full) => full.truth(t),
            Plant::Linear(linear) => linear.truth(t),
        }
    }

    /// Goes from `t` to `t_next`, s.
    pub(super) fn advance(&mut self, t: f64, t_next: f64) {
        match self {
            Plant::Plain(full) => full.advance(t, t_next),
            Plant::Effects(full) => full.advance(t, t_next),
            Plant::Linear(linear) => linear.advance(t, t_next),
        }
    }
}
