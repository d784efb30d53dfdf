//! What the channels of a recorder are off by, where that explains a recording.

use crate::data::instrument_class::{CHANNEL_GAIN, CHANNEL_OFFSET};
use crate::data::study::{Plain, Study, Subject, Trial};
use crate::model::instruments::{InstrumentError, errors, is_unnoticed, responses};
use crate::model::prediction::{SpeedObserver, outputs, residual};
use crate::model::prior::Hypothesis;
use crate::proof::accept::explained;
use crate::proof::off::SIGNIFICANT;
use motor::effect::{Effect, Instrument};
use motor::effects::ALL;
use nalgebra::{Cholesky, DMatrix, DVector};
use recording::Channel;
use schemars::JsonSchema;
use serde::Serialize;
use signal::dot;

/// Share of the excess over the floor from which the instruments, not the motor, are most of what is left: then they are asked about first.
const MOST: f64 = 0.5;

/// Zero of a channel that is out of order, a share of the rated amplitude: some per mille of a full scale that takes a start is a per cent.
const FAR_ZERO: f64 = 0.03;

/// Instruments that may be late, with their names.
const LATE: [(Instrument, &str); 3] = [
    (Instrument::Currents, "currents"),
    (Instrument::Speed, "speed"),
    (Instrument::Torque, "torque"),
];
/// Squared error over noise that instruments take at least to be told: 2 % of the error, without which a model is adequate.
const LEAST_TAKEN: f64 = 0.04;
/// Least lag that is told in words, s.
const LEAST_LAG: f64 = 5e-4;

/// Gains and offsets of a recorder's channels that are part of an explanation.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChannelsReport {
    /// Held-out error over noise of the model with its parameters refitted, channels taken as they are.
    pub held_out_error_over_noise_without: f64,
    /// The same beside what the channels are off by, nothing else added.
    pub held_out_error_over_noise: f64,
    /// Each channel.
    pub channels: Vec<ChannelReport>,
    /// Instruments that show what was a moment before.
    pub lags: Vec<LagReport>,
}

/// By how much an instrument is late.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LagReport {
    /// The instrument: `currents` (against the voltages), `speed` or `torque`.
    pub instrument: String,
    /// By how much it is late, s.
    pub late_by_second: f64,
}

/// What one channel of a recorder is off by.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChannelReport {
    /// Name of the channel.
    pub channel: String,
    /// It shows so much more than is there, percent.
    pub gain_error_percent: f64,
    /// What it shows where nothing is, in its unit.
    pub zero: f64,
    /// The same, percent of the rated amplitude.
    pub zero_percent_of_rated: f64,
    /// Unit of the zero.
    pub unit: String,
    /// Whether a channel of class 0.5 may be off by that: within three standard deviations.
    pub is_within_class: bool,
}

impl ChannelReport {
    fn new(channel: Channel, gain: f64, zero: f64, rated: f64) -> Self {
        let share = zero / rated;
        Self {
            channel: channel.to_string(),
            gain_error_percent: 100.0 * gain,
            zero,
            zero_percent_of_rated: 100.0 * share,
            unit: channel.quantity().si().to_owned(),
            is_within_class: gain.abs() < SIGNIFICANT * CHANNEL_GAIN
                && share.abs() < SIGNIFICANT * CHANNEL_OFFSET,
        }
    }

    fn told(&self) -> String {
        format!(
            "{} gain {:+.2} %, zero {:+.3} {}",
            self.channel, self.gain_error_percent, self.zero, self.unit
        )
    }
}

impl ChannelsReport {
    /// The same in words.
    pub fn told(&self) -> String {
        let furthest = |of: fn(&ChannelReport) -> f64| {
            let by_size =
                |a: &&ChannelReport, b: &&ChannelReport| of(a).abs().total_cmp(&of(b).abs());
            let channel = self.channels.iter().max_by(by_size);
            channel.map_or_else(String::new, |c| format!("{:+.2} % ({})", of(c), c.channel))
        };
        let beyond: Vec<String> = self
            .channels
            .iter()
            .filter(|c| !c.is_within_class)
            .map(ChannelReport::told)
            .collect();
        let beyond = match beyond.is_empty() {
            true => String::new(),
            false => format!(
                " Further off than instruments of class 0.5 are: {}.",
                beyond.join("; ")
            ),
        };
        format!(
            " The recorder's channels are off, too: gains by up to {}, zeros by up to {} of the rated amplitude; with that alone the error \
             falls from {:.2} to {:.2} x noise.{beyond}{}",
            furthest(|c| c.gain_error_percent),
            furthest(|c| c.zero_percent_of_rated),
            self.held_out_error_over_noise_without,
            self.held_out_error_over_noise,
            self.late()
        )
    }

