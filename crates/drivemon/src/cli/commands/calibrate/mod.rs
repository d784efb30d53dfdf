//! `drivemon calibrate`: what a healthy motor looks like, and what the instrument's channels do.

mod channels;

use std::path::{Path, PathBuf};

use clap::Args;
use monitor::Cage;
use motor::InMotion;
use motor::MotorFile;
use recording::{Recording, Source};

use crate::cli::arguments::files::Files;
use crate::cli::arguments::healthy::HealthyRecording;
use crate::cli::arguments::input::{InputArgs, read_motor};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{JsonArgs, write_text};
use crate::cli::printing::terminal::say;
use crate::cli::printing::{paint, progress};
use channels::ChannelArgs;
use replay::calibrate::{Pieces, Refusal, Surroundings};
use report::json::Format;
use report::motor_text;
use report::study::{
    Calibration, CalibrationRange, FALSE_ALARM_RATES, HealthyCage, WINDING_KELVINS,
};

/// Learn a healthy motor: parameters, gains of the channels, statistics, thresholds.
///
/// Give recordings of the motor in good order, at several loads if it has them, at several supply voltages if it sees
/// them. Steady parts are used, starts and load steps are passed over. With the new motor file FAULT follows the
/// direction of the evidence instead of the lamps r1..r4, and names phases. Three currents alone are enough to watch for
/// shorted turns. Recordings that are faulty themselves are refused, and nothing is written then.
///
/// With `--channels` it learns the instrument instead: gain and delay of each channel, from one signal on all of them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Calibrate {
    /// Recordings of the healthy motor (.csv, .csv.gz, .parquet, .mat, .cfg, .cff)
    #[arg(value_name = "REC", required = true)]
    recordings: Vec<PathBuf>,
    /// Motor file with what is believed so far; with --channels the one that the recordings were read with, if any
    #[arg(long, value_name = "M", required_unless_present = "channels")]
    motor: Option<PathBuf>,
    /// Motor file to write; with --channels and without --motor its table `[sensors]` alone
    #[arg(short, long = "out", value_name = "M2")]
    out: PathBuf,
    /// How much warmer or colder than in the recordings the windings may become, K
    #[arg(long, value_name = "K", default_value_t = 75.0)]
    winding_kelvin: f64,
    /// FAULT lamps per judged window that are accepted on a healthy motor
    #[arg(long, value_name = "RATE", default_value_t = 1e-6)]
    false_alarm_rate: f64,
    #[command(flatten)]
    channels: ChannelArgs,
    #[command(flatten)]
    json: JsonArgs,
    #[command(flatten)]
    input: InputArgs,
}

/// Why a load table is refused, and what takes it.
const NO_WAVEFORMS: &str =
    "has no waveforms to calibrate from; its parameters come from `drivemon explain`";

/// Uncertainty of the stator resistance above which loads are too few or too alike: three from idle to rated leave some
/// 2 %, two 11 to 16 %.
const LOADS_ALIKE_PERCENT: f64 = 5.0;

const EXAMPLES: &str = "\
Example:
  drivemon calibrate idle.csv.gz half.csv.gz full.csv.gz --motor m.toml -o m-calibrated.toml
  drivemon monitor today.csv.gz --motor m-calibrated.toml
  drivemon calibrate --channels bench-25hz.csv bench-60hz.csv --true-volt 230.4 --true-amp 7.02 --motor m.toml -o m-board17.toml
Exit codes: 0 calibrated, 2 bad input, 3 refused: the reason names the recording and what to do.";

impl Calibrate {
    /// Runs the command.
    pub fn run(&self) -> Result<Finding, Failure> {
        self.check()?;
        self.files().check()?;
        match &self.motor {
            _ if self.channels.channels => {
                let recordings = self.read()?;
                let files = (self.motor.as_deref(), &self.out);
                channels::run(&self.channels, &recordings, files, &self.json)
            }
            Some(motor) => self.learn(motor),
            None => Err(Failure::Usage(
                "--motor is missing: name the motor file with what is believed so far".to_owned(),
            )),
        }
    }

