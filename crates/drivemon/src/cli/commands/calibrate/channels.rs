//! `drivemon calibrate --channels`: gains and delays of the instrument, from one signal on all of its channels.

use std::path::{Path, PathBuf};

use clap::Args;
use motor::MotorFile;
use motor::motor_file::Sensors;
use recording::Recording;
use replay::channels::{Estimate, Found, NAMES, Setup, find};
use report::json::Answer;
use report::motor_text;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::arguments::input::read_motor;
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::output::{JsonArgs, write_text};
use crate::cli::printing::paint;
use crate::cli::printing::terminal::say;

const MICROSECOND: f64 = 1e-6;
/// Rotation that is worth a sentence, degrees: 3 us of 50 Hz.
const ROTATION_DEG: f64 = 0.05;
/// Standard errors from which on it is one.
const SURE: f64 = 3.0;
/// Share of full scale below which the converter's non-linearity shows in a gain.
const SMALL: f64 = 0.25;

/// What only the calibration of channels takes.
#[derive(Debug, Args)]
pub struct ChannelArgs {
    /// Calibrate the instrument's channels instead: all six see one signal
    ///
    /// Lead the three voltage inputs in parallel to one phase and its current through all three transducers, one after the
    /// other, into a heater. Record ten seconds near half of full scale, best at two frequencies. A running motor cannot
    /// tell these numbers: 1 us between voltages and currents looks like 1 % of its stator resistance.
    #[arg(long)]
    pub channels: bool,
    /// With --channels: root mean square of the voltage by a meter, V; without it the mean of the three stays
    #[arg(long, value_name = "V", requires = "channels")]
    true_volt: Option<f64>,
    /// With --channels: root mean square of the current by a meter, A; without it the mean of the three stays
    #[arg(long, value_name = "A", requires = "channels")]
    true_amp: Option<f64>,
    /// With --channels: L/R of the load, us; 10 uH at 50 ohm is 0.2
    #[arg(long, value_name = "US", default_value_t = 0.0, requires = "channels")]
    load_us: f64,
}

/// What the calibration of the channels found.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ChannelsJson {
    /// The recordings.
    recordings: Vec<String>,
    /// Frequencies of the recordings, Hz.
    frequencies_hz: Vec<f64>,
    /// Stretches that were evaluated.
    blocks: usize,
    /// Root mean squares of the channels, the largest of the recordings.
    amplitude_rms: AmplitudeJson,
    /// The six channels.
    channels: Vec<ChannelJson>,
    /// The file that was written.
    written: String,
}

impl Answer for ChannelsJson {
    const FORMAT: &'static str = "calibrate-channels/1";
}

/// Root mean squares.
#[derive(Debug, Serialize, JsonSchema)]
struct AmplitudeJson {
    /// Of the voltage, V.
    volt: f64,
    /// Of the current, A.
    amp: f64,
}

/// One channel; numbers as the file has them now, with what this calibration added.
#[derive(Debug, Serialize, JsonSchema)]
struct ChannelJson {
    /// The channel.
    name: &'static str,
    /// Gain.
    gain: f64,
    /// Standard error of the gain.
    gain_std_error: f64,
    /// Delay, us.
    delay_us: f64,
    /// Standard error of the delay, us.
    delay_std_error_us: f64,
    /// Angle that does not grow with the frequency, degrees; absent where the recordings have one frequency.
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation_deg: Option<f64>,
    /// Standard error of the angle, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation_std_error_deg: Option<f64>,
}

/// Runs the command.
pub fn run(
    args: &ChannelArgs,
    recordings: &[Recording],
    (motor, out): (Option<&Path>, &PathBuf),
    json: &JsonArgs,
) -> Result<Finding, Failure> {
    let motor = match motor {
        Some(path) => Some((path, read_motor(path)?)),
        None => None,
    };
    let sensors = motor.as_ref().map(|(_, motor)| motor.sensors);
    let setup = args.setup(sensors.as_ref())?;
    let found = find(recordings, &setup)
        .map_err(|refusal| Failure::Unsupported(format!("not calibrated: {refusal}")))?;
    let channels = channels(&found, sensors.as_ref());
    check_ranges(&channels)?;
    let text = match &motor {
        Some((path, motor)) => in_motor_file(path, motor, &channels),
        None => as_table(&channels),
    };
    write_text(out, &text)?;
    let [volt, amp] = found.amplitude_rms;
    let result = ChannelsJson {
        recordings: recordings.iter().map(|r| r.name().to_owned()).collect(),
        frequencies_hz: found.frequencies_hz,
        blocks: found.blocks,
        amplitude_rms: AmplitudeJson { volt, amp },
        channels,
        written: out.display().to_string(),
    };
    json.give(&result, || print(&result, args, sensors.as_ref()))?;
    Ok(Finding::Nothing)
}

