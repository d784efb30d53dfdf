//! How far the fitted parameters may be off: noise, priors and the gains of the instruments together.
//!
//! The fit takes the instruments as they are, so that what remains is what the lamps will see through the same instruments.
//! A gain that is off by its class is then in the parameters: `s = H^-1 J' W g` for the change `g` of the residuals per
//! gain. With the covariance of noise and beliefs, the covariance is `H^-1 (J' W J + P S P) H^-1 + sum sigma^2 s s'`.

use discovery::instrument_class::{CHANNEL_GAIN, SPEED_GAIN, TORQUE_GAIN};
use monitor::{Cause, Window};
use motor::MotorFile;
use nalgebra::{DMatrix, DVector, SVector};

use super::fit::{Beliefs, FITTED, Fitted, ROWS, evidence, priors};
use super::windows::Observed;
use super::{MonitorOf, Refusal};

const N: usize = FITTED.len();
/// Step of a coordinate or a gain: large against single precision (1e-6), small against the curvature of a residual.
const STEP: f64 = 0.01;
/// Standard deviations of the beliefs in the fit's first coordinates: data sheets are right within a tenth. Those of temperatures are the priors.
const BELIEVED: [f64; N] = [0.1, 0.1, 0.1, 0.1, 1.0];

/// Residuals of one window; `None` where it says nothing.
type Residual = Option<SVector<f64, ROWS>>;

/// A way in which all channels of a kind are off together.
#[derive(Clone, Copy)]
struct Instrument {
    /// Standard deviation of the gain that the positive sequence sees.
    deviation: f64,
    scaled: fn(&Window, f32) -> Window,
}

/// Three channels whose gains are off by themselves move the positive sequence by the mean of the three.
fn instruments() -> [Instrument; 4] {
    let of_three = CHANNEL_GAIN / 3f64.sqrt();
    let instrument = |deviation, scaled| Instrument { deviation, scaled };
    [
        instrument(of_three, |w, gain| {
            let mut w = *w;
            w.u_s.positive *= gain;
            w
        }),
        instrument(of_three, |w, gain| {
            let mut w = *w;
            w.i_s.positive *= gain;
            w
        }),
        instrument(SPEED_GAIN, |w, gain| Window {
            omega_mech: w.omega_mech.map(|omega| gain * omega),
            ..*w
        }),
        instrument(TORQUE_GAIN, |w, gain| Window {
            tau_load: w.tau_load.map(|tau| gain * tau),
            ..*w
        }),
    ]
}

/// Standard error of each of [`Fitted::causes`], a share of the fitted value.
///
/// # Errors
/// Parameters that the core does not take.
pub fn standard_errors(
    beliefs: &Beliefs<'_>,
    fitted: &Fitted,
    observed: &[Observed],
    monitor_of: &MonitorOf<'_>,
) -> Result<Vec<f64>, Refusal> {
    let at = |z: &[f64], observed: &[Observed]| {
        let motor_of = |k: usize| beliefs.warmed(z, &fitted.warmths, k);
        let evidence = evidence(&motor_of, observed, monitor_of)?;
        let rows = |e: &monitor::Evidence| SVector::from_fn(|row, _| f64::from(e.departure[row]));
        Ok::<Vec<Residual>, Refusal>(evidence.iter().map(|e| e.as_ref().map(rows)).collect())
    };
    let here = at(&fitted.coordinates, observed)?;
    let quotient = |there: Vec<Residual>| {
        let one = |(there, here): (Residual, &Residual)| Some((there? - (*here)?) / STEP);
        there.into_iter().zip(&here).map(one).collect()
    };
    let mut parameters: Vec<Vec<Residual>> = Vec::new();
    for k in 0..fitted.coordinates.len() {
        let mut there = fitted.coordinates.clone();
        there[k] += STEP;
        parameters.push(quotient(at(&there, observed)?));
    }
    let mut gains: Vec<(f64, Vec<Residual>)> = Vec::new();
    for instrument in instruments() {
        let scaled = |o: &Observed| Observed {
            window: (instrument.scaled)(&o.window, (1.0 + STEP) as f32),
            ..*o
        };
        let scaled: Vec<Observed> = observed.iter().map(scaled).collect();
        gains.push((
            instrument.deviation,
            quotient(at(&fitted.coordinates, &scaled)?),
        ));
    }
    let covariance = covariance(&parameters, &gains, observed, fitted);
    let relative = beliefs.relative(&fitted.coordinates);
    let error = |k: usize| relative[k] * covariance[(k, k)].max(0.0).sqrt();
    Ok((0..N).map(error).collect())
}

/// The motor's intervals where the fit has left them: of values that the file did not foresee.
pub fn intervals_follow(motor: &mut MotorFile, errors: &[f64]) {
    let p = motor.parameters;
    let Some(uncertainty) = &mut motor.uncertainty else {
        return;
    };
    for (cause, error) in Fitted::causes().zip(errors) {
        let values: &[(&str, f64)] = match cause {
            Cause::StatorResistance => &[("stator_resistance_ohm", p.r_s)],
            Cause::RotorResistance => &[("rotor_resistance_ohm", p.r_r)],
            Cause::MagnetizingInductance => &[("magnetizing_inductance_henry", p.l_m)],
            Cause::Leakage => &[
                ("stator_leakage_henry", p.l_ls),
                ("rotor_leakage_henry", p.l_lr),
            ],
            _ => &[],
        };
        for (key, value) in values {
            uncertainty.replace_outside(key, *value, *error);
        }
    }
}

fn covariance(
    parameters: &[Vec<Residual>],
    gains: &[(f64, Vec<Residual>)],
    observed: &[Observed],
    fitted: &Fitted,
) -> DMatrix<f64> {
    let n = parameters.len();
    let inner = |a: &[Residual], b: &[Residual]| -> f64 {
        let one = |((a, b), o): ((&Residual, &Residual), &Observed)| {
            let product = a.as_ref()?.component_mul(b.as_ref()?);
            let rows = product.iter().zip(&fitted.misfit).map(|(x, s)| x / (s * s));
            Some(o.weight * rows.sum::<f64>())
        };
        a.iter().zip(b).zip(observed).filter_map(one).sum()
    };
    let data = DMatrix::from_fn(n, n, |j, k| inner(&parameters[j], &parameters[k]));
    let priors = priors(&fitted.warmths);
    let prior = DVector::from_fn(n, |k, _| priors[k].powi(-2));
    let believed = |k: usize| BELIEVED.get(k).copied().unwrap_or(priors[k]);
    let beliefs = DVector::from_fn(n, |k, _| (prior[k] * believed(k)).powi(2));
    let curvature = &data + DMatrix::from_diagonal(&prior);
    let mut scores = data + DMatrix::from_diagonal(&beliefs);
    for (deviation, moved) in gains {
        let score = DVector::from_fn(n, |k, _| inner(&parameters[k], moved));
        scores += &score * score.transpose() * deviation.powi(2);
    }
    // A prior on every parameter keeps the curvature positive definite.
    let inverse = curvature
        .try_inverse()
        .unwrap_or_else(|| DMatrix::zeros(n, n));
    &inverse * scores * &inverse
}
