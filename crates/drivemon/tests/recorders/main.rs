//! Recordings as other people's instruments make them, judged by the program.

#[path = "../common/mod.rs"]
mod common;

mod instruments;
mod likely_cause;
mod noise_and_ramps;
mod pieces;
mod plate_only;
mod random_instruments;
mod unknown_scale;