impl ChannelArgs {
    fn setup(&self, sensors: Option<&Sensors>) -> Result<Setup, Failure> {
        for (option, value) in [
            ("--true-volt", self.true_volt),
            ("--true-amp", self.true_amp),
        ] {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(Failure::Usage(format!(
                    "{option} {value} is no reading of a meter: write a root mean square above 0"
                )));
            }
        }
        if !(0.0..=100.0).contains(&self.load_us) {
            return Err(Failure::Usage(format!(
                "--load-us {} is outside 0..=100 us; a load with more is not resistive",
                self.load_us
            )));
        }
        Ok(Setup {
            true_volt: self.true_volt,
            true_amp: self.true_amp,
            load_time_constant_s: self.load_us * MICROSECOND,
            roll_off_s: sensors.map_or(0.0, |sensors| sensors.roll_off_s),
        })
    }
}

/// What was believed, corrected by what was found. The recordings were read with what was believed. The mean delay of the
/// currents stays: no recording of this kind shows it.
fn channels(found: &Found, sensors: Option<&Sensors>) -> Vec<ChannelJson> {
    let gains = sensors.map_or([1.0; 6], |s| joined(s.voltage_gain, s.current_gain));
    let delays = sensors.map_or([0.0; 6], |s| joined(s.voltage_delay_s, s.current_delay_s));
    let one = |(k, name): (usize, &&'static str)| {
        let (gain, delay) = (found.gain[k], found.delay_s[k]);
        let rotation = found.rotation_rad.map(|rotation| rotation[k]);
        let degrees = |of: fn(Estimate) -> f64| rotation.map(|one| of(one).to_degrees());
        ChannelJson {
            name,
            gain: gains[k] * gain.value,
            gain_std_error: (gains[k] * gain.error).abs(),
            delay_us: (delays[k] + delay.value) / MICROSECOND,
            delay_std_error_us: delay.error / MICROSECOND,
            rotation_deg: degrees(|one| one.value),
            rotation_std_error_deg: degrees(|one| one.error),
        }
    };
    NAMES.iter().enumerate().map(one).collect()
}

