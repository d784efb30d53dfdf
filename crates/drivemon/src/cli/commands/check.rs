//! `drivemon check`: from recordings and a plate to an answer on which a technician can act.

use std::path::PathBuf;

use clap::Args;
use motor::MotorFile;
use nameplate::{Estimate, motor_text};
use recording::{Recording, Source};
use replay::check::{Checked, Knowledge, Learnt, check, learn};
use replay::speed::{EstimatedSpeed, SpeedSource};
use replay::{Verdict, VerdictState};
use serde::Serialize;

use crate::cli::arguments::files::Files;
use crate::cli::arguments::input::{InputArgs, read_motor};
use crate::cli::arguments::study::{print_audit, quantity, with_progress};
use crate::cli::commands::motor::identify::print_table;
use crate::cli::commands::motor::plate::PlateArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{JsonArgs, write_text};
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};

/// Is this motor in good order? From recordings and a nameplate to an answer, in one step.
///
/// The plate becomes a motor file with intervals, healthy recordings (--healthy) teach parameters and statistics, and each
/// recording is judged by the board's core. What the plate leaves open lights nothing. Without a speed the slip is estimated
/// from slot harmonics where they are seen, else from the circuit, and said to be an estimate.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Check {
    /// Recordings to judge
    #[arg(value_name = "REC", required = true)]
    recordings: Vec<PathBuf>,
    /// A recording of the motor in good order; may be given several times
    #[arg(long, value_name = "REC")]
    healthy: Vec<PathBuf>,
    /// Motor file, where there is one; otherwise the plate
    #[arg(long, value_name = "M", conflicts_with = "plate")]
    motor: Option<PathBuf>,
    /// Write what is known of the motor afterwards as a motor file
    #[arg(short, long = "out", value_name = "M2")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plate: PlateArgs,
    #[command(flatten)]
    json: JsonArgs,
    #[command(flatten)]
    input: InputArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon check today.csv --plate pump-plate.toml
  drivemon check today.csv --plate pump-plate.toml --healthy march.csv -o pump.toml
  drivemon check today.csv --power-kw 5.5 --voltage-volt 400 --speed-rpm 1455 --current-amp 10.4
Exit codes: 0 in good order as far as can be seen, 1 a fault, 2 bad input, 3 not judged: the answer says what to record.";

#[derive(Debug, Serialize)]
struct CheckJson<'a> {
    motor: &'a str,
    knowledge: Knowledge,
    notes: &'a [String],
    contradictions: &'a [String],
    recordings: &'a [Named],
    motor_file: Option<String>,
}

#[derive(Debug, Serialize)]
struct Named {
    recording: String,
    #[serde(flatten)]
    checked: Checked,
}

impl Check {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        self.files().check()?;
        let (motor, contradictions) = self.known()?;
        let healthy = self.read(&self.healthy)?;
        let recordings = self.read(&self.recordings)?;
        let learnt = with_progress(|progress| Ok(learn(&motor, &healthy, progress)))?;
        if let Some(out) = &self.out {
            write_text(out, &learnt.motor.to_toml())?;
        }
        let answers = self.checked(&recordings, &learnt)?;
        let result = CheckJson {
            motor: &learnt.motor.name,
            knowledge: learnt.knowledge,
            notes: &learnt.notes,
            contradictions: &contradictions,
            recordings: &answers,
            motor_file: self.out.as_ref().map(|path| path.display().to_string()),
        };
        self.json.give(&result, || print(&result, &learnt))?;
        Ok(finding(&answers))
    }

    fn files(&self) -> Files {
        let files = Files::default()
            .reads_recordings(self.recordings.iter().chain(&self.healthy), &self.input)
            .may_read("the motor file", self.motor.as_ref())
            .may_read("the plate", self.plate.file())
            .may_write("--json", self.json.file());
        match &self.out {
            Some(out) => files.writes("-o", out),
            None => files,
        }
    }

    /// The motor by its file or its plate, and what contradicts what on the plate.
    fn known(&self) -> Result<(MotorFile, Vec<String>), Failure> {
        if let Some(path) = &self.motor {
            return Ok((read_motor(path)?, Vec::new()));
        }
        let plate = self.plate.read()?;
        let estimate =
            Estimate::of(&plate.plate).map_err(|problem| Failure::Usage(problem.to_string()))?;
        let text = motor_text(&plate, &estimate).map_err(Failure::Usage)?;
        let contradictions = estimate.contradictions.iter().map(ToString::to_string);
        Ok((
            MotorFile::parse(&text, "the plate")?,
            contradictions.collect(),
        ))
    }

    fn read(&self, paths: &[PathBuf]) -> Result<Vec<Recording>, Failure> {
        let one = |path: &PathBuf| match self.input.read(path)? {
            Source::Recording(recording) => Ok(recording),
            Source::LoadTable(_) => Err(Failure::Usage(format!(
                "{}: a load table has no waveforms to judge; `drivemon explain` takes it",
                path.display()
            ))),
        };
        paths.iter().map(one).collect()
    }

    fn checked(&self, recordings: &[Recording], learnt: &Learnt) -> Result<Vec<Named>, Failure> {
        let one = |(path, recording): (&PathBuf, &Recording)| {
            let bar = progress::bar("checking", recording.len() as u64);
            let checked = check(recording, &learnt.motor, &mut |k| {
                bar.set_position(k as u64)
            });
            bar.finish_and_clear();
            Ok(Named {
                recording: path.display().to_string(),
                checked: checked.map_err(Failure::Usage)?,
            })
        };
        self.recordings.iter().zip(recordings).map(one).collect()
    }
}

