//! `drivemon monitor`: a recording through the board's core.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use monitor::Report;
use motor::MotorFile;
use recording::{LoadTable, Recording, Source};

use crate::cli::arguments::files::Files;
use crate::cli::arguments::input::{InputArgs, read_motor};
use crate::cli::commands::live::LiveArgs;
use crate::cli::printing::answers::{self, Answers};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::lamp_symbol::symbol;
use crate::cli::printing::motion::print_motion;
use crate::cli::printing::output::OutputArgs;
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;
use replay::operating_points::OperatingPoints;
use replay::words;
use replay::{SequenceSummary, Timeline, Verdict, VerdictState};
use report::Subject;
use report::study::{MonitorError, Monitored, Monitoring, WindowTrace};

/// Replay a recording through the very core that the board runs: lamps, verdict, probabilities.
///
/// Missing channels are no error in the file: without voltages or speed the motor is "not judged" (exit code 3), and the
/// sequence components of the currents are still reported. A load-test table is printed as its operating points.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct MonitorArgs {
    /// Recordings or load-test tables, each judged by itself (.csv, .csv.gz, .parquet, .mat, .cfg, .cff)
    #[arg(value_name = "REC", required_unless_present_any = ["serial", "probe"])]
    recordings: Vec<PathBuf>,
    /// Motor file; without it only audit and sequence components are reported
    #[arg(long, value_name = "M")]
    motor: Option<PathBuf>,
    /// Write every window as a row of a Parquet file: time, lamp, r1 to r4, operating point, unbalance; however long REC is
    #[arg(long, value_name = "FILE.parquet", conflicts_with_all = ["serial", "probe"])]
    trace: Option<PathBuf>,
    #[command(flatten)]
    live: LiveArgs,
    #[command(flatten)]
    input: InputArgs,
    #[command(flatten)]
    output: OutputArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon monitor rec.csv.gz --motor motors/peer-2k2.toml
  drivemon monitor lab.csv --motor m.toml --column ic=ic2 --column speed=speed_raw --unit speed=rpm --offset speed=-2.11 --scale speed=9.687
  drivemon monitor currents.csv                                  three currents only: negative sequence and its angle
  drivemon monitor --serial /dev/ttyACM0                         the lamps of a running board, until Ctrl-C
  drivemon monitor --serial /dev/ttyACM0 --motor m.toml --capture alarm.csv     wait for an alarm and keep the samples around it
Lamps:  ● on   ◐ blinking: waiting or not judged   ○ off";

impl MonitorArgs {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        if self.recordings.is_empty() {
            return self.watch();
        }
        self.files().check()?;
        if self.trace.is_some() && self.recordings.len() > 1 {
            return Err(Failure::Usage(ONE_TRACE.to_owned()));
        }
        let motor = self.motor.as_deref().map(read_motor).transpose()?;
        let motor = motor.as_ref();
        answers::each(&self.recordings, &self.output, |path, answers| {
            let mut monitoring = Monitoring::new(motor);
            let read = match &self.trace {
                Some(trace) => self.read_traced(path, trace, &mut monitoring),
                None => self.read(path, &mut monitoring, &mut |_, _| ()),
            };
            match read? {
                Source::Recording(_) => told(&monitoring.finish(), answers),
                Source::LoadTable(table) => show_table(&table, motor, answers),
            }
        })
    }

    fn read(
        &self,
        path: &Path,
        monitoring: &mut Monitoring<'_>,
        look: &mut dyn FnMut(f64, &Report),
    ) -> Result<Source, Failure> {
        let take = &mut |piece: &Recording, _| {
            let taken = monitoring.follow(piece, &mut |_, t, report| look(t, report));
            taken.map_err(|error| self.failure(error))
        };
        self.input.read_in_pieces(path, "monitoring", take)
    }

    /// The same with the windows in a file, which is there when all of them are.
    fn read_traced(
        &self,
        path: &Path,
        trace: &Path,
        monitoring: &mut Monitoring<'_>,
    ) -> Result<Source, Failure> {
        let mut read = None;
        let written = formats::write_whole(trace, |file| {
            let mut windows = WindowTrace::new(file).map_err(io::Error::other)?;
            let look = &mut |t: f64, report: &Report| windows.add(t, report);
            let done = read.insert(self.read(path, monitoring, look));
            match done {
                Ok(Source::Recording(_)) => windows.finish().map_err(io::Error::other),
                // Without windows there is no file.
                _ => Err(io::Error::other("no windows")),
            }
        });
        match (read, written) {
            (Some(Ok(Source::Recording(last))), Ok(())) => Ok(Source::Recording(last)),
            (Some(Ok(table @ Source::LoadTable(_))), _) => Ok(table),
            (Some(Err(failure)), _) => Err(failure),
            (_, written) => Err(Failure::Write {
                path: trace.display().to_string(),
                error: written
                    .err()
                    .unwrap_or_else(|| io::Error::other("no windows")),
            }),
        }
    }

    fn files(&self) -> Files {
        Files::default()
            .reads_recordings(&self.recordings, &self.input)
            .may_read("the motor file", self.motor.as_ref())
            .may_write("--trace", self.trace.as_ref())
            .writes_results(&self.output)
    }

    fn watch(&self) -> Result<Finding, Failure> {
        if self.output.report.is_some() {
            return Err(Failure::Usage(NO_LIVE_REPORT.to_owned()));
        }
        let files = self.files();
        match self.live.capture() {
            Some(path) => files.writes_recording("--capture", path).check(),
            None => files.check(),
        }?;
        let quiet = self.output.json.takes_stdout();
        let (watched, finding) = self.live.run(self.motor.as_deref(), quiet)?;
        self.output.json.write(&watched)?;
        Ok(finding)
    }

    fn failure(&self, error: MonitorError) -> Failure {
        let file = self.motor.as_deref().unwrap_or(Path::new("the recording"));
        match error {
            MonitorError::File(error) => Failure::File(error),
            MonitorError::Config(error) => Failure::Config {
                file: file.display().to_string(),
                error,
            },
        }
    }
}

