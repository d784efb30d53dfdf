//! The whole core on a motor in steady state, from samples to reports.

mod backwards;
mod calibrated;
mod codes;
mod doubt;
mod drive;
mod judgement;
#[path = "../../tests/motor_2200_watt/mod.rs"]
pub mod motor_2200_watt;
mod noise;

use crate as monitor;
