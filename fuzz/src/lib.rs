//! What is fuzzed: every parser that input reaches, and the monitor under any sequence of samples.
//!
//! A target takes bytes and panics when something that must hold does not. `tools/fuzz` runs the targets under
//! libFuzzer; `tests/short.rs` runs seeds, findings and a fixed number of mutations with every `cargo test`.

mod mutation;
mod seeds;
mod targets;

pub use mutation::Mutator;

/// One thing that is fuzzed.
pub struct Target {
    /// Its name on the command line and in the folders.
    pub name: &'static str,
    /// Runs it; panics on a finding.
    pub run: fn(&[u8]),
    /// Inputs to begin with.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Mutations in the short run, so that each target takes about a second.
    pub short: u32,
}

const fn target(
    name: &'static str,
    run: fn(&[u8]),
    seeds: fn() -> Vec<Vec<u8>>,
    short: u32,
) -> Target {
    Target {
        name,
        run,
        seeds,
        short,
    }
}

/// Every target.
pub const TARGETS: [Target; 18] = [
    target(
        "motor-file",
        targets::motor_file,
        seeds::motor_files,
        20_000,
    ),
    target("scenario", targets::scenario, seeds::scenarios, 5_000),
    target("campaign", targets::campaign, seeds::campaigns, 5_000),
    target("sidecar", targets::sidecar, seeds::sidecars, 40_000),
    target("csv", targets::csv, seeds::csv, 10_000),
    target("csv-gz", targets::csv_gz, seeds::csv_gz, 10_000),
    target("load-table", targets::csv, seeds::load_tables, 10_000),
    target("parquet", targets::parquet, seeds::parquet, 10_000),
    target("mat", targets::mat, seeds::mat, 10_000),
    target("comtrade", targets::comtrade, seeds::comtrade, 5_000),
    target("workbook", targets::workbook, seeds::workbooks, 5_000),
    target("wav", targets::wav, seeds::wav, 10_000),
    target("stream", targets::stream, seeds::streams, 5_000),
    target("telemetry", targets::telemetry, seeds::telemetry, 200_000),
    target("modbus", targets::modbus, seeds::modbus, 200_000),
    target(
        "modbus-tcp",
        targets::modbus_tcp,
        seeds::modbus_tcp,
        100_000,
    ),
    target("sparkplug", targets::sparkplug, seeds::sparkplug, 15_000),
    target("monitor", targets::monitor, seeds::samples, 400),
];

/// The target of a name.
pub fn find(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}
