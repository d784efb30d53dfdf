//! Recordings of every format: what is read can be audited, replayed and written.

use std::path::PathBuf;
use std::sync::OnceLock;

use audit::{Expectation, audit};
use formats::{read_any, read_stream};
use monitor::Monitor;
use recording::{Error, LoadTable, Mapping, Recording, Source};
use replay::{Samples, replay, stand_in_config};

/// Samples that are replayed; more only take longer.
const REPLAYED: usize = 4_000;

/// A folder of this process, in memory where the system has one.
fn folder() -> &'static PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let shared = PathBuf::from("/dev/shm");
        let base = if shared.is_dir() {
            shared
        } else {
            std::env::temp_dir()
        };
        let folder = base.join(format!("drive-monitor-fuzz-{}", std::process::id()));
        // A folder that cannot be made shows in the first file that cannot be written.
        let _ = std::fs::create_dir_all(&folder);
        folder
    })
}

/// Names of other channels than ours, as instruments give them.
fn mapping() -> Mapping {
    let mut mapping = Mapping {
        skip_missing: Some(true),
        ..Mapping::default()
    };
    mapping.sample_rate_hz = None;
    mapping
}

fn read(name: &str, bytes: &[u8], mapping: &Mapping) {
    let thread = format!("{:?}", std::thread::current().id());
    let number: String = thread.chars().filter(char::is_ascii_digit).collect();
    let path = folder().join(format!("{number}-{name}"));
    std::fs::write(&path, bytes).expect("a file in the temporary folder");
    judge(read_any(&path, mapping, &mut |_| {}));
}

fn judge(read: Result<Source, Error>) {
    match read {
        Ok(Source::Recording(recording)) => use_recording(&recording),
        Ok(Source::LoadTable(table)) => use_table(&table),
        Err(error) => {
            assert!(matches!(error.exit_code(), 2 | 3), "{error}");
            let line = error.problems().first().expect("a problem");
            assert!(
                !line.message.is_empty() && !line.remedy.is_empty(),
                "{error}"
            );
        }
    }
}

fn use_table(table: &LoadTable) {
    assert_eq!(table.points().len(), table.len());
}

fn use_recording(recording: &Recording) {
    let audit = audit(recording, &Expectation::default());
    let finite = |finding: &audit::Finding| finding.value.is_finite();
    assert!(audit.findings.iter().all(finite), "{:?}", audit.findings);
    if recording.len() > REPLAYED {
        return;
    }
    if let Ok(monitor) = Monitor::new(stand_in_config(recording)) {
        let timeline = replay(&monitor, &Samples::new(recording, &audit), &mut |_| {});
        drop(timeline);
    }
}

pub(crate) fn csv(bytes: &[u8]) {
    read("x.csv", bytes, &Mapping::default());
    read("x.csv", bytes, &mapping());
}

pub(crate) fn csv_gz(bytes: &[u8]) {
    read("x.csv.gz", bytes, &Mapping::default());
}

/// Standard input, whose content alone tells what it is.
pub(crate) fn stream(bytes: &[u8]) {
    let stream = std::io::Cursor::new(bytes.to_vec());
    judge(read_stream(
        "standard input",
        stream,
        &mapping(),
        &mut |_| {},
    ));
}

pub(crate) fn parquet(bytes: &[u8]) {
    read("x.parquet", bytes, &mapping());
}

pub(crate) fn mat(bytes: &[u8]) {
    read("x.mat", bytes, &mapping());
}

pub(crate) fn workbook(bytes: &[u8]) {
    read("x.xlsx", bytes, &mapping());
}

pub(crate) fn wav(bytes: &[u8]) {
    let mut columns = mapping();
    columns.set_columns("ia,ib,ic").expect("known channels");
    read("x.wav", bytes, &columns);
}

/// The recorder's names are mapped where they are those of the seeds.
pub(crate) fn comtrade(bytes: &[u8]) {
    let mut names = mapping();
    for flag in ["va=VA", "vb=VB", "vc=VC", "ia=IA", "ib=IB", "ic=IC"] {
        names.set_column(flag).expect("known channels");
    }
    read("x.cff", bytes, &names);
}
