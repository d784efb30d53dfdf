//! `drivemon batch`: a folder of recordings, one row each.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use campaign::slurm::{Array, in_shell};
use clap::Args;
use recording::{Flags, quoted};
use report::study::batch::{self as rows_of, Row, Store, StoreError, read_table};

use crate::cli::arguments::files::Files;
use crate::cli::arguments::input::InputArgs;
use crate::cli::commands::engine::{Engine, EngineArgs, absolute, program};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::{complain, say};
use crate::cli::printing::{paint, progress};

/// Judge a folder of recordings on all cores: one row each in a Parquet file.
///
/// Every recording that the map names is replayed through the board's core, as `drivemon monitor` does it. A recording that
/// cannot be read gets a row that says why. A run that was killed goes on where it was, and a table that is there already keeps
/// its rows: only recordings that are new or have changed, themselves or their motor file, are judged. The same recordings,
/// motor files and flags give the same bytes, on one machine or on many.
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
    /// Judge a part: first recording of the list, which is sorted by name and begins at 0. The part is written into the folder
    /// OUT.parquet.parts; the command without --from and --to makes the table of all parts
    #[arg(long, value_name = "INDEX")]
    from: Option<usize>,
    /// Judge a part: recording after the last
    #[arg(long, value_name = "INDEX")]
    to: Option<usize>,
    #[command(flatten)]
    engine: EngineArgs,
    #[command(flatten)]
    input: InputArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon batch recordings --motor-map motors.toml -o judged.parquet
  drivemon batch recordings --motor-map motors.toml -o judged.parquet --from 0 --to 5000     one machine's part
  drivemon batch recordings --motor-map motors.toml -o judged.parquet --engine ray           on all machines of a Ray cluster
  drivemon batch recordings --motor-map motors.toml -o judged.parquet --engine slurm | bash  as an array job of Slurm
The map; the first entry that fits a recording counts, what fits none is left out. Paths of recordings are seen from DIR, those of
motor files from the map; `*` is any part of a name, `**` any folders:
  [[motors]]
  recordings = \"pump-3/*.parquet\"
  motor = \"pump-3.toml\"
Exit codes: 0 nothing found, 1 FAULT in a recording, 2 bad input, or a recording that could not be read, 3 a recording was not judged.
With --from or --to: 0 once the part is written, whatever was found; the table tells it.";

impl Batch {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        let flags = self.input.unwritten()?;
        let batch = rows_of::Batch::read(&self.folder, &self.motor_map, &self.out, &flags)?;
        self.files(&batch).check()?;
        let range = self.range(batch.jobs.len())?;
        match (self.engine.engine, range) {
            (Engine::Here, None) => self.here(&batch),
            (Engine::Here, Some(range)) => self.part(&batch, range),
            (Engine::Ray, None) => self.ray(&batch, &flags),
            (Engine::Slurm, None) => self.slurm(&batch, &flags),
            (_, Some(_)) => Err(Failure::Usage(
                "--from, --to: an engine hands out all recordings; leave them out, or --engine"
                    .to_owned(),
            )),
        }
    }

    /// The part that is asked for.
    fn range(&self, recordings: usize) -> Result<Option<Range<usize>>, Failure> {
        if self.from.is_none() && self.to.is_none() {
            return Ok(None);
        }
        let (from, to) = (self.from.unwrap_or(0), self.to.unwrap_or(recordings));
        if from < to && to <= recordings {
            return Ok(Some(from..to));
        }
        Err(Failure::Usage(format!(
            "--from {from} --to {to}: the list has recordings 0..{recordings}, none of them in this range; \
             give 0 <= from < to <= {recordings}"
        )))
    }

    fn here(&self, batch: &rows_of::Batch) -> Result<Finding, Failure> {
        let store = batch.store()?.with_parts()?;
        let rows = judging(batch.jobs.len(), |done| batch.finish(&store, done))?;
        Ok(self.tell(&rows))
    }

    fn part(&self, batch: &rows_of::Batch, range: Range<usize>) -> Result<Finding, Failure> {
        let rows = judging(range.len(), |done| batch.finish_part(range.clone(), done))?;
        print(&rows);
        say!(
            "Recordings {}..{} of {}; the same command without --from and --to writes {}.",
            range.start,
            range.end,
            batch.jobs.len(),
            quoted(&self.out.display().to_string())
        );
        Ok(Finding::Nothing)
    }

    fn ray(&self, batch: &rows_of::Batch, flags: &Flags) -> Result<Finding, Failure> {
        // What stands in the way is refused before another program starts.
        drop::<Store>(batch.store()?);
        let mut words = self.words()?;
        words.extend(["--reading".to_owned(), reading(flags)]);
        self.engine.ray("drivemon.batch", &words)?;
        Ok(self.tell(&read_table(&self.out)?))
    }

    /// The script runs where it was asked for: paths stay as they were given, and rows and errors with them.
    fn slurm(&self, batch: &rows_of::Batch, flags: &Flags) -> Result<Finding, Failure> {
        drop::<Store>(batch.store()?);
        let words = self.words()?.into_iter().chain(flags.words());
        let words: Vec<String> = words.map(in_shell).collect();
        let here = in_shell(absolute(Path::new("."))?);
        let command = format!("cd {here} && {} batch {}", program()?, words.join(" "));
        let range = 0..batch.jobs.len() as u64;
        let title = format!("{} recordings of a batch", range.end);
        let array = Array {
            title,
            items: self
                .engine
                .items_a_task(&range, |k| batch.try_one(k as usize)),
            range,
            folder: format!("{}.logs", in_shell(absolute(&self.out)?)),
            task: format!("{command} --from $from --to $to"),
            merge: format!(
                "# 1 and 3 say what was found: no failure.\n{command}\ncase $? in 0|1|3) ;; *) exit 2 ;; esac"
            ),
        };
        say!("{}", array.script());
        Ok(Finding::Nothing)
    }

    /// The command line of this batch, without its engine and how recordings are read.
    fn words(&self) -> Result<Vec<String>, Failure> {
        let paths = [&self.folder, &self.motor_map, &self.out].map(|path| {
            path.to_str().map(str::to_owned).ok_or_else(|| {
                Failure::Usage(format!(
                    "{}: the name cannot be handed to another program; rename it in UTF-8",
                    path.display()
                ))
            })
        });
        let [folder, map, out] = paths;
        let [map_flag, out_flag] = ["--motor-map", "-o"].map(str::to_owned);
        Ok(vec![folder?, map_flag, map?, out_flag, out?])
    }

    fn tell(&self, rows: &[Row]) -> Finding {
        print(rows);
        say!("{} is written.", quoted(&self.out.display().to_string()));
        finding(rows)
    }

    fn files(&self, batch: &rows_of::Batch) -> Files {
        let mut files = Files::default().reads("the motor map", &self.motor_map);
        for motor in &batch.map.motors {
            files = files.reads("the motor file", &motor.path);
        }
        files
            .reads_recordings(batch.jobs.iter().map(|job| &job.path), &self.input)
            .writes("-o", &self.out)
    }
}

