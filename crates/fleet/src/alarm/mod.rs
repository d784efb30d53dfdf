//! Alarms as operators know them (ANSI/ISA-18.2, IEC 62682).
//!
//! [`Desk`] is the life cycle alone: what it is told, and what it answers. [`Watch`] feeds it from a store and keeps there what
//! it answers, so that a crash at any moment loses no alarm and raises none twice.

mod action;
pub mod change;
mod desk;
mod flood;
mod life;
mod memory;
mod read;
mod rules;
#[cfg(test)]
mod tests;
mod watch;

pub use action::{Action, ActionError};
pub use change::{
    Alarm, AlarmCause, AlarmChange, AlarmFilter, AlarmState, Change, Evidence, Severity, Who,
};
pub use desk::Desk;
pub use memory::Memory;
pub use rules::Rules;
pub use watch::{Watch, WatchError};
