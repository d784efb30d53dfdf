//! What the commands do with files, devices and terminals, run as a user runs them.

#[path = "../common/mod.rs"]
mod common;

mod batch;
mod calibrate;
mod campaign;
mod cli;
mod export;
mod flash;
mod full_disk;
mod import;
mod live;
mod outputs;
mod programs;
mod same_bytes;
