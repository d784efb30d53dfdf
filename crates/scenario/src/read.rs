//! The top level of a scenario file.

use super::{PlantKind, Scenario, Start, faults, load, sensors, supply};
use crate::simulate::check_entry;
use document::{Bounds, Document, FileError, Section};
use motor::MotorFile;
use motor::motor_file::{EffectEntry, read_effects};
use std::path::{Path, PathBuf};

const MOTOR: &str = "the path of a motor file, seen from the scenario's folder, in double quotes";
const DURATION: Bounds = Bounds::above(0.0, 86_400.0, "s");
const SAMPLE_RATE: Bounds =
    Bounds::between(100.0, 1e6, "Hz").hint("samples per second, not the time between them");
const TIME: Bounds = Bounds::between(0.0, 86_400.0, "s");
const INTERVAL: Bounds = Bounds::above(0.0, 3600.0, "s");
/// Whole numbers that a TOML float holds exactly.
const SEED: Bounds = Bounds::between(0.0, 4_294_967_295.0, "");
/// A recording with more samples than this does not fit the memory of a small computer.
const MOST_SAMPLES: f64 = 5e7;
/// A sinusoid sampled less often than this per period cannot be told from another.
const SAMPLES_PER_PERIOD: f64 = 10.0;

const PLANTS: [(&str, PlantKind); 2] = [("full", PlantKind::Full), ("linear", PlantKind::Linear)];
const STARTS: [(&str, Start); 2] = [
    ("standstill", Start::Standstill),
    ("running", Start::Running),
];

/// Reads the motor file that the scenario names; its problems are reported as its own.
pub(super) fn motor_file(
    document: &Document,
    folder: &Path,
) -> Result<(PathBuf, MotorFile), FileError> {
    let root = document.root();
    let Some(name) = root.text("motor", MOTOR) else {
        if !root.has("motor") {
            root.report("motor", format!("is missing: add {MOTOR}"));
        }
        return Err(document.failure());
    };
    let path = folder.join(&name);
    if !path.is_file() {
        let message = format!("there is no file {}: write {MOTOR}", path.display());
        root.report("motor", message);
        return Err(document.failure());
    }
    let motor = MotorFile::read(&path)?;
    Ok((path, motor))
}

pub(super) fn scenario(document: &Document, motor: MotorFile) -> Option<Scenario> {
    let root = document.root();
    let scenario = read_values(document, &root, motor);
    if let Some(scenario) = &scenario {
        check_times(&root, scenario);
        check_plant(&root, scenario);
    }
    root.finish();
    scenario
}

fn read_values(document: &Document, root: &Section<'_>, motor: MotorFile) -> Option<Scenario> {
    // Read before; asked for again so that it counts as known.
    let _ = root.optional_text("motor");
    let base = Scenario::of(motor, 1.0);
    let name = root.optional_text("name");
    let plant = root.choice_or("plant", &PLANTS, base.plant);
    let start = root.choice_or("start", &STARTS, Start::Standstill);
    let duration = root.number("duration_s", &DURATION, "length of the experiment");
    let rate = root.number_or("sample_rate_hz", &SAMPLE_RATE, base.sample_rate_hz);
    let record_from = root.number_or("record_from_s", &TIME, 0.0);
    let interval = root.number_or("data_interval_s", &INTERVAL, base.data_interval_s);
    let seed = root.integer_or("seed", &SEED, 0);
    let supply = supply::read(root, &base.motor.nameplate);
    let load = load::read(root, &base.motor.nameplate);
    let sensors = sensors::read(root, &base.motor, duration);
    let faults = faults::read(root, plant.unwrap_or(base.plant));
    let effects = read_effects(root);
    check_effects(
        document,
        &base.motor,
        effects.as_deref().unwrap_or_default(),
    );
    Some(Scenario {
        name: name?.unwrap_or(base.name),
        plant: plant?,
        start: start?,
        duration_s: duration?,
        sample_rate_hz: rate?,
        record_from_s: record_from?,
        data_interval_s: interval?,
        seed: u64::from(seed?),
        supply: supply?,
        load: load?,
        faults: faults?,
        sensors: sensors?,
        effects: effects?,
        motor_path: None,
        motor: base.motor,
    })
}

fn check_effects(document: &Document, motor: &MotorFile, effects: &[EffectEntry]) {
    for entry in effects {
        if let Err((key, message)) = check_entry(motor, entry) {
            document.report(entry.line_of(&key), &entry.path_of(&key), message);
        }
    }
}

fn check_times(root: &Section<'_>, scenario: &Scenario) {
    if scenario.duration_s * scenario.sample_rate_hz > MOST_SAMPLES {
        root.report(
            "duration_s",
            format!("{} s at {} Hz is more than {MOST_SAMPLES:e} samples: shorten it or lower sample_rate_hz",
                scenario.duration_s, scenario.sample_rate_hz),
        );
    }
    if scenario.record_from_s >= scenario.duration_s {
        root.report(
            "record_from_s",
            format!(
                "{} s is not before the end at duration_s = {}: nothing would be recorded",
                scenario.record_from_s, scenario.duration_s
            ),
        );
    }
    let fastest = scenario.supply.highest_frequency_hz();
    if scenario.sample_rate_hz < SAMPLES_PER_PERIOD * fastest {
        root.report(
            "sample_rate_hz",
            format!(
                "{} Hz is too slow for a supply of {fastest} Hz: write at least {}",
                scenario.sample_rate_hz,
                SAMPLES_PER_PERIOD * fastest
            ),
        );
    }
}

/// What the linear model cannot express.
fn check_plant(root: &Section<'_>, scenario: &Scenario) {
    if scenario.plant == PlantKind::Full {
        return;
    }
    let full_only = [
        (
            "supply",
            !scenario.supply.is_clean(),
            "unbalance and harmonics have",
        ),
        (
            "supply",
            scenario.supply.switch_off_s.is_some(),
            "switch_off_s has",
        ),
        ("effects", !scenario.effects.is_empty(), "effects have"),
        (
            "load",
            !scenario.load.is_linear(),
            "a load other than friction has",
        ),
    ];
    for (key, present, what) in full_only {
        if present {
            root.report(
                key,
                format!("{what} no place in the linear model: write plant = \"full\" or remove it"),
            );
        }
    }
}