    fn learn(&self, path: &Path) -> Result<Finding, Failure> {
        let recordings = self.recordings.iter();
        let read = recordings.map(|path| HealthyRecording::read(path, &self.input, NO_WAVEFORMS));
        let recordings = read.collect::<Result<Vec<_>, _>>()?;
        let motor = read_motor(path)?;
        let surroundings = Surroundings {
            winding_kelvin: self.winding_kelvin,
            false_alarm_rate: self.false_alarm_rate,
        };
        let spinner = progress::bar("calibrating", 0);
        let names = self.recordings.iter().map(|p| p.display().to_string());
        let recordings: Vec<&dyn Pieces> = recordings.iter().map(|one| one as _).collect();
        let learnt = Calibration::of_pieces(names.collect(), &recordings, &motor, &surroundings);
        spinner.finish_and_clear();
        let (mut result, calibrated) = learnt.map_err(refused)?;
        self.write_motor(path, &calibrated)?;
        result.motor_file = self.out.display().to_string();
        self.json.give(&result, || print(&result))?;
        Ok(Finding::Nothing)
    }

    fn files(&self) -> Files {
        Files::default()
            .reads_recordings(&self.recordings, &self.input)
            .may_read("the motor file", self.motor.as_ref())
            .writes("-o", &self.out)
            .may_write("--json", self.json.file())
    }

    fn check(&self) -> Result<(), Failure> {
        let rate = self.false_alarm_rate;
        if !FALSE_ALARM_RATES.contains(&rate) {
            let message = format!("--false-alarm-rate {rate} is outside 1e-12..=0.01 per window");
            return Err(Failure::Usage(message));
        }
        let kelvin = self.winding_kelvin;
        if !WINDING_KELVINS.contains(&kelvin) {
            return Err(Failure::Usage(format!(
                "--winding-kelvin {kelvin} is outside 0..=200 K"
            )));
        }
        Ok(())
    }

    fn read(&self) -> Result<Vec<Recording>, Failure> {
        let one = |path: &PathBuf| match self.input.read(path)? {
            Source::Recording(recording) => Ok(recording),
            Source::LoadTable(_) => Err(Failure::Usage(format!(
                "{}: a load table {NO_WAVEFORMS}",
                path.display()
            ))),
        };
        self.recordings.iter().map(one).collect()
    }

    fn write_motor(&self, path: &Path, motor: &MotorFile) -> Result<(), Failure> {
        let old = std::fs::read_to_string(path).unwrap_or_default();
        let text = motor_text::updated(&old, motor);
        write_text(&self.out, &text)
    }
}

fn refused(refusal: Refusal) -> Failure {
    Failure::Unsupported(format!("not calibrated: {refusal}"))
}

fn print(result: &Calibration) {
    say!(
        "{}: {} steady windows of {}",
        paint::strong(&result.motor),
        result.windows,
        result.recordings.join(", ")
    );
    print_findings(result);
    print_parameters(result);
    for gain in &result.gains {
        let [a, b, c] = gain.gain;
        say!("  {:<30} a {a:.4}  b {b:.4}  c {c:.4}", gain.effect);
    }
    print_statistics(result);
    say!("\n{} is written.", result.motor_file);
    say!("  drivemon monitor REC --motor {}", result.motor_file);
}

/// What the audits found: once for all recordings where it is the same, else with the recording's name.
fn print_findings(result: &Calibration) {
    let of_all = |detail: &str| {
        result
            .audits
            .iter()
            .all(|audit| audit.findings.iter().any(|f| f.detail == detail))
    };
    let word = paint::caution("audit:");
    for (k, (name, audit)) in result.recordings.iter().zip(&result.audits).enumerate() {
        for finding in &audit.findings {
            match (of_all(&finding.detail), k) {
                (true, 0) => say!("  {word} {}", finding.detail),
                (true, _) => {}
                (false, _) => say!("  {word} {name}: {}", finding.detail),
            }
        }
    }
}

fn print_parameters(result: &Calibration) {
    if result.parameters.is_empty() {
        say!("  currents alone: parameters stay as believed");
        return;
    }
    say!(
        "\n  {:<30} {:>12} {:>12}  change",
        "parameter",
        "believed",
        "calibrated"
    );
    for row in &result.parameters {
        say!(
            "  {:<30} {:>12.5} {:>12.5}  {:+.1} % +- {:.1} % {}",
            row.name,
            row.believed,
            row.value,
            row.change_percent,
            100.0 * row.std_error / row.believed,
            paint::faint(row.unit),
        );
    }
    let m = &result.misfit_percent;
    say!(
        "  what remains: torque balance {:.2} %, e_d {:.3} %, e_q {:.3} % of their scales",
        m.torque,
        m.e_d,
        m.e_q
    );
}

