//! `drivemon campaign`: what the lamps can be trusted with.

use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use report::json::Answer;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::arguments::files::{Files, spare_what_is_no_sidecar};
use crate::cli::commands::engine::{Engine, EngineArgs, absolute, program};
use crate::cli::commands::monitor;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{OutputArgs, write_text};
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};
use campaign::slurm::{Array, in_shell};
use campaign::{self, Plan, Results, Row, Run, Table};
use recording::{Channel, Recording};
use replay::Timeline;
use report::Subject;
use scenario::simulate;

/// Measure what the lamps can be trusted with: faults, sizes and conditions, thousands of runs on all cores.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Campaign {
    #[command(subcommand)]
    action: Action,
}

const EXAMPLES: &str = "\
Examples:
  drivemon campaign run campaigns/smoke.toml -o smoke.parquet       killed? The same command goes on
  drivemon campaign run PLAN.toml --from 0 --to 5000 -o a.parquet   one machine's share
  drivemon campaign run PLAN.toml -o all.parquet --engine ray       on all machines of a Ray cluster (--address auto)
  drivemon campaign run PLAN.toml -o all.parquet --engine slurm | bash      as an array job of Slurm
  drivemon campaign merge a.parquet b.parquet -o all.parquet
  drivemon campaign table all.parquet --report table.html           what is detected, how small, how fast, how often wrongly
  drivemon campaign replay PLAN.toml --index 17 -o run17.csv.gz     that very run as a recording, with its lamps
Exit codes: 0 fine, 1 FAULT was lit on a healthy motor, 2 bad input or usage.";

#[derive(Debug, Subcommand)]
enum Action {
    Run(RunArgs),
    Merge(Merge),
    Table(TableArgs),
    Replay(Replay),
}

/// Make the runs of a plan, or a share of them.
///
/// A run follows from its index alone: the same range gives the same rows wherever it is made. Finished runs survive
/// a crash; the same command goes on where it was.
#[derive(Debug, Args)]
struct RunArgs {
    /// Plan file
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// Results to write (.parquet)
    #[arg(short, long, value_name = "RESULT")]
    output: PathBuf,
    /// First run
    #[arg(long, value_name = "INDEX", default_value_t = 0)]
    from: u64,
    /// Run after the last; all that are left when it is not given
    #[arg(long, value_name = "INDEX")]
    to: Option<u64>,
    #[command(flatten)]
    engine: EngineArgs,
}

/// Put shares of one campaign together.
#[derive(Debug, Args)]
struct Merge {
    /// Results of shares
    #[arg(value_name = "RESULT", required = true)]
    results: Vec<PathBuf>,
    /// Results to write (.parquet)
    #[arg(short, long, value_name = "RESULT")]
    output: PathBuf,
}

/// Count results: healthy windows with FAULT, smallest detected sizes, delays, confusion.
#[derive(Debug, Args)]
struct TableArgs {
    /// Results of one or more campaigns
    #[arg(value_name = "RESULT", required = true)]
    results: Vec<PathBuf>,
    /// Write the table as a page of the book
    #[arg(long, value_name = "FILE.md")]
    markdown: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

/// Make one run of a plan again: its conditions and lamps, and with -o its recording.
#[derive(Debug, Args)]
struct Replay {
    /// Plan file
    #[arg(value_name = "PLAN")]
    plan: PathBuf,
    /// The run
    #[arg(long, value_name = "INDEX")]
    index: u64,
    /// Recording to write (.csv, .csv.gz or .parquet); the motor file that the monitor was told goes beside it, .motor.toml
    #[arg(short, long, value_name = "REC")]
    output: Option<PathBuf>,
}

/// What campaigns found.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TableJson {
    /// One table each.
    campaigns: Vec<Table>,
}

impl Answer for TableJson {
    const FORMAT: &'static str = "campaign/1";
}

impl Campaign {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        match &self.action {
            Action::Run(run) => run.run(),
            Action::Merge(merge) => merge.run(),
            Action::Table(table) => table.run(),
            Action::Replay(replay) => replay.run(),
        }
    }
}

impl RunArgs {
    fn run(&self) -> Result<Finding, Failure> {
        let plan = Plan::read(&self.plan)?;
        read(&self.plan, &plan).writes("-o", &self.output).check()?;
        let range = self.range(plan.runs())?;
        match self.engine.engine {
            Engine::Here => {}
            Engine::Ray => return self.ray(&range),
            Engine::Slurm => return self.slurm(&plan, &range),
        }
        let bar = progress::bar("campaign", range.end - range.start);
        let done = campaign::run_range(&plan, range, &self.output, &|runs| bar.inc(runs))?;
        bar.finish_and_clear();
        if done.there_already > 0 {
            say!("{} runs were there already", done.there_already);
        }
        Ok(tell(&done.results, &self.output))
    }

