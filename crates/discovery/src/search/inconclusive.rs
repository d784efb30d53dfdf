//! What cannot be concluded while the scale of the speed is a free parameter.
//!
//! Nothing here knows which parameters depend on the slip: the derivatives of the fit tell. A parameter has the standard
//! error that it would have beside a known scale, and how far it moves with the scale times the scale's own.

use crate::report::types::Inconclusive;
use crate::search::screen::Screened;
use estimation::data::study::{Study, Trial};
use estimation::fit::normal_equations;
use estimation::fit::output_error::{Fit, INFLATION};
use estimation::model::prior::{FRICTION, N_NOMINAL, NOMINALS, Prior};
use estimation::model::scale_report::ErrorSource;
use estimation::model::speed_gain::name;
use estimation::proof::accept::adequate;
use estimation::proof::off::{RELEVANT, RELEVANT_FRICTION, SIGNIFICANT};
use nalgebra::{DMatrix, DVector};

/// Growth of a standard error by the free scale from which the scale is to blame.
const WIDENED: f64 = 2.0;
/// Slip below which the motor runs.
const RUNNING: f64 = 0.2;
/// Fraction of the running blocks whose slip the largest one may exceed: load steps pass through more.
const LARGEST: f64 = 0.9;

/// Prior standard deviation of a nominal: a factor of e, because the question is what the recording tells, not what was
/// believed before.
const WEAK: f64 = 1.0;

/// Standard errors of the coordinates of a fit: with the scale of the speed known, and what the scale adds.
pub(crate) struct Uncertainty {
    /// Covariance of the other coordinates when the scale is known.
    known: DMatrix<f64>,
    /// How far each of them moves when the scale moves by one, all refitted.
    moves: DVector<f64>,
    /// Standard error of the scale, in its coordinate.
    scale: f64,
    /// Whether the recording tells it.
    told: bool,
    /// The other coordinates.
    others: Vec<usize>,
    /// One of the scale's coordinate as a share of the speed.
    unit: f64,
}

impl Uncertainty {
    /// From the derivatives of a fit: so many rows as errors go together count as one.
    ///
    /// A model that explains the recording knows the scale as well as the recording tells. The standard error of one that
    /// does not is no knowledge: then the scale is as uncertain as physics leaves it, the reading of least slip
    /// somewhere between no load and rated load.
    pub fn of(study: &Study, trial: &Trial) -> Self {
        let fit = &trial.fit;
        let unit = fit.hypothesis.parameter(N_NOMINAL).typical;
        let rated = &study.prior.plant.rated;
        let rest = study
            .speed_scale
            .map_or(0.0, |scale| scale.error_of_rest(rated));
        let physical = rated_slip(&study.prior) / 12f64.sqrt() / unit;
        let precision = precision(study, fit, physical);
        let at = fit.free.iter().position(|&k| k == N_NOMINAL).unwrap_or(0);
        let cross = precision.column(at).into_owned().remove_row(at);
        let known = precision.clone().remove_row(at).remove_column(at);
        let n = known.nrows();
        let known = known.try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n));
        let moves = -(&known * &cross);
        let left = precision[(at, at)] + cross.dot(&moves);
        let told = adequate(study, trial);
        Self {
            known,
            moves,
            scale: match told {
                true => left.max(f64::MIN_POSITIVE).sqrt().recip(),
                false => physical,
            }
            .hypot(rest / unit),
            told,
            others: fit
                .free
                .iter()
                .copied()
                .filter(|&k| k != N_NOMINAL)
                .collect(),
            unit,
        }
    }

    /// Standard error of coordinate `k` with the scale known, and what the free scale adds to it (signed); zero if it
    /// was not fitted.
    fn of_coordinate(&self, k: usize) -> [f64; 2] {
        let Some(p) = self.others.iter().position(|&other| other == k) else {
            return [0.0; 2];
        };
        let known = self.known[(p, p)].max(0.0).sqrt();
        [known, self.moves[p] * self.scale]
    }

    /// Relative standard error of the scale.
    fn of_scale(&self) -> f64 {
        self.scale * self.unit
    }

    /// Where that comes from.
    fn source(&self) -> ErrorSource {
        match self.told {
            true => ErrorSource::Recording,
            false => ErrorSource::Physics,
        }
    }

    /// Standard error of the scale, a share of it, and where that error comes from.
    pub fn of_scale_and_source(&self) -> (f64, ErrorSource) {
        (self.of_scale(), self.source())
    }
}

/// Slip at rated torque and flux by the believed parameters, small against one.
fn rated_slip(prior: &Prior) -> f64 {
    let (plant, rated) = (&prior.plant, &prior.plant.rated);
    let power = 1.5 * rated.n_p * rated.flux().powi(2) * rated.omega_sync;
    rated.torque * plant.motor.r_r / power
}

fn precision(study: &Study, fit: &Fit, physical: f64) -> DMatrix<f64> {
    let nominals = fit.free.iter().filter(|&&k| k < N_NOMINAL).count();
    let inflation =
        normal_equations::score_inflation(&fit.blocks, nominals).clamp(INFLATION[0], INFLATION[1]);
    let weight = |&k: &usize| {
        let sd = match k {
            FRICTION => study.prior.deviations[FRICTION],
            0..N_NOMINAL => WEAK,
            N_NOMINAL => physical,
            _ => fit.hypothesis.prior_of(k, &study.prior).0,
        };
        sd.powi(-2)
    };
    let weights: Vec<f64> = fit.free.iter().map(weight).collect();
    normal_equations::total(&fit.blocks).gram / inflation + DMatrix::from_diagonal(&weights.into())
}

