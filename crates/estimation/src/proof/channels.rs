//! What the channels of a recorder are off by, where that explains a recording.

use crate::data::instrument_class::{CHANNEL_GAIN, CHANNEL_OFFSET};
use crate::data::study::{Study, Trial};
use crate::fit::polish::INSTRUMENTS;
use crate::proof::accept::{SHARE, beats, explained};
use crate::proof::off::SIGNIFICANT;
use motor::effect::{Effect, EffectConfig, Instrument};
use recording::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// Share of the excess over the floor from which the channels, not the motor, are most of what is left: then the answer beside them is
/// taken even where it explains no more than the one without.
const MOST: f64 = 0.5;

/// Gains and offsets of a recorder's channels that are part of an explanation.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChannelsReport {
    /// Held-out error over noise of the model with its parameters refitted, channels taken as they are.
    pub held_out_error_over_noise_without: f64,
    /// The same beside what the channels are off by, nothing else added.
    pub held_out_error_over_noise: f64,
    /// Each channel.
    pub channels: Vec<ChannelReport>,
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
             falls from {:.2} to {:.2} x noise.{beyond}",
            furthest(|c| c.gain_error_percent),
            furthest(|c| c.zero_percent_of_rated),
            self.held_out_error_over_noise_without,
            self.held_out_error_over_noise
        )
    }
}

/// Whether an effect is the gain or the offset of each channel of an instrument.
fn is_of_channels(effect: &dyn Effect) -> bool {
    effect.offset_of().is_some() || INSTRUMENTS.map(Some).contains(&effect.gain_of())
}

impl Study {
    /// The study with its recorder's channels off by what they are beside the best model so far, and its refitted model; `None` where that
    /// explains too little of what this one leaves, or cannot be told. `plain`: the refitted model with nothing added.
    pub fn beside_channels(&self, plain: &Trial, best: &Trial) -> Option<(Self, Trial)> {
        let rated = &self.prior.plant.rated;
        let beside = self.polished(best);
        let all = beside.fit.hypothesis.configs(rated).into_iter();
        let channels: Vec<EffectConfig> =
            all.filter(|config| is_of_channels(config.effect)).collect();
        let explains = beats(beside, best) && explained(self, best, beside) > SHARE;
        if channels.is_empty() || !explains {
            return None;
        }
        let mut study = self.clone();
        study.prior.channels = channels;
        study.plain = Some(Box::new(plain.clone()));
        let refitted = study.refitted();
        Some((study, refitted))
    }

    /// Whether what the channels are off by explains most of what is left without.
    pub fn channels_explain_most(&self, baseline: &Trial) -> bool {
        let plain = self.plain.as_ref();
        plain.is_some_and(|plain| explained(self, plain, baseline) > MOST)
    }

    /// What the recorder's channels are off by, beside a trial; `baseline`: the model with nothing else added. `None` of a study that takes
    /// them as they are.
    pub fn channels(&self, trial: &Trial, baseline: &Trial) -> Option<ChannelsReport> {
        let plain = self.plain.as_ref()?;
        let rated = &self.prior.plant.rated;
        let found = self.polished(trial).fit.hypothesis.configs(rated);
        let values = |is: &dyn Fn(&EffectConfig) -> bool| {
            let config = found.iter().find(|config| is(config));
            config.map_or([0.0; 3], |config| {
                core::array::from_fn(|k| config.values[k])
            })
        };
        let of = |instrument: Instrument, channels: [Channel; 3], amplitude: f64| {
            let gains = values(&|c| c.effect.gain_of() == Some(instrument));
            let zeros = values(&|c| c.effect.offset_of() == Some(instrument));
            let one =
                move |k: usize| ChannelReport::new(channels[k], gains[k], zeros[k], amplitude);
            (0..3).map(one)
        };
        let voltages = of(Instrument::Voltages, Channel::VOLTAGES, rated.voltage);
        let currents = of(Instrument::Currents, Channel::CURRENTS, rated.current);
        Some(ChannelsReport {
            held_out_error_over_noise_without: self.proof_error(plain),
            held_out_error_over_noise: self.proof_error(baseline),
            channels: voltages.chain(currents).collect(),
        })
    }
}

#[cfg(test)]
mod tests;