/// How recordings are read, as the Python package takes it.
fn reading(flags: &Flags) -> String {
    serde_json::json!({
        "column": flags.column,
        "columns": flags.columns,
        "sensor": flags.sensor,
        "unit": flags.unit,
        "scale": flags.scale,
        "offset": flags.offset,
        "delay": flags.delay,
        "sample_rate": flags.sample_rate,
        "line_voltages": flags.line_voltages,
        "skip_missing": flags.skip_missing,
        "delimiter": flags.delimiter,
        "decimal_comma": flags.decimal_comma,
        "thousands": flags.thousands,
        "date_order": flags.date_order,
        "pulses_per_revolution": flags.pulses_per_revolution,
        "sidecar": flags.sidecar,
    })
    .to_string()
}

/// Rows, with a bar of how many of `count` are done; how many were there already is told.
fn judging(
    count: usize,
    work: impl FnOnce(&(dyn Fn(bool) + Sync)) -> Result<Vec<Row>, StoreError>,
) -> Result<Vec<Row>, Failure> {
    let bar = progress::bar("judging", count as u64);
    let kept = AtomicUsize::new(0);
    let rows = work(&|was_there| {
        kept.fetch_add(usize::from(was_there), Ordering::Relaxed);
        bar.inc(1);
    });
    bar.finish_and_clear();
    let (rows, kept) = (rows?, kept.into_inner());
    if kept > 0 {
        complain(format_args!(
            "{kept} of {} rows were there already",
            rows.len()
        ));
    }
    Ok(rows)
}

/// The worst of all rows, as of several recordings of `drivemon monitor`.
fn finding(rows: &[Row]) -> Finding {
    let any = |state: &str| rows.iter().any(|row| row.state == state);
    match () {
        () if any(rows_of::NOT_READ) => Finding::NotRead,
        () if any(rows_of::FAULT) => Finding::Something,
        () if any(rows_of::NOT_JUDGED) => Finding::Unsupported,
        () => Finding::Nothing,
    }
}

/// How many of each kind, by motor.
fn print(rows: &[Row]) {
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
        let faults = format!("{:>6}", count(rows_of::FAULT));
        say!(
            "{motor:<widest$} {:>10} {:>8} {} {:>11} {:>9}",
            count(""),
            count(rows_of::HEALTHY),
            if count(rows_of::FAULT) > 0 {
                paint::error(faults).to_string()
            } else {
                faults
            },
            count(rows_of::NOT_JUDGED),
            count(rows_of::NOT_READ)
        );
    }
    for row in rows.iter().filter(|row| row.state == rows_of::NOT_READ) {
        complain(format_args!("{}", row.error));
    }
}