/// A fault outweighs what was not judged.
fn finding(answers: &[Named]) -> Finding {
    let any = |state| {
        answers
            .iter()
            .any(|answer| answer.checked.verdict.state == state)
    };
    if any(VerdictState::Fault) {
        Finding::Something
    } else if any(VerdictState::NotJudged) {
        Finding::Unsupported
    } else {
        Finding::Nothing
    }
}

fn print(result: &CheckJson<'_>, learnt: &Learnt) {
    let known = match result.knowledge {
        Knowledge::AsGiven => "known by its plate or file alone",
        Knowledge::Identified => "parameters learnt from healthy recordings",
        Knowledge::Calibrated => "calibrated on healthy recordings",
    };
    say!("{}: {known}", paint::strong(result.motor));
    for contradiction in result.contradictions {
        say!("  {} {contradiction}", paint::caution("plate:"));
    }
    for note in result.notes {
        say!("  {} {note}", paint::caution("note:"));
    }
    if let Some(report) = &learnt.identified {
        print_table(&report.parameters);
    }
    result.recordings.iter().for_each(print_one);
    if let Some(path) = &result.motor_file {
        say!("\n{path} is written: drivemon check REC --motor {path}");
    }
}

fn print_one(named: &Named) {
    let checked = &named.checked;
    say!("\n{}", paint::strong(&named.recording));
    print_audit(&checked.audit);
    print_state(&checked.verdict);
    if let Some(severity) = checked.severity {
        say!("  size: {}", severity.words());
    }
    if let Some(speed) = &checked.speed {
        print_speed(speed);
    }
    for clamp in &checked.clamps {
        let hz = clamp
            .frequency_hz
            .map_or("no steady frequency".to_owned(), |hz| format!("{hz:.2} Hz"));
        say!(
            "  {}: {hz}, {} {} rms, {:+.1} % from the first to the last quarter",
            clamp.channel,
            quantity(clamp.rms),
            clamp.unit,
            clamp.change_percent
        );
    }
    let [judged, windows] = checked.windows;
    say!("  {judged} of {windows} windows judged");
    checked
        .not_judged
        .iter()
        .for_each(|why| say!("    not judged: {why}"));
    say!("  {}", checked.rotor);
    if let Some(percent) = checked.current_unbalance_percent {
        say!("  unbalance of the currents (negative over positive sequence): {percent:.2} %");
    }
    if let Some([r1, ..]) = checked.visible_percent {
        say!(
            "  a fault shows here from {} % of the voltage balance (r1) on",
            quantity(r1)
        );
    }
    print_steps(checked);
}

fn print_speed(speed: &EstimatedSpeed) {
    let source = match speed.source {
        SpeedSource::Circuit => "from the circuit",
        SpeedSource::SlotHarmonics => "from slot harmonics",
    };
    let decimals = match speed.source {
        SpeedSource::Circuit => 2,
        SpeedSource::SlotHarmonics => 3,
    };
    say!(
        "  speed: no encoder; estimated {:.0} rpm, slip {:.decimals$} +- {:.decimals$} % of synchronous speed, {source}",
        speed.mean_rpm,
        speed.slip_percent,
        speed.slip_half_width_percent
    );
    let bars: Vec<String> = speed.rotor_bars.iter().map(ToString::to_string).collect();
    if speed.source == SpeedSource::Circuit && !bars.is_empty() {
        say!(
            "    slot harmonics are seen and fit {} rotor bars: with the right number as rotor_bars on the plate they give the speed",
            bars.join(", ")
        );
    }
}

fn print_state(verdict: &Verdict) {
    match verdict.state {
        VerdictState::Healthy => say!(
            "  {}",
            paint::good("in good order, as far as can be seen here")
        ),
        VerdictState::NotJudged => say!("  {}", paint::caution("not judged")),
        VerdictState::Fault => {
            say!("  {}", paint::error("FAULT; possible causes:"));
            for candidate in &verdict.candidates {
                let phase = candidate
                    .phase
                    .map_or(String::new(), |phase| format!(", phase {phase}"));
                let size = candidate
                    .size_percent
                    .map_or(String::new(), |size| format!(", {size:+.1} %"));
                say!(
                    "  {:5.1} %  {}{phase}{size}",
                    100.0 * candidate.probability,
                    candidate.fault.words()
                );
            }
        }
    }
}

fn print_steps(checked: &Checked) {
    if !checked.todo.is_empty() {
        say!("  what to do:");
        checked.todo.iter().for_each(|step| say!("    - {step}"));
    }
    if !checked.blind.is_empty() {
        say!("  what cannot be seen:");
        for spot in &checked.blind {
            say!("    - {} (needs {})", spot.unseen, spot.needs);
        }
    }
}
