//! Healthy motors over days, for the share of false alarms: steady hours cycle by cycle, events sample by sample.
//!
//! A motor-day at 10 kHz is 864 million samples; hours in which nothing happens are therefore made at the level of what the
//! monitor measures in a supply cycle (`cycles`), and starts, steps, dips and stops by the simulator (`events`). Both go through
//! one monitor state, from the measurement to the lamps.

mod cycles;
mod events;
mod habits;
mod instrument;
mod learn;
mod life;
mod machine;
mod operating;
mod weather;

#[cfg(test)]
mod tests;

pub use events::Event;
pub use learn::{Unlearnt, Watched};
pub use life::{Doing, Moment, Ran, live};
pub use machine::Machine;
