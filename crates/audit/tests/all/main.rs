//! The audit against recordings whose faults are known.

mod clipping;
#[path = "../../../formats/tests/all/common.rs"]
mod common;
mod faults;
mod lost_samples;
mod mapping;
mod operation;
mod real_files;
mod recorders;
mod synthetic;
