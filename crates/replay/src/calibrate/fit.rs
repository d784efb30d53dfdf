//! The parameters that make the monitor's own residuals vanish over all healthy windows.
//!
//! Gauss-Newton on the torque balance, `e_d` and `e_q`, with the very directions that the monitor isolates faults by:
//! what remains after it is what the lamps will see of the healthy motor. Winding and cage of each recording have a temperature of
//! their own, as the monitor lets them.

use monitor::{Cause, Evidence, Healthy, LoadKind, Monitor};
use motor::MotorFile;
use nalgebra::{DMatrix, DVector};

use super::warmth::Warmths;
use super::windows::Observed;
use super::{MonitorOf, Refusal};

/// What is fitted, with its prior standard deviation: of logarithms, and of the friction's coordinate (see [`Beliefs`]).
pub(super) const FITTED: [(Cause, f64); 5] = [
    (Cause::StatorResistance, 0.3),
    (Cause::RotorResistance, 0.3),
    (Cause::MagnetizingInductance, 0.15),
    (Cause::Leakage, 0.3),
    (Cause::Friction, 1.0),
];
/// Prior standard deviation of friction that is known, a share of it.
const FRICTION_PRIOR: f64 = 0.5;
/// Prior of an unknown friction, a share of rated torque at synchronous speed: bearings and a fan take 0.5 to 3 %.
const FRICTION_GUESS: f64 = 0.01;
/// Largest believable change of a parameter, a share of what is believed.
const LARGEST_CHANGE: f64 = 0.8;
/// Largest believable change of a guessed friction, in guesses.
const MOST_GUESSES: f64 = 5.0;
/// Least friction, a share of what is believed: a loss is no drive.
const LEAST_FRICTION: f64 = 0.1;
/// Rows of the positive sequence.
pub(super) const ROWS: usize = 3;
/// Least misfit that a row is credited with: the sensors' linearity.
const FLOOR: f64 = 5e-4;
const ITERATIONS: usize = 8;

/// The motor as believed, which its coordinates move: logarithms, but for the friction, which is often a guess and may be
/// wrong by several times. Its coordinate is a change in steps of its uncertainty.
pub(super) struct Beliefs<'a> {
    motor: &'a MotorFile,
    /// [`FRICTION_GUESS`] as a share of the friction that the residuals see.
    friction_guess: f64,
}

/// Parameters as fitted.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The motor with its new parameters.
    pub motor: MotorFile,
    /// The fitted coordinates: those of [`FITTED`], then those of `warmths`.
    pub(super) coordinates: Vec<f64>,
    /// Whose temperatures the last coordinates are.
    pub(super) warmths: Warmths,
    /// Change of each of [`Fitted::causes`], a share of the believed value.
    pub changes: Vec<f64>,
    /// How far each may be off, a share of the fitted value, seen through the instruments that it was fitted with: their
    /// gains are in it already.
    pub seen_through: Vec<f64>,
    /// Root mean square of what remains: torque balance, `e_d`, `e_q`.
    pub misfit: [f64; ROWS],
}

impl Fitted {
    /// What was fitted, in the order of `changes`.
    pub fn causes() -> impl Iterator<Item = Cause> {
        FITTED.iter().map(|(cause, _)| *cause)
    }

    /// The motor as warm as it was in a recording.
    pub(super) fn warmed(&self, recording: usize) -> MotorFile {
        let mut motor = self.motor.clone();
        let z = self.coordinates.get(FITTED.len()..).unwrap_or_default();
        let warmth = self.warmths.read(z, recording);
        warmth.applied(&mut motor.parameters);
        motor
    }
}

/// Fits; `monitor_of` gives the monitor for a recording's number.
///
/// # Errors
/// Parameters that the core does not take.
pub(super) fn fit(
    beliefs: &Beliefs<'_>,
    observed: &[Observed],
    monitor_of: &MonitorOf<'_>,
) -> Result<Fitted, Refusal> {
    let warmths = Warmths::of(observed);
    let priors = priors(&warmths);
    let n = priors.len();
    let mut z = DVector::<f64>::zeros(n);
    let mut misfit = [0.01; ROWS];
    let mut covariance = DMatrix::identity(n, n);
    for _ in 0..ITERATIONS {
        let motor_of = |k: usize| beliefs.warmed(z.as_slice(), &warmths, k);
        let evidence = evidence(&motor_of, observed, monitor_of)?;
        misfit = root_mean_square(&evidence, observed);
        let relative = beliefs.relative(z.as_slice());
        let along = |e: &Evidence, o: &Observed| directions(e, o, &relative, &warmths);
        let (step, posterior) = step(&evidence, observed, &misfit, &z, &along, &priors);
        z += &step;
        covariance = posterior;
        if step.amax() < 1e-6 {
            break;
        }
    }
    let coordinates = z.as_slice().to_vec();
    let relative = beliefs.relative(&coordinates);
    let error = |k: usize| relative[k] * covariance[(k, k)].max(0.0).sqrt();
    Ok(Fitted {
        motor: beliefs.changed(&coordinates),
        changes: beliefs.factors(&coordinates).map(|x| x - 1.0).to_vec(),
        seen_through: (0..FITTED.len()).map(error).collect(),
        coordinates,
        warmths,
        misfit,
    })
}

