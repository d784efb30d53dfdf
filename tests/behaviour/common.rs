//! What the cross-crate tests share.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

use audit::{Audit, Expectation, audit};
use formats::read_recording;
use monitor::Monitor;
use motor::MotorFile;
use recording::{Mapping, Recording};
use replay::{self, Samples, Timeline};

pub use behaviour::in_project;

/// A file of the shared data that may not be copied into the project; `None`, with a message, where it is absent.
pub fn in_shared_data(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("DRIVE_MONITOR_SHARED_DATA")
        .map_or_else(|| in_project("../shared/data"), PathBuf::from);
    let file = folder.join(path);
    if !file.exists() {
        println!(
            "skipped: {path} is not here (set DRIVE_MONITOR_SHARED_DATA to the folder that holds it)"
        );
        return None;
    }
    Some(file)
}

/// A motor file of the project.
pub fn motor(path: &str) -> MotorFile {
    MotorFile::read(in_project(path)).expect("a shipped motor file is valid")
}

/// Reads a recording.
pub fn read(path: &Path, mapping: &Mapping) -> Recording {
    read_recording(path, mapping, &mut |_| {}).expect("the recording is readable")
}

/// Audits a recording and replays it through the core, as `drivemon monitor` does.
pub fn monitored(recording: &Recording, motor: &MotorFile) -> (Audit, Timeline) {
    let audit = audit(recording, &Expectation::from(motor));
    let config = replay::config_for(motor, recording).expect("effects of the library");
    let monitor = Monitor::new(config).expect("a valid motor file");
    let timeline = replay::replay(&monitor, &Samples::new(recording, &audit), &mut |_| {});
    (audit, timeline)
}
