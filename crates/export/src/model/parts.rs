//! The effects of a model, in the order in which they act.

use crate::effects::{Equations, Own};
use motor::effect::Hook;

/// An effect of a model.
pub struct Part {
    /// What notes call it.
    pub label: String,
    /// Its place in the motor file.
    pub number: usize,
    /// Its parameters and states.
    pub own: Own,
    /// Hooks in which it takes part.
    pub hooks: &'static [Hook],
    /// Where its equations are.
    pub source: Source,
}

/// Where the equations of an effect are.
pub enum Source {
    /// In the library.
    Library(&'static (dyn Equations + Sync)),
    /// In the motor file.
    File(Box<dyn Equations>),
}

impl Part {
    /// Its equations.
    pub fn equations(&self) -> &dyn Equations {
        match &self.source {
            Source::Library(equations) => *equations,
            Source::File(equations) => &**equations,
        }
    }
}

/// The effects of a model.
#[derive(Default)]
pub struct Parts {
    all: Vec<Part>,
}

impl Parts {
    /// Adds one behind the others.
    pub fn push(&mut self, part: Part) {
        self.all.push(part);
    }

    /// All in the order of the file.
    pub fn all(&self) -> &[Part] {
        &self.all
    }

    /// Those that take part at a hook outside of the motor, in the order of the file.
    pub fn with_outer(&self, hook: Hook) -> impl Iterator<Item = &Part> {
        self.all
            .iter()
            .filter(move |part| part.hooks.contains(&hook))
    }

    /// Those that take part at a hook inside of the motor: two masses split whatever torque the others leave on the shaft, so that
    /// those with the fewest states come first.
    pub fn with(&self, hook: Hook) -> impl Iterator<Item = &Part> {
        let mut with: Vec<_> = self.with_outer(hook).collect();
        with.sort_by_key(|part| part.own.extra.len());
        with.into_iter()
    }
}