    /// Instruments that are late by enough to be told.
    fn late(&self) -> String {
        let late = self
            .lags
            .iter()
            .filter(|lag| lag.late_by_second > LEAST_LAG);
        let told = late.map(|lag| {
            let late_by = 1e3 * lag.late_by_second;
            format!("{} {late_by:.1} ms", lag.instrument)
        });
        let told: Vec<String> = told.collect();
        match told.is_empty() {
            true => String::new(),
            false => format!(" Late are: {}.", told.join(", ")),
        }
    }
}

impl Study {
    /// The study with what its instruments may be off by taken as unknown, and its refitted model; `None` of a load table. `refitted`: the
    /// model with the instruments taken as they are.
    pub fn with_unknown_instruments(&self, refitted: &Trial) -> Option<(Self, Trial)> {
        if self.fitted.case.is_table() || self.plain.is_some() {
            return None;
        }
        // Responses are those of a motor with these parameters, and the first ones had to make up for the instruments.
        let first = self.unknown_at(refitted, &refitted.fit.hypothesis);
        let study = self.unknown_at(refitted, &first.refitted().fit.hypothesis);
        let baseline = study.refitted();
        Some((study, baseline))
    }

    /// The study with the responses of this hypothesis taken as unknown.
    fn unknown_at(&self, refitted: &Trial, h: &Hypothesis) -> Self {
        let errors = errors(&self.prior, &h.effects);
        let unknown = |subject: &Subject| subject.with_unknown_instruments(&self.prior, h, &errors);
        Self {
            prior: self.prior.clone(),
            fitted: unknown(&self.fitted),
            proofs: self.proofs.iter().map(unknown).collect(),
            speed_scale: self.speed_scale,
            plain: Some(Box::new(Plain {
                study: self.clone(),
                refitted: refitted.clone(),
                errors: errors.clone(),
            })),
        }
    }

    /// Squared error over noise that unknown instruments take from a trial; 0 of a study that takes them as they are.
    pub fn taken_by_instruments(&self, trial: &Trial) -> f64 {
        let Some(plain) = &self.plain else { return 0.0 };
        *trial.taken_by_instruments.get_or_init(|| {
            let left = plain.left(&trial.fit.hypothesis);
            let error = |left: &[f64]| self.fold_error(&[dot(left, left)]).powi(2);
            (error(&left) - error(&trial.fit.residual)).max(0.0)
        })
    }

    /// Whether unknown instruments take nothing from a trial worth telling.
    pub fn instruments_are_exact_beside(&self, trial: &Trial) -> bool {
        self.taken_by_instruments(trial) < LEAST_TAKEN
    }

    /// Names of the effects that are taken as unknown.
    pub fn unknown_effects(&self) -> Vec<&'static str> {
        let taken = ALL
            .iter()
            .filter(|e| self.plain.is_some() && is_unnoticed(**e));
        taken.map(|e| e.descriptor().name).collect()
    }

    /// The model that explains nothing but parameters, the instruments as they are; `baseline`: the refitted one.
    pub fn unexplained<'a>(&'a self, baseline: &'a Trial) -> &'a Trial {
        let plain = self.plain.as_deref();
        plain.map_or(baseline, |plain| &plain.refitted)
    }

    /// Whether what the instruments are off by explains most of what is left without.
    pub fn instruments_explain_most(&self, baseline: &Trial) -> bool {
        let plain = self.plain.as_ref();
        plain.is_some_and(|plain| explained(self, &plain.refitted, baseline) > MOST)
    }

    /// Whether the gains of the channels that a trial asks for are those of instruments in good order.
    pub fn gains_are_plausible(&self, trial: &Trial) -> bool {
        let report = self.channels(trial, trial);
        let mut channels = report.iter().flat_map(|report| &report.channels);
        channels.all(|c| c.gain_error_percent.abs() < 100.0 * SIGNIFICANT * CHANNEL_GAIN)
    }

    /// Whether a voltage or current channel that a trial asks for is out of order: its gain is not that of the others, or its zero is far off.
    pub fn has_a_channel_out_of_order(&self, trial: &Trial) -> bool {
        let Some(report) = self.channels(trial, trial) else {
            return false;
        };
        let phases = report.channels.chunks_exact(3);
        phases.into_iter().any(|three| {
            let mut gains = [0, 1, 2].map(|k| three[k].gain_error_percent);
            gains.sort_by(f64::total_cmp);
            let apart = (gains[1] - gains[0]).max(gains[2] - gains[1]);
            let stands_out = apart > 100.0 * SIGNIFICANT * CHANNEL_GAIN;
            stands_out
                || three
                    .iter()
                    .any(|c| c.zero_percent_of_rated.abs() > 100.0 * FAR_ZERO)
        })
    }

    /// What the recorder's channels are off by, beside a trial; `baseline`: the model with nothing else added. `None` where that takes nothing
    /// from it, and of a study that takes them as they are.
    pub fn channels(&self, trial: &Trial, baseline: &Trial) -> Option<ChannelsReport> {
        let plain = self.plain.as_ref()?;
        if self.instruments_are_exact_beside(trial) {
            return None;
        }
        let found = plain.found(&trial.fit.hypothesis)?;
        let rated = &self.prior.plant.rated;
        let voltages = found.of_phases(Instrument::Voltages, Channel::VOLTAGES, rated.voltage);
        let currents = found.of_phases(Instrument::Currents, Channel::CURRENTS, rated.current);
        let torque = found.of_torque(rated.torque);
        Some(ChannelsReport {
            held_out_error_over_noise_without: self.proof_error(&plain.refitted),
            held_out_error_over_noise: self.proof_error(baseline),
            channels: voltages.chain(currents).chain(torque).collect(),
            lags: found.lags(),
        })
    }
}