    fn ray(&self, range: &Range<u64>) -> Result<Finding, Failure> {
        let bounds = [range.start, range.end].map(|index| index.to_string());
        let [plan, output] = [&self.plan, &self.output].map(|path| path.as_os_str());
        let [o, from, to] = ["-o", "--from", "--to"].map(OsStr::new);
        let [start, end] = bounds.each_ref().map(OsStr::new);
        let words = [plan, o, output, from, start, to, end];
        match self.engine.ray("drivemon.campaign", &words)? {
            0 => Ok(Finding::Nothing),
            _ => Ok(Finding::Something),
        }
    }

    fn slurm(&self, plan: &Plan, range: &Range<u64>) -> Result<Finding, Failure> {
        let trial = |index| drop(campaign::share(plan, index..index + 1, &mut || ()));
        let program = program()?;
        let path = in_shell(absolute(&self.plan)?);
        let output = in_shell(absolute(&self.output)?);
        let array = Array {
            title: format!("Runs {}..{} of a campaign", range.start, range.end),
            range: range.clone(),
            items: self.engine.items_a_task(range, trial),
            folder: format!("{output}.shares"),
            task: format!(
                "share=$(printf '%09d.parquet' $from)\n\
                 # 1 says that FAULT was lit on a healthy motor: a finding, no failure.\n\
                 {program} campaign run {path} --from $from --to $to -o {output}.shares/$share || [ $? -eq 1 ]"
            ),
            merge: format!(
                "{program} campaign merge {output}.shares/*.parquet -o {output} || [ $? -eq 1 ]"
            ),
        };
        say!("{}", array.script());
        Ok(Finding::Nothing)
    }

    fn range(&self, runs: u64) -> Result<Range<u64>, Failure> {
        let to = self.to.unwrap_or(runs);
        if self.from < to && to <= runs {
            return Ok(self.from..to);
        }
        Err(Failure::Usage(format!(
            "--from {} --to {to}: the plan has runs 0..{runs}, none of them in this range; give 0 <= from < to <= {runs}",
            self.from
        )))
    }
}

impl Merge {
    fn run(&self) -> Result<Finding, Failure> {
        let files = Files::default().writes("-o", &self.output);
        results_of(files, &self.results).check()?;
        let read = |path: &PathBuf| Ok((path.clone(), Results::read(path)?));
        let parts = self
            .results
            .iter()
            .map(read)
            .collect::<Result<_, Failure>>()?;
        let results = Results::merge(parts)?;
        results.write(&self.output)?;
        Ok(tell(&results, &self.output))
    }
}

impl TableArgs {
    fn run(&self) -> Result<Finding, Failure> {
        let files = Files::default()
            .may_write("--markdown", self.markdown.as_ref())
            .writes_results(&self.output);
        results_of(files, &self.results).check()?;
        let read = |path: &PathBuf| Ok(Table::of(&Results::read(path)?));
        let tables = self
            .results
            .iter()
            .map(read)
            .collect::<Result<_, Failure>>()?;
        let result = TableJson { campaigns: tables };
        let markdown = self.write_markdown(&result.campaigns);
        let tables = result.campaigns.iter();
        let show = || tables.for_each(|table| say!("{table}"));
        self.output.give(Subject::Campaign, &result, show)?;
        markdown?;
        let windows: u64 = result
            .campaigns
            .iter()
            .map(|table| table.fault_windows)
            .sum();
        Ok(if windows == 0 {
            Finding::Nothing
        } else {
            Finding::Something
        })
    }
}

impl TableArgs {
    fn write_markdown(&self, tables: &[Table]) -> Result<(), Failure> {
        match &self.markdown {
            Some(path) => write_text(path, &campaign::markdown(tables)),
            None => Ok(()),
        }
    }
}

impl Replay {
    fn run(&self) -> Result<Finding, Failure> {
        let plan = Plan::read(&self.plan)?;
        let runs = plan.runs();
        let run = Run::new(&plan, self.index).ok_or_else(|| {
            Failure::Usage(format!(
                "--index {}: the plan has runs 0..{runs}; give one of them",
                self.index
            ))
        })?;
        self.check(&plan)?;
        self.show(&run)?;
        match &self.output {
            Some(path) => record(&run, path),
            None => Ok(Finding::Nothing),
        }
    }