impl<'a> Beliefs<'a> {
    /// `monitor_of` as for [`fit`].
    pub(super) fn new(motor: &'a MotorFile, monitor_of: &MonitorOf<'_>) -> Result<Self, Refusal> {
        let (m, plate) = (&motor.mechanics, &motor.nameplate);
        let seen = match monitor_of(motor, 0)?.config().load {
            LoadKind::Friction => m.total_friction(),
            _ => m.friction,
        };
        let synchronous = plate.omega_sync() / f64::from(plate.pole_pairs);
        let guess = FRICTION_GUESS * plate.torque_nm / synchronous;
        Ok(Beliefs {
            motor,
            friction_guess: if seen > 0.0 { guess / seen } else { 0.0 },
        })
    }

    fn friction_step(&self) -> f64 {
        FRICTION_PRIOR.hypot(self.friction_guess)
    }

    /// Largest believable change of each quantity, a share of what is believed.
    pub(super) fn largest_changes(&self) -> [f64; FITTED.len()] {
        FITTED.map(|(cause, _)| match cause {
            Cause::Friction => LARGEST_CHANGE.max(MOST_GUESSES * self.friction_guess),
            _ => LARGEST_CHANGE,
        })
    }

    /// Ratio of each quantity to what is believed of it.
    fn factors(&self, z: &[f64]) -> [f64; FITTED.len()] {
        std::array::from_fn(|k| match FITTED[k].0 {
            Cause::Friction => (1.0 + self.friction_step() * z[k]).max(LEAST_FRICTION),
            _ => z[k].exp(),
        })
    }

    /// Relative change of each quantity per change of its coordinate.
    pub(super) fn relative(&self, z: &[f64]) -> [f64; FITTED.len()] {
        let factors = self.factors(z);
        std::array::from_fn(|k| match FITTED[k].0 {
            Cause::Friction => self.friction_step() / factors[k],
            _ => 1.0,
        })
    }

    /// The motor at these coordinates, as warm as in a recording.
    pub(super) fn warmed(&self, z: &[f64], warmths: &Warmths, recording: usize) -> MotorFile {
        let mut motor = self.changed(z);
        let warmth = warmths.read(&z[FITTED.len()..], recording);
        warmth.applied(&mut motor.parameters);
        motor
    }

    /// The motor at these coordinates, as warm as in the recording of the largest current.
    pub(super) fn changed(&self, z: &[f64]) -> MotorFile {
        let mut motor = self.motor.clone();
        let (p, m) = (&mut motor.parameters, &mut motor.mechanics);
        for ((cause, _), factor) in FITTED.iter().zip(self.factors(z)) {
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
}

/// The evidence of each window against the motor of its recording, about which nothing is known.
pub(super) fn evidence(
    motor_of: &dyn Fn(usize) -> MotorFile,
    observed: &[Observed],
    monitor_of: &MonitorOf<'_>,
) -> Result<Vec<Option<Evidence>>, Refusal> {
    let last = observed.iter().map(|o| o.recording).max().unwrap_or(0);
    let monitors = (0..=last).map(|k| monitor_of(&motor_of(k), k));
    let monitors = monitors.collect::<Result<Vec<Monitor>, _>>()?;
    let unknown = Healthy::unknown();
    let one = |o: &Observed| monitors[o.recording].evidence(&unknown, &o.window);
    Ok(observed.iter().map(one).collect())
}

/// Standard deviation of the prior of each coordinate.
pub(super) fn priors(warmths: &Warmths) -> Vec<f64> {
    let fitted = FITTED.iter().map(|(_, prior)| *prior);
    fitted.chain(warmths.priors()).collect()
}

/// How the rows of a window move per coordinate; `relative` as [`Beliefs::relative`].
fn directions(
    evidence: &Evidence,
    o: &Observed,
    relative: &[f64],
    warmths: &Warmths,
) -> Vec<DVector<f64>> {
    let fitted = FITTED.map(|(cause, _)| evidence.direction(cause));
    let resistances =
        [Cause::StatorResistance, Cause::RotorResistance].map(|cause| evidence.direction(cause));
    let of_row = |row: usize| {
        let at_row = |direction: [f32; monitor::ROWS]| f64::from(direction[row]);
        let fitted = fitted.iter().zip(relative);
        let fitted = fitted.map(|(direction, per)| at_row(*direction) * per);
        let resistances = resistances.map(at_row);
        let along: Vec<f64> = fitted
            .chain(warmths.directions(resistances, o.recording))
            .collect();
        DVector::from_vec(along)
    };
    (0..ROWS).map(of_row).collect()
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

/// How the rows of a window move per coordinate.
type Along<'a> = dyn Fn(&Evidence, &Observed) -> Vec<DVector<f64>> + 'a;

/// One step in the coordinates, and their posterior covariance; `along` gives [`directions`].
fn step(
    evidence: &[Option<Evidence>],
    observed: &[Observed],
    misfit: &[f64; ROWS],
    z: &DVector<f64>,
    along: &Along<'_>,
    priors: &[f64],
) -> (DVector<f64>, DMatrix<f64>) {
    let n = z.len();
    let mut normal = DMatrix::zeros(n, n);
    let mut right = DVector::zeros(n);
    for (k, prior) in priors.iter().enumerate() {
        normal[(k, k)] = 1.0 / (prior * prior);
        right[k] = -z[k] / (prior * prior);
    }
    for (evidence, o) in evidence.iter().zip(observed) {
        let Some(evidence) = evidence else { continue };
        let rows = along(evidence, o).into_iter().zip(misfit);
        for (row, (along, misfit)) in rows.enumerate() {
            let weight = o.weight / (misfit * misfit);
            right += &along * (weight * f64::from(evidence.departure[row]));
            normal += &along * along.transpose() * weight;
        }
    }
    // A prior on every parameter keeps the normal matrix positive definite.
    let covariance = normal.try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
    (&covariance * right, covariance)
}