fn print_statistics(result: &Calibration) {
    let healthy = &result.healthy;
    let [re, im] = healthy.i2_over_i1_percent;
    say!(
        "\n  healthy I2/I1 {:.2} % at {:.0} deg, scatter {:.2} %",
        re.hypot(im),
        im.atan2(re).to_degrees(),
        healthy.i2_over_i1_scatter_percent
    );
    say!(
        "  FAULT lights beyond {:.2} standard deviations: {:.0e} false alarms a window",
        healthy.significance,
        result.false_alarm_rate
    );
    if !result.parameters.is_empty() {
        print_loads(healthy.stator_resistance_percent);
    }
    if let Some(range) = &healthy.range {
        print_range(range);
    }
    print_rotor(healthy.rotor.as_ref());
    print_in_motion(healthy.in_motion);
    let [r1, r2, r3, r4] = result.threshold_percent;
    say!("  thresholds r1 {r1:.2}  r2 {r2:.2}  r3 {r3:.2}  r4 {r4:.2} % of scale");
}

/// What recordings at loads that are too alike leave open.
fn print_loads(stator_resistance_percent: f64) {
    if stator_resistance_percent > LOADS_ALIKE_PERCENT {
        say!(
            "  {} too few or too alike: the stator resistance is known to {stator_resistance_percent:.0} % only, and FAULT waits for larger faults. Record three loads from idle to the largest, or two at a second voltage too; without a torque channel each load may have warmed the winding, and nothing tells how far",
            paint::caution("loads:")
        );
    }
}

/// Where the calibration holds.
fn print_range(range: &CalibrationRange) {
    let [low, high] = range.volt_per_hertz_percent;
    let [slow, fast] = range.frequency_percent;
    let active = match range.active_percent {
        percent if percent <= -1.0 => format!("fed back up to {:.0} %", -percent),
        percent => format!("active current from {percent:.0} %"),
    };
    say!(
        "  seen up to {:.0} % of the rated current ({active}), at {low:.0} to {high:.0} % of the rated voltage over frequency and {slow:.0} to {fast:.0} % of the rated frequency; beyond, small faults stay dark",
        range.current_percent
    );
}

fn print_in_motion(seen: InMotion) {
    let caution = paint::caution("in motion:");
    match seen {
        InMotion::Fits => say!("  in motion the model follows the motor in good order"),
        InMotion::Differs => say!(
            "  {caution} in good order it moved otherwise than its file says, so it will not be judged in motion: drivemon explain says which effect is missing"
        ),
        InMotion::Unseen => say!(
            "  {caution} hardly anything moved: what departs in motion will be no FAULT. A recording with a start and load steps shows whether the model fits there"
        ),
    }
}

fn print_rotor(rotor: Option<&HealthyCage>) {
    let Some(rotor) = rotor else {
        say!("  rotor bars not calibrated: too few blocks with speed and load");
        return;
    };
    let ([light, heavy], [first, last]) = (rotor.active_percent, rotor.sideband_percent);
    let scatter = rotor.scatter_percent;
    if light == heavy {
        say!(
            "  healthy sideband of the rotor bars {first:.2} % at {light:.0} % active current, scatter {scatter:.2} %"
        );
    } else {
        say!(
            "  healthy sideband of the rotor bars {first:.2} % at {light:.0} % active current, {last:.2} % at {heavy:.0} %, scatter {scatter:.2} %"
        );
    }
    let largest = first.max(last);
    if largest >= 100.0 * f64::from(Cage::DOUBTFUL) {
        say!(
            "  {} {largest:.2} % is more than most whole cages leave: if bars are broken already, they are now taken for healthy",
            paint::caution("rotor:")
        );
    }
}

/// The formats of their JSON.
pub fn formats() -> Vec<Format> {
    vec![Format::of::<channels::ChannelsJson>()]
}