    fn check(&self, plan: &Plan) -> Result<(), Failure> {
        let Some(path) = &self.output else {
            return Ok(());
        };
        read(&self.plan, plan)
            .writes_recording("-o", path)
            .writes("the motor file of the run", &motor_of(path))
            .check()?;
        spare_what_is_no_sidecar(path)
    }

    fn show(&self, run: &Run<'_>) -> Result<(), Failure> {
        let mut timeline = Timeline::default();
        let motion = run
            .replay(|t, report, _| timeline.add(t, report))
            .map_err(Failure::Usage)?;
        timeline.finish();
        timeline.motion = motion;
        print_run(run);
        monitor::print_lamps(&timeline);
        monitor::print_windows(&timeline);
        monitor::print_sequence(&timeline.sequence());
        monitor::print_verdict(&timeline, &timeline.verdict(&[]));
        Ok(())
    }
}

fn print_run(run: &Run<'_>) {
    let (motor, block) = (&run.place.motor.name, &run.place.block.name);
    let row = Row::of(run);
    say!("run {} of {motor}, {block}", paint::strong(run.index));
    say!("  {}", campaign::conditions(&row));
    if let Some(case) = run.place.case {
        let phase = if row.phase.is_empty() {
            String::new()
        } else {
            format!(", phase {}", row.phase)
        };
        say!(
            "  {} {:+} %{phase}, from {:.4} s on",
            case.kind.words,
            case.percent,
            run.fault_from_s
        );
    }
}

/// The same motor running backwards: phases b and c exchanged, speed and torque with the other sign.
fn mirrored(recording: &Recording) -> Result<Recording, recording::Error> {
    let t = recording.t().to_vec();
    let mut mirror = Recording::new(recording.name(), t, recording.metadata.clone())?;
    let [[va, vb, vc], [ia, ib, ic]] = [Channel::VOLTAGES, Channel::CURRENTS];
    let exchanged = [(va, va), (vb, vc), (vc, vb), (ia, ia), (ib, ic), (ic, ib)];
    let turned = [Channel::SPEED, Channel::TORQUE];
    for (channel, from) in exchanged {
        if let Some(values) = recording.channel(from) {
            mirror = mirror.with_channel(channel, values.to_vec())?;
        }
    }
    for channel in turned {
        if let Some(values) = recording.channel(channel) {
            mirror = mirror.with_channel(channel, values.iter().map(|x| -x).collect())?;
        }
    }
    Ok(mirror)
}

fn record(run: &Run<'_>, path: &Path) -> Result<Finding, Failure> {
    let refused = |error| Failure::Usage(format!("run {}: {error}", run.index));
    let mut recording = simulate::record(&run.scenario(), |_| {}).map_err(refused)?;
    if run.is_backwards() {
        recording = mirrored(&recording)?;
    }
    formats::write_recording(path, &recording)?;
    let motor = motor_of(path);
    write_text(&motor, &run.monitor_file().to_toml())?;
    let (path, motor) = (path.display(), motor.display());
    say!("{path}, {motor}: drivemon monitor {path} --motor {motor}");
    Ok(Finding::Nothing)
}

/// The motor file beside a run's recording.
fn motor_of(recording: &Path) -> PathBuf {
    recording::sidecar_path(recording).with_extension("motor.toml")
}

/// The files behind a plan.
fn read(path: &Path, plan: &Plan) -> Files {
    let motors = plan.motors.iter().flat_map(|pair| &pair.files);
    motors.fold(Files::default().reads("the plan", path), |files, motor| {
        files.reads("the motor file", motor)
    })
}

fn results_of(files: Files, results: &[PathBuf]) -> Files {
    let add = |files: Files, path: &PathBuf| files.reads("the results", path);
    results.iter().fold(files, add)
}

fn tell(results: &Results, output: &Path) -> Finding {
    let rows = &results.rows;
    let windows: u64 = rows
        .iter()
        .map(|row| u64::from(row.healthy_judged_windows))
        .sum();
    let alarms = rows
        .iter()
        .filter(|row| row.healthy_fault_windows > 0)
        .count();
    say!(
        "{}: {} of {} runs of \"{}\"; {windows} healthy windows judged, FAULT among them in {alarms} runs",
        output.display(),
        rows.len(),
        results.about.runs,
        results.about.plan
    );
    if alarms == 0 {
        Finding::Nothing
    } else {
        Finding::Something
    }
}
