//! Learning from healthy recordings what a motor and its instrument look like when nothing is wrong.
//!
//! One after another: relative gains from the zero sequences, parameters from the monitor's own residuals, then the
//! statistics that decide how far a departure must go before FAULT lights.

mod fit;
mod gains;
mod losses;
mod negative;
mod pieces;
mod refuse;
mod rotor;
mod statistics;
mod uncertainty;
mod warmth;
mod windows;

use audit::Audit;
use monitor::{Cause, Healthy, Monitor, MonitorConfig};
use motor::InMotion;
use motor::MotorFile;
use motor::motor_file::HealthySettings;
use recording::Recording;

pub use gains::Kind;
pub use pieces::Pieces;
pub(crate) use statistics::COPPER_PER_KELVIN;
pub use statistics::Surroundings;

use crate::config_for;
use warmth::Warmths;
use windows::{Healthily, Observed};

/// Why recordings cannot calibrate a motor.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{recording}: {reason}")]
pub struct Refusal {
    /// The recording, or all of them.
    pub recording: String,
    /// Reason and remedy.
    pub reason: String,
}

impl Refusal {
    /// Of one recording, or of all of them.
    pub fn new(recording: &str, reason: impl Into<String>) -> Self {
        Refusal {
            recording: recording.to_owned(),
            reason: reason.into(),
        }
    }
}

/// A calibrated motor and how it was found.
#[derive(Clone, Debug)]
pub struct Calibrated {
    /// The motor with parameters, gains, statistics and thresholds.
    pub motor: MotorFile,
    /// Steady windows that it was learnt from.
    pub windows: usize,
    /// Audits of the recordings.
    pub audits: Vec<Audit>,
    /// Parameters: change, a share of the believed value, and standard error with that of the instruments, a share of the
    /// fitted value. Empty without voltages.
    pub changes: Vec<(Cause, f64, f64)>,
    /// Gains of the channels a, b, c that were found.
    pub gains: Vec<(Kind, [f64; 3])>,
    /// What remains of torque balance, `e_d`, `e_q`, percent of their scales.
    pub misfit_percent: [f64; 3],
    /// The statistics, as they stand in the motor file.
    pub healthy: HealthySettings,
}

/// The monitor of a motor for a recording's number.
type MonitorOf<'a> = dyn Fn(&MotorFile, usize) -> Result<Monitor, Refusal> + 'a;

fn configured(motor: &MotorFile, recording: &Recording) -> Result<MonitorConfig, Refusal> {
    config_for(motor, recording).map_err(|error| Refusal::new(&motor.name, error.to_string()))
}

fn monitor(motor: &MotorFile, config: MonitorConfig) -> Result<Monitor, Refusal> {
    Monitor::new(config).map_err(|error| Refusal::new(&motor.name, error.to_string()))
}

/// Calibrates `motor` from healthy recordings.
///
/// # Errors
/// Recordings that are faulty, contradict each other or say too little.
pub fn calibrate(
    motor: &MotorFile,
    recordings: &[Recording],
    surroundings: &Surroundings,
) -> Result<Calibrated, Refusal> {
    let recordings: Vec<&dyn Pieces> = recordings.iter().map(|one| one as &dyn Pieces).collect();
    calibrate_pieces(motor, &recordings, surroundings)
}

