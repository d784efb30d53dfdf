//! A healthy motor, learnt.

use std::ops::RangeInclusive;

use audit::Audit;
use monitor::Cause;
use motor::InMotion;
use motor::MotorFile;
use motor::motor_file::HealthySettings;
use recording::Recording;
use replay::calibrate::{Calibrated, Kind, Pieces, Refusal, Surroundings, calibrate_pieces};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

/// FAULT lamps per judged window that may be accepted on a healthy motor.
pub const FALSE_ALARM_RATES: RangeInclusive<f64> = 1e-12..=0.01;
/// How much warmer or colder than in the recordings the windings may become, K.
pub const WINDING_KELVINS: RangeInclusive<f64> = 0.0..=200.0;

/// Everything that a calibration says.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Calibration {
    /// The recordings.
    pub recordings: Vec<String>,
    /// The motor's name.
    pub motor: String,
    /// What the audit of each recording found.
    pub audits: Vec<Audit>,
    /// Steady windows that were used.
    pub windows: usize,
    /// Parameters before and after; empty where currents alone were recorded.
    pub parameters: Vec<CalibratedParameter>,
    /// Gains of the channels.
    pub gains: Vec<ChannelGains>,
    /// What remains after the fit.
    pub misfit_percent: MisfitPercent,
    /// Thresholds of r1 to r4, percent of their scales.
    pub threshold_percent: [f64; 4],
    /// FAULT lamps per judged window that are accepted on a healthy motor.
    pub false_alarm_rate: f64,
    /// Statistics of the healthy motor.
    pub healthy: HealthyStatistics,
    /// The motor file that was written.
    pub motor_file: String,
}

/// One parameter before and after.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CalibratedParameter {
    /// Its key in the motor file.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Value before, in its unit.
    pub believed: f64,
    /// Value after.
    pub value: f64,
    /// Standard error of the value.
    pub std_error: f64,
    /// By how much it changed, percent.
    pub change_percent: f64,
}

/// Gains of three channels.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ChannelGains {
    /// The effect that holds them.
    pub effect: &'static str,
    /// Gains of phases a, b, c.
    pub gain: [f64; 3],
}

/// What remains after the fit, percent of each scale.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct MisfitPercent {
    /// Torque balance.
    pub torque: f64,
    /// Voltage balance, d axis.
    pub e_d: f64,
    /// Voltage balance, q axis.
    pub e_q: f64,
}

/// What is normal.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct HealthyStatistics {
    /// Standard deviations beyond which FAULT lights.
    pub significance: f64,
    /// Scatter of the nine components of a window, percent of their scales.
    pub scatter_percent: [f64; 9],
    /// Their means.
    pub mean_percent: [f64; 9],
    /// Negative over positive sequence of the currents, real and imaginary part, percent.
    pub i2_over_i1_percent: [f64; 2],
    /// Its scatter, percent.
    pub i2_over_i1_scatter_percent: f64,
    /// How far the stator resistance may be off as FAULT sees it, percent: large where the recordings' loads are too few
    /// or too alike; what is believed where currents alone were recorded.
    pub stator_resistance_percent: f64,
    /// Sidebands of the cage at a light and at a heavy load; absent where the recordings show too few blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotor: Option<HealthyCage>,
    /// Where the recordings lie; beyond, less is known. Absent without voltages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<CalibrationRange>,
    /// How the motor in good order moved, beside how its file says: `fits`, `differs` (it is not judged in motion), or `unseen`.
    #[serde(serialize_with = "by_word")]
    #[schemars(with = "String")]
    pub in_motion: InMotion,
}

/// Where the windows of a calibration lie, percent of the rated values.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct CalibrationRange {
    /// Largest positive-sequence current.
    pub current_percent: f64,
    /// Smallest and largest voltage over frequency.
    pub volt_per_hertz_percent: [f64; 2],
    /// Lowest and highest supply frequency.
    pub frequency_percent: [f64; 2],
    /// Smallest active current; below 0 the motor fed it back.
    pub active_percent: f64,
}

/// The healthy cage, percent of the active current; loads in percent of the rated current.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
pub struct HealthyCage {
    /// The light and the heavy load.
    pub active_percent: [f64; 2],
    /// Sideband at each.
    pub sideband_percent: [f64; 2],
    /// Scatter of the sideband.
    pub scatter_percent: f64,
}