/// Errors of instruments, each with its amount.
struct Found(Vec<InstrumentError>);

impl Found {
    /// Sum of a parameter over the effects of one kind.
    fn sum(&self, parameter: usize, is: impl Fn(&dyn Effect) -> bool) -> f64 {
        let effects = self.0.iter().filter_map(InstrumentError::as_effect);
        let effects = effects.filter(|config| is(config.effect));
        effects.map(|config| config.values[parameter]).sum()
    }

    fn of_phases(
        &self,
        instrument: Instrument,
        channels: [Channel; 3],
        amplitude: f64,
    ) -> impl Iterator<Item = ChannelReport> {
        (0..3).map(move |k| {
            let gain = self.sum(k, |e| e.gain_of() == Some(instrument));
            let zero = self.sum(k, |e| e.offset_of() == Some(instrument));
            ChannelReport::new(channels[k], gain, zero, amplitude)
        })
    }

    /// The torque channel, where there is one.
    fn of_torque(&self, rated: f64) -> Option<ChannelReport> {
        let zeros = self.0.iter().filter_map(|error| match error {
            InstrumentError::TorqueZero(torque) => Some(*torque),
            InstrumentError::Effect(_) => None,
        });
        let zero: f64 = zeros.sum();
        let gain = self.sum(0, |e| e.gain_of() == Some(Instrument::Torque));
        let is_there = zero != 0.0 || gain != 0.0;
        is_there.then(|| ChannelReport::new(Channel::TORQUE, gain, zero, rated))
    }

    fn lags(&self) -> Vec<LagReport> {
        let lag = |(instrument, name): (Instrument, &str)| {
            let late_by = self.sum(0, |e| e.lag_of() == Some(instrument));
            (late_by != 0.0).then(|| LagReport {
                instrument: name.to_owned(),
                late_by_second: late_by,
            })
        };
        LATE.into_iter().filter_map(lag).collect()
    }
}

impl Plain {
    /// What a hypothesis leaves of the fitted recording with the instruments as they are.
    fn left(&self, h: &Hypothesis) -> Vec<f64> {
        let (case, prior) = (&self.study.fitted.case, &self.study.prior);
        residual(case, &outputs(case, prior, h, SpeedObserver::Off))
    }

    /// The errors of the instruments that a hypothesis leaves most likely, each with its amount: linear regression, each believed to be as
    /// large as its standard deviation.
    fn found(&self, h: &Hypothesis) -> Option<Found> {
        let left = self.left(h);
        let study = &self.study;
        let shown = responses(&study.fitted.case, &study.prior, h, &self.errors);
        let n = shown.len();
        let gram = |i: usize, j: usize| dot(&shown[i], &shown[j]);
        let weights = DVector::from_iterator(n, self.errors.iter().map(InstrumentError::weight));
        let normal = DMatrix::from_fn(n, n, gram) + DMatrix::from_diagonal(&weights);
        let score = DVector::from_fn(n, |i, _| dot(&shown[i], &left));
        let amounts = Cholesky::new(normal)?.solve(&score);
        let both = self.errors.iter().zip(amounts.iter());
        let found = both.map(|(error, amount)| error.times(*amount));
        Some(Found(found.collect()))
    }
}

#[cfg(test)]
mod tests;
