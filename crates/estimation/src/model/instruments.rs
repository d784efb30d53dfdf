//! What the instruments of a recording may be off by without anybody's notice: gains and zeros within their class, a torque or a speed that
//! is a little late.
//!
//! Nobody asks about them, and a dozen small ones hide what is asked. They are taken as unknown: to first order they are sums of known
//! responses with unknown amounts, which are taken out of measurement, model and derivatives alike.

use crate::data::case::Case;
use crate::data::instrument_class::{CHANNEL_GAIN, CHANNEL_OFFSET, TORQUE_GAIN};
use crate::fit::nuisance::Strip;
use crate::model::prediction::{Drive, SpeedObserver, outputs, outputs_on};
use crate::model::prior::{Hypothesis, Prior};
use motor::effect::{Effect, EffectConfig, Instrument, Rated};
use motor::effects::ALL;
use rayon::prelude::*;

/// So many deviations of a lag are responses of their own: the second shows what is curved.
const OF_A_LAG: [f64; 2] = [1.0, 2.0];

/// So many rows count as one against what is expected of a gain, which looks like an impedance: neighbours are not independent. Zeros and
/// lags look like nothing else.
const ROWS_AS_ONE: f64 = 30.0;

/// Whether an instrument in good order may be off by this effect.
pub fn is_unnoticed(effect: &dyn Effect) -> bool {
    deviation(effect).is_some() || effect.lag_of().is_some()
}

/// Standard deviation of each size of an effect that is the gain or the zero of channels, in the unit of its scale.
fn deviation(effect: &dyn Effect) -> Option<f64> {
    match (effect.gain_of(), effect.offset_of()) {
        (_, Some(_)) => Some(CHANNEL_OFFSET),
        (Some(Instrument::Voltages | Instrument::Currents), None) => Some(CHANNEL_GAIN),
        (Some(Instrument::Torque), None) => Some(TORQUE_GAIN),
        (Some(Instrument::Speed) | None, None) => None,
    }
}

/// What one instrument may be off by, one standard deviation large.
#[derive(Clone, Debug)]
pub enum InstrumentError {
    /// By an effect of the library.
    Effect(EffectConfig),
    /// A torque that is shown where there is none, N m.
    TorqueZero(f64),
}

impl InstrumentError {
    /// The same by another amount, in standard deviations.
    pub fn times(&self, amount: f64) -> Self {
        match self {
            Self::TorqueZero(torque) => Self::TorqueZero(amount * torque),
            Self::Effect(config) => {
                let mut times = config.clone();
                times.values.iter_mut().for_each(|x| *x *= amount);
                Self::Effect(times)
            }
        }
    }

    /// Weight of what is expected of it: so many rows count as one.
    pub fn weight(&self) -> f64 {
        let gain = self.as_effect().and_then(|config| config.effect.gain_of());
        if gain.is_some() { ROWS_AS_ONE } else { 1.0 }
    }

    /// The effect of the library, if it is one.
    pub fn as_effect(&self) -> Option<&EffectConfig> {
        match self {
            Self::Effect(config) => Some(config),
            Self::TorqueZero(_) => None,
        }
    }

    /// Weighted outputs of a hypothesis with it.
    fn shown(&self, case: &Case, prior: &Prior, h: &Hypothesis) -> Vec<f64> {
        let waveform = match (self, case) {
            (Self::TorqueZero(torque), Case::Waveform(waveform)) => Some((torque, waveform)),
            _ => None,
        };
        if let Some((torque, waveform)) = waveform {
            let mut drive = Drive::of(waveform);
            let shown = &mut drive.inputs.to_mut().tau_load;
            shown.iter_mut().for_each(|tau| *tau -= torque);
            return outputs_on(waveform, &h.plant(prior), &drive);
        }
        let with = self
            .as_effect()
            .map(|config| h.with(config.clone(), &prior.plant.rated));
        outputs(
            case,
            prior,
            &with.unwrap_or_else(|| h.clone()),
            SpeedObserver::Off,
        )
    }
}

/// What the instruments may be off by, each alone, but for effects that are there already.
pub fn errors(prior: &Prior, present: &[EffectConfig]) -> Vec<InstrumentError> {
    let held: Vec<&EffectConfig> = present.iter().chain(&prior.plant.effects).collect();
    let is_free = |effect: &&&'static dyn Effect| {
        let is_same = |c: &&EffectConfig| c.effect.descriptor().name == effect.descriptor().name;
        let hides = |c: &&EffectConfig| {
            effect.gain_of().is_some() && c.effect.hides_gain_of() == effect.gain_of()
        };
        !held.iter().any(|c| is_same(c) || hides(c))
    };
    let rated = &prior.plant.rated;
    let effects = ALL.iter().filter(is_free);
    let effects = effects.flat_map(|effect| errors_of(*effect, rated));
    let torque_zero = InstrumentError::TorqueZero(CHANNEL_OFFSET * rated.torque);
    let effects = effects.map(InstrumentError::Effect);
    effects.chain([torque_zero]).collect()
}

fn errors_of(effect: &'static dyn Effect, rated: &Rated<f64>) -> Vec<EffectConfig> {
    let parameters = effect.descriptor().parameters;
    let alone = |k: usize, size: f64| {
        let mut config = EffectConfig::absent(effect, rated);
        config.values[k] = size * parameters[k].scale.of(rated);
        config
    };
    match deviation(effect) {
        Some(deviation) => (0..parameters.len()).map(|k| alone(k, deviation)).collect(),
        None if effect.lag_of().is_some() => {
            let one = |deviations: f64| alone(0, deviations * parameters[0].typical);
            OF_A_LAG.map(one).into()
        }
        None => Vec::new(),
    }
}