impl Calibration {
    /// Learns a motor from recordings of it in good order; the motor as it is known then comes with it. `motor_file` is the
    /// caller's to fill in.
    ///
    /// # Errors
    /// Why nothing could be learnt: the reason names the recording.
    pub fn new(
        names: Vec<String>,
        recordings: &[Recording],
        believed: &MotorFile,
        surroundings: &Surroundings,
    ) -> Result<(Calibration, MotorFile), Refusal> {
        let recordings: Vec<&dyn Pieces> =
            recordings.iter().map(|one| one as &dyn Pieces).collect();
        Calibration::of_pieces(names, &recordings, believed, surroundings)
    }

    /// The same from recordings of any length, each of which is gone through several times.
    ///
    /// # Errors
    /// As [`Calibration::new`], and a recording that can be read no more.
    pub fn of_pieces(
        names: Vec<String>,
        recordings: &[&dyn Pieces],
        believed: &MotorFile,
        surroundings: &Surroundings,
    ) -> Result<(Calibration, MotorFile), Refusal> {
        let calibrated = calibrate_pieces(believed, recordings, surroundings)?;
        let [torque, e_d, e_q] = calibrated.misfit_percent;
        let gain = |(kind, gain): &(Kind, [f64; 3])| ChannelGains {
            effect: kind.effect().map_or("", |effect| effect.name),
            gain: *gain,
        };
        let result = Calibration {
            recordings: names,
            motor: believed.name.clone(),
            windows: calibrated.windows,
            parameters: parameters(believed, &calibrated),
            gains: calibrated.gains.iter().map(gain).collect(),
            misfit_percent: MisfitPercent { torque, e_d, e_q },
            threshold_percent: calibrated.motor.monitor.threshold_percent,
            false_alarm_rate: surroundings.false_alarm_rate,
            healthy: healthy(&calibrated.healthy),
            audits: calibrated.audits,
            motor_file: String::new(),
        };
        Ok((result, calibrated.motor))
    }
}

fn by_word<S: Serializer>(seen: &InMotion, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(seen.word())
}

fn healthy(settings: &HealthySettings) -> HealthyStatistics {
    HealthyStatistics {
        significance: settings.significance,
        scatter_percent: settings.scatter_percent,
        mean_percent: settings.mean_percent,
        i2_over_i1_percent: settings.current_unbalance_percent,
        i2_over_i1_scatter_percent: settings.current_unbalance_scatter_percent,
        stator_resistance_percent: settings.stator_resistance_percent,
        rotor: settings.rotor.map(|rotor| HealthyCage {
            active_percent: rotor.active_percent,
            sideband_percent: rotor.sideband_percent,
            scatter_percent: rotor.scatter_percent,
        }),
        range: settings.range.map(|range| CalibrationRange {
            current_percent: range.current_percent,
            volt_per_hertz_percent: range.volt_per_hertz_percent,
            frequency_percent: range.frequency_percent,
            active_percent: range.active_percent,
        }),
        in_motion: settings.in_motion,
    }
}

fn parameters(believed: &MotorFile, calibrated: &Calibrated) -> Vec<CalibratedParameter> {
    let row = |(cause, change, error): &(Cause, f64, f64)| {
        let (p, m) = (&believed.parameters, &believed.mechanics);
        let (name, unit, value) = match cause {
            Cause::StatorResistance => ("stator_resistance_ohm", "ohm", p.r_s),
            Cause::RotorResistance => ("rotor_resistance_ohm", "ohm", p.r_r),
            Cause::MagnetizingInductance => ("magnetizing_inductance_henry", "H", p.l_m),
            Cause::Leakage => ("stator_leakage_henry", "H", p.l_ls),
            _ => ("friction_nm_s", "N m s", m.total_friction()),
        };
        CalibratedParameter {
            name,
            unit,
            believed: value,
            value: value * (1.0 + change),
            std_error: value * (1.0 + change) * error,
            change_percent: 100.0 * change,
        }
    };
    let changes = calibrated.changes.iter();
    changes.map(row).filter(|row| row.believed > 0.0).collect()
}
