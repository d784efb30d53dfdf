//! The targets: bytes in, a panic when something that must hold does not.

mod configuration;
mod plant;
mod recordings;
mod samples;
mod wire;

pub(crate) use configuration::{campaign, motor_file, scenario, sidecar};
pub(crate) use plant::{modbus_tcp, sparkplug};
pub(crate) use recordings::{comtrade, csv, csv_gz, mat, parquet, stream, wav, workbook};
pub(crate) use samples::monitor;
pub(crate) use wire::{modbus, telemetry};