/// What each error does to the weighted outputs of a hypothesis.
pub fn responses(
    case: &Case,
    prior: &Prior,
    h: &Hypothesis,
    errors: &[InstrumentError],
) -> Vec<Vec<f64>> {
    let base = outputs(case, prior, h, SpeedObserver::Off);
    let one = |error: &InstrumentError| {
        let mut there = error.shown(case, prior, h);
        there.iter_mut().zip(&base).for_each(|(x, b)| *x -= b);
        there
    };
    errors.par_iter().map(one).collect()
}

/// Takes responses as unknown in a case, each as large as it is expected to be: those that may be any size before those that many rows
/// speak against, which would take a part of them by their own measure.
pub fn take_as_unknown(case: &mut Case, errors: &[InstrumentError], responses: &[Vec<f64>]) {
    let Some(waveform) = case.waveform_mut() else {
        return;
    };
    let counted = |(error, response): (&InstrumentError, &Vec<f64>)| {
        let weight = error.weight().sqrt();
        Strip::new(0, response.iter().map(|x| x / weight).collect())
    };
    let mut strips: Vec<Strip> = errors.iter().zip(responses).map(counted).collect();
    strips.retain(|strip| strip.length().is_finite());
    strips.sort_by(|a, b| b.length().total_cmp(&a.length()));
    for strip in strips {
        waveform.nuisance.add_expected(&strip, strip.length());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::nuisance::length;
    use crate::model::prediction::residual;
    use crate::specimen;

    fn error(name: &str, at: usize) -> InstrumentError {
        let prior = specimen::prior("");
        let mut all = errors(&prior, &[]).into_iter();
        let is_wanted = |error: &InstrumentError| {
            let config = error.as_effect();
            config.is_some_and(|c| c.effect.descriptor().name == name && c.values[at] != 0.0)
        };
        all.find(is_wanted).expect("an error of an instrument")
    }

    /// A constant voltage that is shown and not there drives a constant current through the stator's resistance: after two seconds nothing
    /// else is left of the mean over whole cycles.
    #[test]
    fn a_voltage_that_is_not_there_drives_a_current_through_the_resistance() {
        let study = specimen::study(2.0, |_| 1.0);
        let (case, prior) = (&study.fitted.case, &study.prior);
        let zero = error("voltage-offset", 0);
        let response = &responses(case, prior, &study.at_prior(), &[zero])[0];
        let waveform = case.waveform().expect("samples");
        let row_s = waveform.t_step() * waveform.decimation as f64;
        let cycle_s = std::f64::consts::TAU / prior.plant.rated.omega_sync;
        let cycles = (10.0 * cycle_s / row_s).round() as usize;
        let rows = waveform.measured.len();
        let shown = |channel: usize| {
            let last = (rows - cycles..rows).map(|row| {
                response[row * crate::data::channels::N_CHANNELS + channel]
                    / waveform.weight[row][channel]
            });
            last.sum::<f64>() / cycles as f64
        };
        // Of a phase's voltage two thirds are in its space vector; a correction takes away what is shown.
        let expected = CHANNEL_OFFSET * prior.plant.rated.voltage / prior.plant.motor.r_s;
        let amplitude = shown(0) - (shown(1) + shown(2)) / 2.0;
        assert!(
            (amplitude.abs() - expected).abs() < 0.02 * expected,
            "{amplitude} {expected}"
        );
    }

    /// What is taken as unknown is left out of what a model is held against, even three times what is expected; a square of it stays.
    #[test]
    fn unknown_zeros_leave_nothing() {
        let mut study = specimen::study(2.0, |_| 1.0);
        let h = study.at_prior();
        let zero = error("voltage-offset", 0);
        let all = errors(&study.prior, &h.effects);
        let responses = responses(&study.fitted.case, &study.prior, &h, &all);
        let left = |study: &crate::data::study::Study| {
            let case = &study.fitted.case;
            let more = zero.times(3.0);
            let with = h.with(
                more.as_effect().expect("an effect").clone(),
                &study.prior.plant.rated,
            );
            let shown = outputs(case, &study.prior, &with, SpeedObserver::Off);
            let without = outputs(case, &study.prior, &h, SpeedObserver::Off);
            let difference: Vec<f64> = shown.iter().zip(&without).map(|(a, b)| a - b).collect();
            length(&difference)
        };
        let before = left(&study);
        take_as_unknown(&mut study.fitted.case, &all, &responses);
        assert!(left(&study) < 0.01 * before, "{} {before}", left(&study));
        let rows = residual(
            &study.fitted.case,
            &outputs(&study.fitted.case, &study.prior, &h, SpeedObserver::Off),
        );
        assert!(rows.iter().all(|x| x.is_finite()));
    }

    #[test]
    fn zeros_and_lags_weigh_one_row_and_gains_many() {
        assert_eq!(error("voltage-offset", 1).weight(), 1.0);
        assert_eq!(error("speed-delay", 0).weight(), 1.0);
        assert_eq!(error("phase-current-gain", 2).weight(), ROWS_AS_ONE);
        let prior = specimen::prior("");
        let found = EffectConfig::absent(
            motor::effects::gain_of(Instrument::Currents).expect("gains"),
            &prior.plant.rated,
        );
        let names = |present: &[EffectConfig]| {
            let all = errors(&prior, present);
            let gains = all.iter().filter(|e| {
                e.as_effect()
                    .is_some_and(|c| c.effect.gain_of() == Some(Instrument::Currents))
            });
            gains.count()
        };
        assert_eq!((names(&[]), names(&[found])), (3, 0));
    }
}
