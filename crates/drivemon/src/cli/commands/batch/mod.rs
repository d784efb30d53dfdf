//! `drivemon batch`: a folder of recordings, one row each.

mod store;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::Args;
use rayon::prelude::*;
use recording::{Mapping, companions, quoted};
use report::study::batch::{self, Row};
use report::study::{Job, MappedMotor, MotorMap};

use crate::cli::arguments::files::Files;
use crate::cli::arguments::input::InputArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::{complain, say};
use crate::cli::printing::{paint, progress};
use store::Store;

/// Judge a folder of recordings on all cores: one row each in a Parquet file.
///
/// Every recording that the map names is replayed through the board's core, as `drivemon monitor` does it. A recording that
/// cannot be read gets a row that says why. A run that was killed goes on where it was, and a table that is there already keeps
/// its rows: only recordings that are new or have changed, themselves or their motor file, are judged. The same recordings,
/// motor files and flags give the same bytes.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Batch {
    /// Folder with recordings, in folders of any depth
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Which motor file belongs to which recordings (TOML)
    #[arg(long, value_name = "MAP.toml")]
    motor_map: PathBuf,
    /// Table to write (.parquet); rows that are finished stand in a folder beside it until all are
    #[arg(short, long = "out", value_name = "OUT.parquet")]
    out: PathBuf,
    #[command(flatten)]
    input: InputArgs,
}

const EXAMPLES: &str = "\
Example:
  drivemon batch recordings --motor-map motors.toml -o judged.parquet
The map; the first entry that fits a recording counts, what fits none is left out. Paths of recordings are seen from DIR, those of
motor files from the map; `*` is any part of a name, `**` any folders:
  [[motors]]
  recordings = \"pump-3/*.parquet\"
  motor = \"pump-3.toml\"
Exit codes: 0 nothing found, 1 FAULT in a recording, 2 bad input, or a recording that could not be read, 3 a recording was not judged.";

impl Batch {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let mapping = self.input.unwritten_mapping()?;
        let map = MotorMap::read(&self.motor_map)?;
        let jobs = map.jobs(&self.folder, &self.out)?;
        self.files(&map, &jobs).check()?;
        let store = Store::new(&self.out, &self.input.typed())?;
        let bar = progress::bar("judging", jobs.len() as u64);
        let kept = AtomicUsize::new(0);
        let rows = jobs.par_iter().map(|job| {
            let motor = &map.motors[job.motor];
            let row = one(&store, job, motor, &mapping, &kept);
            bar.inc(1);
            row
        });
        let rows = rows.collect::<Result<Vec<Row>, Failure>>();
        bar.finish_and_clear();
        let rows = rows?;
        store.finish(&rows)?;
        let kept = kept.into_inner();
        if kept > 0 {
            complain(format_args!(
                "{kept} of {} rows were there already",
                rows.len()
            ));
        }
        print(&rows, &self.out);
        Ok(finding(&rows))
    }

    fn files(&self, map: &MotorMap, jobs: &[Job]) -> Files {
        let mut files = Files::default().reads("the motor map", &self.motor_map);
        for motor in &map.motors {
            files = files.reads("the motor file", &motor.path);
        }
        files
            .reads_recordings(jobs.iter().map(|job| &job.path), &self.input)
            .writes("-o", &self.out)
    }
}

/// One row: from an earlier run, or judged now and kept.
fn one(
    store: &Store,
    job: &Job,
    motor: &MappedMotor,
    mapping: &Mapping,
    kept: &AtomicUsize,
) -> Result<Row, Failure> {
    let beside = companions(&job.path);
    let read = std::iter::once(&job.path)
        .chain(&beside)
        .chain(&mapping.sidecar);
    let said = [&job.name, &motor.name, &motor.text];
    let fingerprint = store.fingerprint(said, read.map(PathBuf::as_path));
    if let Some(row) = store.kept(&fingerprint)? {
        kept.fetch_add(1, Ordering::Relaxed);
        return Ok(row);
    }
    let row = Row::judged(job, motor, mapping, &fingerprint);
    store.keep(&row)?;
    Ok(row)
}

/// The worst of all rows, as of several recordings of `drivemon monitor`.
fn finding(rows: &[Row]) -> Finding {
    let any = |state: &str| rows.iter().any(|row| row.state == state);
    match () {
        () if any(batch::NOT_READ) => Finding::NotRead,
        () if any(batch::FAULT) => Finding::Something,
        () if any(batch::NOT_JUDGED) => Finding::Unsupported,
        () => Finding::Nothing,
    }
}

/// How many of each kind, by motor.
fn print(rows: &[Row], out: &Path) {
    let mut motors: Vec<&str> = rows.iter().map(|row| row.motor.as_str()).collect();
    motors.sort_unstable();
    motors.dedup();
    let lengths = motors.iter().map(|motor| motor.chars().count());
    let widest = lengths.fold("motor".len(), usize::max);
    say!(
        "{:<widest$} {:>10} {:>8} {:>6} {:>11} {:>9}",
        "motor",
        "recordings",
        "healthy",
        "FAULT",
        "not judged",
        "not read"
    );
    for motor in motors {
        let count = |state: &str| {
            let of = rows.iter().filter(|row| row.motor == motor);
            of.filter(|row| state.is_empty() || row.state == state)
                .count()
        };
        let faults = format!("{:>6}", count(batch::FAULT));
        say!(
            "{motor:<widest$} {:>10} {:>8} {} {:>11} {:>9}",
            count(""),
            count(batch::HEALTHY),
            if count(batch::FAULT) > 0 {
                paint::error(faults).to_string()
            } else {
                faults
            },
            count(batch::NOT_JUDGED),
            count(batch::NOT_READ)
        );
    }
    for row in rows.iter().filter(|row| row.state == batch::NOT_READ) {
        complain(format_args!("{}", row.error));
    }
    say!("{} is written.", quoted(&out.display().to_string()));
}