/// Everything that the free scale leaves open; `screened` effects are asked whether they could still be seen.
pub(crate) fn list(study: &Study, trial: &Trial, screened: &[Screened]) -> Vec<Inconclusive> {
    if study.speed_scale.is_none() {
        return Vec::new();
    }
    let uncertainty = Uncertainty::of(study, trial);
    let parameters = (0..N_NOMINAL).filter_map(|k| parameter(&uncertainty, k));
    let mut all: Vec<Inconclusive> = parameters.collect();
    all.extend(slip(study, trial, uncertainty.of_scale()));
    all.push(sensor());
    all.extend(effects(study, screened));
    all
}

fn parameter(uncertainty: &Uncertainty, k: usize) -> Option<Inconclusive> {
    let [known, added] = uncertainty.of_coordinate(k);
    let error = known.hypot(added);
    let correlation = added / error.max(f64::MIN_POSITIVE);
    let (relevant, unit) = match k {
        FRICTION => (RELEVANT_FRICTION, 1.0),
        _ => (RELEVANT, 100.0),
    };
    let open = error > WIDENED * known && SIGNIFICANT * error > relevant;
    let of = if k == FRICTION {
        "% of rated torque"
    } else {
        "%"
    };
    open.then(|| Inconclusive {
        name: NOMINALS[k].name.to_owned(),
        kind: "parameter".to_owned(),
        std_error_percent: Some(unit * error),
        std_error_with_known_scale_percent: Some(unit * known),
        correlation_with_scale: Some(correlation),
        why: match error < 1.0 || k == FRICTION {
            true => format!(
                "known to {:.1} {of} only; beside a known scale it would be {:.1} {of} (correlation {correlation:+.2})",
                unit * error,
                unit * known
            ),
            false => format!(
                "not known at all; beside a known scale it would be to {:.1} {of} (correlation {correlation:+.2})",
                unit * known
            ),
        },
    })
}

/// The largest slip of steady running, as far as the scale leaves it open.
fn slip(study: &Study, trial: &Trial, scale_error: f64) -> Option<Inconclusive> {
    let plant = trial.fit.hypothesis.plant(&study.prior);
    let case = study.fitted.case.waveform()?.as_seen_by(&plant);
    let stride = case.samples_per_row();
    let of_row = |row: usize| {
        let k = (row * stride).min(case.speed.len() - 1);
        1.0 - plant.mechanics.n_p * case.speed[k] / case.timeline.omega_sync[k]
    };
    let of_block = |rows: std::ops::Range<usize>| {
        let n = rows.len() as f64;
        rows.map(of_row).sum::<f64>() / n
    };
    let blocks = case.blocks().into_iter();
    let mut slips: Vec<f64> = blocks.map(of_block).filter(|s| s.abs() < RUNNING).collect();
    slips.sort_by(f64::total_cmp);
    let slip = *slips.get((LARGEST * (slips.len().max(1) - 1) as f64) as usize)?;
    let error = (1.0 - slip) * scale_error;
    let percent = 100.0 * (error / slip).abs();
    (SIGNIFICANT * percent > 100.0 * RELEVANT).then(|| Inconclusive {
        name: "slip".to_owned(),
        kind: "quantity".to_owned(),
        std_error_percent: Some(percent),
        std_error_with_known_scale_percent: Some(0.0),
        correlation_with_scale: None,
        why: format!(
            "the largest slip is {:.2} +- {:.2} %, and with it the loss in the rotor's bars",
            100.0 * slip,
            100.0 * error
        ),
    })
}

/// The sensor itself: what is fitted cannot be judged too.
fn sensor() -> Inconclusive {
    Inconclusive {
        name: name().to_owned(),
        kind: "effect".to_owned(),
        std_error_percent: None,
        std_error_with_known_scale_percent: None,
        correlation_with_scale: None,
        why: "an error of the sensor's gain is part of the fitted scale".to_owned(),
    }
}

/// Effects that a known scale would show and the free one hides.
fn effects(study: &Study, screened: &[Screened]) -> Vec<Inconclusive> {
    let mut best = std::collections::BTreeMap::<&str, [f64; 2]>::new();
    for s in screened {
        let known = s.visible_with_known_scale.unwrap_or(s.visible);
        let seen = [s.visible, known].map(|x| study.visibility(x));
        let entry = best.entry(s.config.effect.descriptor().name).or_default();
        *entry = [entry[0].max(seen[0]), entry[1].max(seen[1])];
    }
    let hidden = |[free, known]: &[f64; 2]| *free < Study::VISIBLE && *known >= Study::VISIBLE;
    let hidden = best.into_iter().filter(|(_, seen)| hidden(seen));
    let say = |(name, [free, known]): (&str, [f64; 2])| Inconclusive {
        name: name.to_owned(),
        kind: "effect".to_owned(),
        std_error_percent: None,
        std_error_with_known_scale_percent: None,
        correlation_with_scale: None,
        why: format!(
            "a typical size shows {:.1} % of the noise beside a free scale, {:.1} % beside a known one",
            100.0 * free,
            100.0 * known
        ),
    };
    hidden.map(say).collect()
}

#[cfg(test)]
mod tests;
