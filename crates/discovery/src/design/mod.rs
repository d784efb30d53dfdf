//! The next experiment: the run that decides best what the recordings leave open.
//!
//! What is open are explanations that the recordings cannot tell apart, effects that they could not show, or parameters
//! that they leave wide ([`goal`]). Feasible runs ([`family`], within the user's [`limits`]) are simulated with every
//! explanation ([`virtual_waveform`]); the best one keeps them furthest apart after everything was refitted ([`score`]).

mod family;
mod goal;
pub(crate) mod limits;
pub(crate) mod plan;
pub(crate) mod report;
mod score;
pub(crate) mod search;
mod virtual_waveform;
