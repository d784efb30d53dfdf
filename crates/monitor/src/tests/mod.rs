//! The whole core on a motor in steady state, from samples to reports.

mod calibrated;
mod codes;
mod drive;
mod judgement;
