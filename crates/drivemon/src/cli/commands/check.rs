//! `drivemon check`: from recordings and a plate to an answer on which a technician can act.

use std::path::{Path, PathBuf};

use clap::Args;
use recording::{Recording, Source};
use replay::VerdictState;
use replay::check::{Checked, Reference};
use replay::speed::{EstimatedSpeed, SpeedSource};
use report::Subject;
use report::study::{CheckedRecording, Checkup, Known, Taken};

use crate::cli::arguments::files::Files;
use crate::cli::arguments::healthy::HealthyRecording;
use crate::cli::arguments::input::{InputArgs, read_motor};
use crate::cli::arguments::study::{print_audit, quantity, with_progress};
use crate::cli::commands::motor::identify::print_table;
use crate::cli::commands::motor::plate::PlateArgs;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::motion::print_motion;
use crate::cli::printing::output::{OutputArgs, write_text};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

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
    #[arg(long, value_name = "M")]
    motor: Option<PathBuf>,
    /// Write what is known of the motor afterwards as a motor file
    #[arg(short, long = "out", value_name = "M2")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plate: PlateArgs,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    input: InputArgs,
}

const EXAMPLES: &str = "\
Examples:
  drivemon check today.csv --plate pump-plate.toml
  drivemon check today.csv --plate pump-plate.toml --healthy march.csv -o pump.toml
  drivemon check today.csv --motor pump.toml --report today.html
  drivemon check today.csv --power-kw 5.5 --voltage-volt 400 --speed-rpm 1455 --current-amp 10.4
Exit codes: 0 in good order as far as can be seen, 1 a fault, 2 bad input, 3 not judged: the answer says what to record.";

impl Check {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        self.files().check()?;
        let known = self.known()?;
        let healthy = self.healthy.iter();
        let healthy = healthy.map(|path| HealthyRecording::read(path, &self.input, NO_WAVEFORMS));
        let healthy = healthy.collect::<Result<Vec<_>, _>>()?;
        let names = self.recordings.iter();
        let names: Vec<String> = names.map(|path| path.display().to_string()).collect();
        let healthy: Vec<&dyn Reference> = healthy.iter().map(|one| one as _).collect();
        let mut read = |k: usize, take: &mut Taken<'_>| self.give(k, take);
        let checked = with_progress(|progress| {
            Ok(Checkup::of_pieces(
                &known, &healthy, &names, progress, &mut read,
            ))
        })?;
        let (mut checkup, motor) = checked?;
        if let Some(out) = &self.out {
            write_text(out, &motor.to_toml())?;
            checkup.motor_file = Some(out.display().to_string());
        }
        self.output
            .give(Subject::Check, &checkup, || print(&checkup))?;
        Ok(match checkup.state() {
            VerdictState::Fault => Finding::Something,
            VerdictState::NotJudged => Finding::Unsupported,
            VerdictState::Healthy => Finding::Nothing,
        })
    }

    fn files(&self) -> Files {
        let files = Files::default()
            .reads_recordings(self.recordings.iter().chain(&self.healthy), &self.input)
            .may_read("the motor file", self.motor.as_ref())
            .may_read("the plate", self.plate.file())
            .writes_results(&self.output);
        match &self.out {
            Some(out) => files.writes("-o", out),
            None => files,
        }
    }

    /// The motor by its file or its plate.
    fn known(&self) -> Result<Known, Failure> {
        let Some(path) = &self.motor else {
            return Known::of_plate(&self.plate.read()?).map_err(Failure::Usage);
        };
        if let Some(flag) = self.plate.given() {
            return Err(Failure::Usage(format!(
                "{flag}: --motor says everything of the motor; leave {flag} out, or leave --motor out"
            )));
        }
        let motor = read_motor(path)?;
        let text = motor.to_toml();
        Ok(Known::of_file(motor, text))
    }

    /// Gives a recording piece by piece.
    fn give(&self, k: usize, take: &mut Taken<'_>) -> Result<(), Failure> {
        let Some(path) = self.recordings.get(k) else {
            return Ok(());
        };
        let mut each = |piece: &Recording, _| take(piece).map_err(Failure::Usage);
        match self.input.read_in_pieces(path, "checking", &mut each)? {
            Source::Recording(_) => Ok(()),
            Source::LoadTable(_) => Err(no_waveforms(path)),
        }
    }
}

/// Why a load table is refused, and what takes it.
const NO_WAVEFORMS: &str = "has no waveforms to judge; `drivemon explain` takes it";

fn no_waveforms(path: &Path) -> Failure {
    Failure::Usage(format!("{}: a load table {NO_WAVEFORMS}", path.display()))
}

fn print(checkup: &Checkup) {
    say!("{}: {}", paint::strong(&checkup.motor), checkup.known_by);
    for contradiction in &checkup.contradictions {
        say!("  {} {contradiction}", paint::caution("plate:"));
    }
    for note in &checkup.notes {
        say!("  {} {note}", paint::caution("note:"));
    }
    if let Some(report) = &checkup.identified {
        print_table(&report.parameters);
    }
    checkup.recordings.iter().for_each(print_one);
    if let Some(path) = &checkup.motor_file {
        say!("\n{path} is written: drivemon check REC --motor {path}");
    }
}

fn print_one(named: &CheckedRecording) {
    let checked = &named.checked;
    say!("\n{}", paint::strong(&named.recording));
    print_audit(&checked.audit);
    print_state(checked);
    if let Some(severity) = checked.told.severity {
        say!("  severity: {severity}");
    }
    if named.is_reference {
        say!("  this recording taught what is normal: it is compared with itself");
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
        if let Some(rotor) = &clamp.rotor {
            say!("    {rotor}");
        }
    }
    let [judged, windows] = checked.windows;
    say!("  {judged} of {windows} windows judged");
    checked
        .not_judged
        .iter()
        .for_each(|why| say!("    not judged: {why}"));
    print_motion(&checked.motion, "  ");
    if checked.clamps.is_empty() {
        say!("  {}", checked.rotor);
    }
    if let Some(percent) = checked.current_unbalance_percent {
        say!("  unbalance of the currents (negative over positive sequence), mean: {percent:.2} %");
    }
    if let Some([r1, ..]) = checked.visible_percent {
        say!(
            "  the voltage balance (r1) shows a departure of {} % and more",
            replay::check::two_digits(r1)
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

fn print_state(checked: &Checked) {
    let told = checked.told.state;
    match checked.state {
        VerdictState::Healthy => say!("  {}", paint::good(told)),
        VerdictState::NotJudged => say!("  {}", paint::caution(told)),
        VerdictState::Fault if checked.verdict.state == VerdictState::Fault => {
            let told = told.to_uppercase();
            say!("  {}", paint::error(format!("{told}; possible causes:")));
            for candidate in &checked.verdict.candidates {
                say!("  {:5.1} %  {candidate}", 100.0 * candidate.probability);
            }
        }
        VerdictState::Fault => say!("  {}", paint::error(told.to_uppercase())),
    }
    if let Some(caveat) = &checked.caveat {
        say!("  {caveat}");
    }
    for doubt in &checked.doubts {
        say!("  does not fit: {}", doubt.seen);
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
    if checked.lacks_reference() {
        say!("  a recording in good order is given with --healthy REC");
    }
}