/// The same from recordings of any length, each of which is gone through several times.
///
/// # Errors
/// As [`calibrate`], and a recording that can be read no more.
pub fn calibrate_pieces(
    motor: &MotorFile,
    recordings: &[&dyn Pieces],
    surroundings: &Surroundings,
) -> Result<Calibrated, Refusal> {
    let mut believed = motor.clone();
    believed.healthy = None;
    let sources = windows::audited(recordings, &believed)?;
    let monitor_of = |motor: &MotorFile, k: usize| {
        let mut config = configured(motor, sources[k].head())?;
        config.healthy = Some(Healthy::unknown());
        monitor(motor, config)
    };
    let mut observed = windows::observe(&sources, &believed)?;
    let has_voltages = observed
        .iter()
        .all(|o| o.window.u_s.positive.norm_sqr() > 0.0);
    let mut gains = Vec::new();
    if has_voltages {
        for kind in [Kind::Current, Kind::Voltage] {
            correct_gains(
                kind,
                &sources,
                &mut believed,
                &mut observed,
                &mut gains,
                &monitor_of,
            )?;
        }
    }
    let (fitted, errors) = if has_voltages {
        let beliefs = fit::Beliefs::new(&believed, &monitor_of)?;
        let fitted = fit::fit(&beliefs, &observed, &monitor_of)?;
        refuse::implausible(&beliefs, &fitted, recordings)?;
        refuse::misfit(&fitted, recordings)?;
        let errors = uncertainty::standard_errors(&beliefs, &fitted, &observed, &monitor_of)?;
        (fitted, errors)
    } else {
        let nothing = fit::Fitted {
            motor: believed,
            coordinates: Vec::new(),
            warmths: Warmths::of(&observed),
            changes: Vec::new(),
            seen_through: Vec::new(),
            misfit: [0.0; 3],
        };
        (nothing, Vec::new())
    };
    let healthy = HealthySettings {
        rotor: rotor::healthy(&fitted.motor, &sources)?,
        ..statistics::healthy(&fitted, &observed, surroundings, &monitor_of)?
    };
    let mut motor = fitted.motor.clone();
    uncertainty::intervals_follow(&mut motor, &errors);
    motor.healthy = Some(healthy);
    if has_voltages {
        let monitor_of =
            |motor: &MotorFile, k: usize| monitor(motor, configured(motor, sources[k].head())?);
        motor.monitor.threshold_percent = statistics::thresholds(&motor, &observed, &monitor_of)?;
    }
    refuse::contradictions(&motor, &sources, &observed)?;
    let healthy = HealthySettings {
        in_motion: in_motion(&motor, &sources)?,
        ..healthy
    };
    motor.healthy = Some(healthy);
    Ok(Calibrated {
        motor,
        windows: observed.len(),
        audits: sources.into_iter().map(|source| source.audit).collect(),
        changes: fit::Fitted::causes()
            .zip(fitted.changes.iter().zip(errors))
            .map(|(cause, (change, error))| (cause, *change, error))
            .collect(),
        gains,
        misfit_percent: fitted.misfit.map(|x| 100.0 * x),
        healthy,
    })
}

/// Fewest windows in motion that show how a motor moves.
const SEEN_IN_MOTION: u64 = 20;

/// How the motor in good order moved: what judges in motion would call a lacking effect a fault, now and later.
fn in_motion(motor: &MotorFile, sources: &[Healthily<'_>]) -> Result<InMotion, Refusal> {
    let (mut seen, mut differs) = (0, false);
    for source in sources {
        let mut config = configured(motor, source.head())?;
        if let Some(healthy) = &mut config.healthy {
            // What an earlier calibration found is not what is asked.
            healthy.in_motion = InMotion::Fits;
        }
        let motion = source.replayed(config)?.motion;
        seen += motion.judged;
        differs |= !motion.alarms.is_empty() || !motion.unexplained.is_empty();
    }
    Ok(match differs {
        true => InMotion::Differs,
        false if seen >= SEEN_IN_MOTION => InMotion::Fits,
        false => InMotion::Unseen,
    })
}

/// Takes over the gains that the zero sequence implies, if the negative sequence balances better with them: a zero
/// sequence of the supply itself would make it worse.
fn correct_gains(
    kind: Kind,
    sources: &[Healthily<'_>],
    motor: &mut MotorFile,
    observed: &mut Vec<Observed>,
    found: &mut Vec<(Kind, [f64; 3])>,
    monitor_of: &MonitorOf<'_>,
) -> Result<(), Refusal> {
    let gains = gains::from_zero_sequence(gains::zero_ratio(observed, kind));
    let Some(corrected) = gains::with_gains(motor, kind, gains) else {
        return Ok(());
    };
    let again = windows::observe(sources, &corrected)?;
    let before = refuse::negative_scatter(motor, observed, monitor_of);
    let after = refuse::negative_scatter(&corrected, &again, monitor_of);
    // Currents on three wires have no zero sequence of their own.
    if kind == Kind::Current || after < before {
        *motor = corrected;
        *observed = again;
        found.push((kind, gains));
    }
    Ok(())
}