fn joined([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> [f64; 6] {
    [a, b, c, d, e, f]
}

/// What a motor file takes: -50 to 200 us.
fn check_ranges(channels: &[ChannelJson]) -> Result<(), Failure> {
    let outside = channels
        .iter()
        .find(|channel| !(-50.0..=200.0).contains(&channel.delay_us));
    match outside {
        None => Ok(()),
        Some(channel) => Err(Failure::Unsupported(format!(
            "not calibrated: the delay of {} would be {:.1} us, outside -50..=200 us; use a heater, and see whether its filter is the documented one",
            channel.name, channel.delay_us
        ))),
    }
}

/// Decimal places that a standard error of 1e-5 and of 0.01 us deserves.
fn rounded(channels: &[ChannelJson], of: fn(&ChannelJson) -> f64, places: i32) -> [[f64; 3]; 2] {
    let scale = 10_f64.powi(places);
    let number = |k: usize| (of(&channels[k]) * scale).round() / scale;
    [[0, 1, 2].map(number), [3, 4, 5].map(number)]
}

fn calibrated(channels: &[ChannelJson], sensors: &Sensors) -> Sensors {
    let [voltage_gain, current_gain] = rounded(channels, |one| one.gain, 6);
    let seconds = |delays: [f64; 3]| delays.map(|us| us * MICROSECOND);
    let [voltage_delay, current_delay] = rounded(channels, |one| one.delay_us, 3);
    Sensors {
        voltage_gain,
        current_gain,
        voltage_delay_s: seconds(voltage_delay),
        current_delay_s: seconds(current_delay),
        ..*sensors
    }
}

fn in_motor_file(path: &Path, motor: &MotorFile, channels: &[ChannelJson]) -> String {
    let old = std::fs::read_to_string(path).unwrap_or_default();
    let motor = MotorFile {
        sensors: calibrated(channels, &motor.sensors),
        ..motor.clone()
    };
    motor_text::updated(&old, &motor)
}

fn as_table(channels: &[ChannelJson]) -> String {
    let [voltage_gain, current_gain] = rounded(channels, |one| one.gain, 6);
    let [voltage_delay, current_delay] = rounded(channels, |one| one.delay_us, 3);
    format!(
        "# Written by `drivemon calibrate --channels`: this board's channels, for the motor file of any motor behind it.\n\
         [sensors]\nvoltage_gain = {voltage_gain:?}\ncurrent_gain = {current_gain:?}\n\
         voltage_delay_us = {voltage_delay:?}\ncurrent_delay_us = {current_delay:?}\n"
    )
}

fn print(result: &ChannelsJson, args: &ChannelArgs, sensors: Option<&Sensors>) {
    let hertz: Vec<String> = result
        .frequencies_hz
        .iter()
        .map(|hertz| format!("{hertz:.2} Hz"))
        .collect();
    let AmplitudeJson { volt, amp } = result.amplitude_rms;
    say!(
        "{}: one signal of {volt:.4} V and {amp:.4} A rms on all channels, {}, {} blocks of ten cycles\n",
        paint::strong(&result.recordings.join(", ")),
        hertz.join(" and "),
        result.blocks
    );
    say!(
        "  {:<8} {:>10} {:>12} {:>14} {:>10}",
        "channel",
        "gain",
        "+-",
        "delay, us",
        "+-"
    );
    for one in &result.channels {
        say!(
            "  {:<8} {:>10.6} {:>12.6} {:>14.3} {:>10.3}",
            one.name,
            one.gain,
            one.gain_std_error,
            one.delay_us,
            one.delay_std_error_us
        );
    }
    say!("");
    print_notes(result, args);
    print_small(result, sensors);
    say!("{} is written.", result.written);
}

fn print_notes(result: &ChannelsJson, args: &ChannelArgs) {
    let note = paint::faint("note:");
    say!(
        "  {note} a delay common to all channels cannot be seen, and changes nothing: the mean of the currents stays"
    );
    for (given, option, of) in [
        (args.true_volt, "--true-volt", "voltages"),
        (args.true_amp, "--true-amp", "currents"),
    ] {
        if given.is_none() {
            say!(
                "  {note} the mean gain of the {of} stays; {option} with a meter's reading sets it"
            );
        }
    }
    let rotations: Vec<_> = result
        .channels
        .iter()
        .filter_map(|one| Some((one.name, one.rotation_deg?, one.rotation_std_error_deg?)))
        .collect();
    if rotations.is_empty() {
        say!(
            "  {note} one frequency does not tell a delay from a rotation (a transformer's): record a second one, a fifth apart"
        );
    }
    for (name, rotation, error) in rotations {
        if rotation.abs() > (SURE * error).max(ROTATION_DEG) {
            say!(
                "  {} {name} is turned by {rotation:.2} +- {error:.2} degrees at every frequency: no delay, and not corrected; look for a transformer",
                paint::caution("rotation:")
            );
        }
    }
}

/// Non-linearity of a converter moves the gain of small signals: section "Currents" of docs/wiring.md.
fn print_small(result: &ChannelsJson, sensors: Option<&Sensors>) {
    let Some(sensors) = sensors else { return };
    let peak = std::f64::consts::SQRT_2;
    let AmplitudeJson { volt, amp } = result.amplitude_rms;
    let shares = [
        ("voltage", volt * peak / sensors.voltage_full_scale_volt),
        ("current", amp * peak / sensors.current_full_scale_amp),
    ];
    for (what, share) in shares {
        if share < SMALL {
            say!(
                "  {} the {what} reaches {:.0} % of full scale: a converter's non-linearity shows there; calibrate near half",
                paint::caution("small:"),
                100.0 * share
            );
        }
    }
}
