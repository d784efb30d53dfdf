//! The parameters that make the monitor's own residuals vanish over all healthy windows.
//!
//! Gauss-Newton on the torque balance, `e_d` and `e_q`, with the very directions that the monitor isolates faults by:
//! what remains after it is what the lamps will see of the healthy motor.

use monitor::{Cause, Evidence, Healthy, Monitor, MonitorConfig};
use motor::MotorFile;
use nalgebra::{DMatrix, DVector};

use super::Refusal;
use super::windows::Observed;

/// What is fitted, with its prior standard deviation as a share of the believed value.
const FITTED: [(Cause, f64); 5] = [
    (Cause::StatorResistance, 0.3),
    (Cause::RotorResistance, 0.3),
    (Cause::MagnetizingInductance, 0.15),
    (Cause::Leakage, 0.3),
    (Cause::Friction, 0.5),
];
/// Rows of the positive sequence.
const ROWS: usize = 3;
/// Least misfit that a row is credited with: the sensors' linearity.
const FLOOR: f64 = 5e-4;
const ITERATIONS: usize = 8;

/// Parameters as fitted.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The motor with its new parameters.
    pub motor: MotorFile,
    /// Change of each of [`Fitted::causes`] and its standard error, as shares of the believed value.
    pub changes: Vec<(f64, f64)>,
    /// Root mean square of what remains: torque balance, `e_d`, `e_q`.
    pub misfit: [f64; ROWS],
}

impl Fitted {
    /// What was fitted, in the order of `changes`.
    pub fn causes() -> impl Iterator<Item = Cause> {
        FITTED.iter().map(|(cause, _)| *cause)
    }
}

/// Fits; `config_of` gives the monitor's configuration for a recording's number.
///
/// # Errors
/// Parameters that the core does not take.
pub fn fit(
    believed: &MotorFile,
    observed: &[Observed],
    config_of: &dyn Fn(&MotorFile, usize) -> MonitorConfig,
) -> Result<Fitted, Refusal> {
    let mut logs = DVector::<f64>::zeros(FITTED.len());
    let mut misfit = [0.01; ROWS];
    let mut covariance = DMatrix::identity(FITTED.len(), FITTED.len());
    for _ in 0..ITERATIONS {
        let motor = changed(believed, logs.as_slice());
        let evidence = evidence(&motor, observed, config_of)?;
        misfit = root_mean_square(&evidence, observed);
        let (step, posterior) = step(&evidence, observed, &misfit, &logs);
        logs += &step;
        covariance = posterior;
        if step.amax() < 1e-6 {
            break;
        }
    }
    let error = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    let changes = logs
        .iter()
        .enumerate()
        .map(|(k, log)| (log.exp() - 1.0, error(k)));
    Ok(Fitted {
        motor: changed(believed, logs.as_slice()),
        changes: changes.collect(),
        misfit,
    })
}

/// The evidence of each window against a motor about which nothing is known.
fn evidence(
    motor: &MotorFile,
    observed: &[Observed],
    config_of: &dyn Fn(&MotorFile, usize) -> MonitorConfig,
) -> Result<Vec<Option<Evidence>>, Refusal> {
    let last = observed.iter().map(|o| o.recording).max().unwrap_or(0);
    let monitors = (0..=last).map(|k| Monitor::new(config_of(motor, k)));
    let monitors: Result<Vec<Monitor>, _> = monitors.collect();
    let monitors = monitors.map_err(|error| Refusal::new(&motor.name, error.to_string()))?;
    let unknown = Healthy::unknown();
    let one = |o: &Observed| monitors[o.recording].evidence(&unknown, &o.window);
    Ok(observed.iter().map(one).collect())
}

fn root_mean_square(evidence: &[Option<Evidence>], observed: &[Observed]) -> [f64; ROWS] {
    let mut sum = [0.0; ROWS];
    let mut votes = 0.0;
    for (evidence, o) in evidence.iter().zip(observed) {
        let Some(evidence) = evidence else { continue };
        votes += o.weight;
        for (sum, y) in sum.iter_mut().zip(evidence.departure) {
            *sum += o.weight * f64::from(y) * f64::from(y);
        }
    }
    sum.map(|sum| (sum / votes.max(f64::MIN_POSITIVE)).sqrt().max(FLOOR))
}

/// One step in the logarithms of the parameters, and their posterior covariance.
fn step(
    evidence: &[Option<Evidence>],
    observed: &[Observed],
    misfit: &[f64; ROWS],
    logs: &DVector<f64>,
) -> (DVector<f64>, DMatrix<f64>) {
    let n = FITTED.len();
    let mut normal = DMatrix::zeros(n, n);
    let mut right = DVector::zeros(n);
    for (k, (_, prior)) in FITTED.iter().enumerate() {
        normal[(k, k)] = 1.0 / (prior * prior);
        right[k] = -logs[k] / (prior * prior);
    }
    for (evidence, o) in evidence.iter().zip(observed) {
        let Some(evidence) = evidence else { continue };
        let directions = FITTED.map(|(cause, _)| evidence.direction(cause));
        for (row, misfit) in misfit.iter().enumerate() {
            let weight = o.weight / (misfit * misfit);
            let along = DVector::from_iterator(n, directions.iter().map(|d| f64::from(d[row])));
            right += &along * (weight * f64::from(evidence.departure[row]));
            normal += &along * along.transpose() * weight;
        }
    }
    // A prior on every parameter keeps the normal matrix positive definite.
    let covariance = normal.try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
    (&covariance * right, covariance)
}

/// The motor with its parameters changed by these logarithms.
fn changed(believed: &MotorFile, logs: &[f64]) -> MotorFile {
    let mut motor = believed.clone();
    let (p, m) = (&mut motor.parameters, &mut motor.mechanics);
    for ((cause, _), log) in FITTED.iter().zip(logs) {
        let factor = log.exp();
        match cause {
            Cause::StatorResistance => p.r_s *= factor,
            Cause::RotorResistance => p.r_r *= factor,
            Cause::MagnetizingInductance => p.l_m *= factor,
            Cause::Leakage => {
                p.l_ls *= factor;
                p.l_lr *= factor;
            }
            _ => {
                m.friction *= factor;
                m.load_friction *= factor;
            }
        }
    }
    motor
}