fn told(result: &Monitored, answers: &mut Answers<'_>) -> Result<Finding, Failure> {
    let finding = match (result.audit.supported, result.state) {
        (true, VerdictState::Fault) => Finding::Something,
        (true, VerdictState::Healthy) => Finding::Nothing,
        (false, _) | (true, VerdictState::NotJudged) => Finding::Unsupported,
    };
    answers.give(Subject::Monitor, result, || print(result))?;
    Ok(finding)
}

fn show_table(
    table: &LoadTable,
    motor: Option<&MotorFile>,
    answers: &mut Answers<'_>,
) -> Result<Finding, Failure> {
    let points = OperatingPoints::new(table, motor);
    answers.give(Subject::LoadTable, &points, || say!("{points}"))?;
    Ok(Finding::Nothing)
}

/// A trace holds the windows of one recording.
const ONE_TRACE: &str = "--trace writes the windows of one recording, and several are named: ask for the trace of each by itself";

/// Frames hold lamps and residuals, not the samples that a page draws.
const NO_LIVE_REPORT: &str = "--report draws a recording, and a running board sends none: fetch its samples with \
    --motor M --capture FILE.csv, then run drivemon monitor FILE.csv --motor M --report FILE.html";

/// More lamp changes than this are left to the JSON.
const LONGEST_TIMELINE: usize = 40;

fn print(result: &Monitored) {
    let (audit, timeline) = (&result.audit, &result.timeline);
    say!(
        "{}  {:.3} s at {:.0} Hz",
        paint::strong(&result.recording),
        result.duration_s,
        1.0 / result.t_sample
    );
    for finding in &audit.findings {
        say!("  {} {}", paint::caution("audit:"), finding.detail);
    }
    print_lamps(timeline);
    print_windows(timeline);
    print_sequence(&timeline.sequence());
    say!("{}", words::rotor(&timeline.rotor()));
    if timeline.motion.not_possible.is_none() || timeline.something_moved() {
        print_motion(&timeline.motion, "");
    }
    match result.verdict.state {
        VerdictState::Healthy if !result.doubts.is_empty() => {
            say!(
                "{}",
                paint::caution("not judged: no fault was lit, and something does not fit")
            );
        }
        _ => print_verdict(timeline, &result.verdict),
    }
    for doubt in &result.doubts {
        say!("  {} {}", paint::caution("does not fit:"), doubt.seen);
        say!("    - {}", doubt.remedy);
    }
}

pub(crate) fn print_lamps(timeline: &Timeline) {
    if timeline.lamps.is_empty() {
        return;
    }
    say!("\n    time s  RUN  r1 r2 r3 r4  SENSOR LINE LOAD FAULT");
    for state in timeline.lamps.iter().take(LONGEST_TIMELINE) {
        say!(
            "{:>10.3}   {}   {}  {}  {}  {}     {}     {}    {}    {}    {}",
            state.t,
            symbol(state.run),
            symbol(state.r1),
            symbol(state.r2),
            symbol(state.r3),
            symbol(state.r4),
            symbol(state.sensor),
            symbol(state.line),
            symbol(state.load),
            symbol(state.fault),
            paint::faint(
                state
                    .not_judged
                    .map_or(String::new(), |why| why.to_string())
            ),
        );
    }
    let more = timeline.lamps.len().saturating_sub(LONGEST_TIMELINE);
    if more > 0 {
        let beyond = timeline.further_changes;
        match beyond {
            0 => say!("  ... and {more} more changes (--json FILE has them all)"),
            _ => say!(
                "  ... and {} more changes (--json FILE has the first {})",
                more as u64 + beyond,
                timeline.lamps.len()
            ),
        }
    }
}

pub(crate) fn print_windows(timeline: &Timeline) {
    say!(
        "\n{} of {} windows judged",
        timeline.judged,
        timeline.windows
    );
    if let Some(direction) = timeline.direction().filter(|turned| turned.is_mirrored()) {
        say!("  {direction}");
    }
    for share in &timeline.not_judged {
        say!("  {} not judged: {}", share.windows, share.reason);
    }
    print_beyond(timeline);
    if let Some((mean, deviation)) = timeline.residual_percent() {
        for (k, (mean, deviation)) in mean.iter().zip(deviation).enumerate() {
            say!(
                "  r{}  {mean:+8.3} % of scale, scatter {deviation:.3} %",
                k + 1
            );
        }
    }
    if let Some([r1, r2, r3, r4]) = timeline.visible_percent() {
        say!(
            "  smallest that lights a lamp here: r1 {r1:.2}, r2 {r2:.2}, r3 {r3:.2}, r4 {r4:.2} % of scale"
        );
    }
}

fn print_beyond(timeline: &Timeline) {
    if let Some(words) = timeline.beyond.words() {
        say!(
            "  {} {} of them lie beyond the calibration ({words}): small faults stay dark there. Record the motor in good order there, and calibrate with it",
            paint::caution("less is known:"),
            timeline.beyond.windows
        );
    }
}

pub(crate) fn print_sequence(sequence: &SequenceSummary) {
    let percent =
        |x: Option<f64>| x.map_or("not measured".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    let angle = sequence
        .i2_over_i1_angle_deg
        .map_or(String::new(), |angle| format!(" at {angle:.0} deg"));
    say!(
        "negative over positive sequence: current {}{angle}, voltage {}; zero sequence of the current {}",
        percent(sequence.i2_over_i1),
        percent(sequence.v2_over_v1),
        percent(sequence.i0_over_i1),
    );
}

pub(crate) fn print_verdict(timeline: &Timeline, verdict: &Verdict) {
    match verdict.state {
        VerdictState::Healthy if timeline.motion.is_fault() => say!("at rest no fault was lit"),
        VerdictState::Healthy if !timeline.motion.unexplained.is_empty() => {
            say!(
                "{}",
                paint::caution(
                    "not judged: at rest no fault was lit, and in motion something does not fit"
                )
            );
        }
        VerdictState::Healthy => say!("{}", paint::good("healthy: no fault was lit")),
        VerdictState::NotJudged if timeline.motion.judged > 0 => {
            say!("{}", paint::caution("at rest not judged"));
        }
        VerdictState::NotJudged => say!("{}", paint::caution("not judged")),
        VerdictState::Fault => {
            let t = timeline.first_alarm_s.unwrap_or_default();
            say!(
                "{}",
                paint::error(format!("FAULT, first lit at {t:.3} s; possible causes:"))
            );
            for candidate in &verdict.candidates {
                let phase = candidate
                    .phase
                    .map_or(String::new(), |phase| format!(", phase {phase}"));
                let cause = candidate.fault.words();
                let percent = 100.0 * candidate.probability;
                let size = candidate
                    .size_percent
                    .map_or(String::new(), |size| format!(", {size:+.1} %"));
                say!(
                    "  {percent:5.1} %  {:<3} {cause}{phase}{size}",
                    candidate.fault
                );
            }
            print_tie(verdict);
        }
    }
}

fn print_tie(verdict: &Verdict) {
    if verdict.tied < 2 {
        return;
    }
    say!(
        "the first {} are tied: this recording does not tell them apart. What does:",
        verdict.tied
    );
    for test in &verdict.separating_tests {
        say!("  - {test}");
    }
}
