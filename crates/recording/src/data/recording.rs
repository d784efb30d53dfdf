//! A recording in SI units.

use crate::data::channel::Channel;
use crate::data::column::Column;
use crate::data::metadata::{Metadata, StartsFrom};
use crate::data::units::Unit;
use crate::error::Error;
use crate::mapping::Mapping;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A recorder that is triggered by the switch begins with it, and a small motor is far from standing still after a cycle, s.
const STILL_S: f64 = 0.002;

/// A channel that is right up to a factor, and up to an offset if none was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownScale {
    /// Unit that the factor would give.
    pub unit: Unit,
    /// Raw reading at zero, in the column's own unit, if it was given.
    pub offset: Option<f64>,
}

/// Samples of a channel that lay far off their neighbours and were replaced by straight lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridged {
    /// How many.
    pub samples: usize,
    /// The one farthest from 0, in the channel's SI unit.
    pub farthest: f64,
    /// When that one was, s.
    pub at_s: f64,
}

/// Samples of one motor over one clock, in SI units, with what is known about them.
///
/// The clock rises strictly, every channel is as long as the clock, and every number is finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    name: String,
    t: Column,
    t_sample: f64,
    channels: BTreeMap<Channel, Column>,
    made: Box<Made>,
    /// What is known beside the samples.
    pub metadata: Metadata,
    /// Set when the factor of the speed is unknown: the channel then holds `unit(raw - offset)`.
    pub unknown_speed_scale: Option<Box<UnknownScale>>,
    /// What had to be assumed to read the file, one sentence each; a report shows them.
    pub assumptions: Vec<String>,
    /// How the file was read, every column named: what a sidecar says for it to be read again without flags.
    pub reading: Box<Mapping>,
}

/// What was made of channels when they were read.
#[derive(Clone, Debug, Default, PartialEq)]
struct Made {
    /// Channels that were computed from others.
    derived: BTreeSet<Channel>,
    bridged: BTreeMap<Channel, Bridged>,
}

impl Recording {
    /// A recording without channels over the clock `t`, s.
    ///
    /// # Errors
    /// Fewer than two samples, or a clock that is not finite and strictly rising.
    pub fn new(name: &str, t: Vec<f64>, metadata: Metadata) -> Result<Recording, Error> {
        Recording::over(name, t.into(), metadata)
    }

    /// The same over a clock that may be lent.
    ///
    /// # Errors
    /// As [`Recording::new`].
    pub fn over(name: &str, t: Column, metadata: Metadata) -> Result<Recording, Error> {
        check_clock(name, &t)?;
        Ok(Recording {
            name: name.to_owned(),
            t_sample: median_step(&t),
            t,
            channels: BTreeMap::new(),
            made: Box::default(),
            metadata,
            unknown_speed_scale: None,
            assumptions: Vec::new(),
            reading: Box::default(),
        })
    }

    /// Adds or replaces a channel, in its SI unit.
    ///
    /// # Errors
    /// A length other than the clock's, or a number that is not finite.
    pub fn with_channel(mut self, channel: Channel, values: Vec<f64>) -> Result<Recording, Error> {
        self.set(channel, values)?;
        Ok(self)
    }

    /// Adds or replaces a channel in place, in its SI unit.
    ///
    /// # Errors
    /// A length other than the clock's, or a number that is not finite.
    pub fn set(&mut self, channel: Channel, values: Vec<f64>) -> Result<(), Error> {
        self.set_column(channel, values.into())
    }

    /// The same with a column that may be lent.
    ///
    /// # Errors
    /// As [`Recording::set`].
    pub fn set_column(&mut self, channel: Channel, values: Column) -> Result<(), Error> {
        let field = channel.to_string();
        if values.len() != self.t.len() {
            let message = format!("{} values for {} samples", values.len(), self.t.len());
            let remedy = "give every channel one value per sample";
            return Err(Error::at(&self.name, 0, &field, message, remedy));
        }
        if let Some(at) = values.iter().position(|x| !x.is_finite()) {
            let message = format!("sample {at} is {}", values[at]);
            let remedy = "remove the sample; a gap in time is allowed";
            return Err(Error::at(&self.name, 0, &field, message, remedy));
        }
        self.channels.insert(channel, values);
        Ok(())
    }

    /// Adds a channel that was computed from others (the third current of three), in its SI unit.
    ///
    /// # Errors
    /// A length other than the clock's, or a number that is not finite.
    pub fn derive(&mut self, channel: Channel, values: Vec<f64>) -> Result<(), Error> {
        self.set(channel, values)?;
        self.made.derived.insert(channel);
        Ok(())
    }

    /// Notes that spikes of a channel were bridged.
    pub fn note_bridged(&mut self, channel: Channel, bridged: Bridged) {
        self.made.bridged.insert(channel, bridged);
    }

    /// The channels of which spikes were bridged when they were read.
    pub fn bridged(&self) -> impl Iterator<Item = (Channel, Bridged)> {
        self.made
            .bridged
            .iter()
            .map(|(channel, bridged)| (*channel, *bridged))
    }

    /// The same with every column lent to itself: clones then share their numbers.
    pub fn lent(mut self) -> Recording {
        self.t = self.t.lent();
        let channels = self.channels.into_iter();
        self.channels = channels
            .map(|(channel, values)| (channel, values.lent()))
            .collect();
        self
    }

    /// The memory of its own columns, to be filled again.
    pub fn into_buffers(self) -> impl Iterator<Item = Vec<f64>> {
        let columns = self.channels.into_values().chain([self.t]);
        columns.filter_map(Column::into_buffer)
    }

    /// The file, as the user named it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The clock, s; rises strictly, not necessarily evenly.
    pub fn t(&self) -> &[f64] {
        &self.t
    }

    /// Number of samples; at least 2.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// The median time between two samples, s; above 0.
    pub fn t_sample(&self) -> f64 {
        self.t_sample
    }

    /// The same with the sampling time of the recording that it is a part of, s: its own differs by what a clock's numbers are
    /// rounded to.
    #[must_use]
    pub fn with_t_sample(mut self, t_sample: f64) -> Recording {
        self.t_sample = t_sample;
        self
    }

    /// Time from the first to the last sample, s.
    pub fn duration(&self) -> f64 {
        self.t[self.t.len() - 1] - self.t[0]
    }

    /// A channel in its SI unit, if it was recorded.
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.get(&channel).map(|values| &**values)
    }

    /// The clock as a column: cheap to clone where it is lent.
    pub fn t_column(&self) -> &Column {
        &self.t
    }

    /// A channel as a column, if it was recorded.
    pub fn column(&self, channel: Channel) -> Option<&Column> {
        self.channels.get(&channel)
    }

    /// The channels that exist, in the order of [`Channel::all`] with second probes beside the first.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, &[f64])> {
        self.channels
            .iter()
            .map(|(channel, values)| (*channel, &**values))
    }

    /// Whether a channel was computed from others instead of measured.
    pub fn is_derived(&self, channel: Channel) -> bool {
        self.made.derived.contains(&channel)
    }

    /// The three phase voltages, V, if all three exist.
    pub fn voltages(&self) -> Option<[&[f64]; 3]> {
        self.three(Channel::VOLTAGES)
    }

    /// The three phase currents, A, if all three exist.
    pub fn currents(&self) -> Option<[&[f64]; 3]> {
        self.three(Channel::CURRENTS)
    }

    fn three(&self, [a, b, c]: [Channel; 3]) -> Option<[&[f64]; 3]> {
        Some([self.channel(a)?, self.channel(b)?, self.channel(c)?])
    }

    /// Mechanical speed, rad/s.
    pub fn speed(&self) -> Option<&[f64]> {
        self.channel(Channel::SPEED)
    }

    /// The same with the speed `factor (speed - at_rest)`, its scale now known.
    pub fn with_speed_scale(mut self, factor: f64, at_rest_rad_s: f64) -> Recording {
        if let Some(speed) = self.channels.get_mut(&Channel::SPEED) {
            let speed = speed.to_mut().iter_mut();
            speed.for_each(|x| *x = factor * (*x - at_rest_rad_s));
        }
        self.unknown_speed_scale = None;
        self
    }

    /// Brake torque at the shaft, N m.
    pub fn torque(&self) -> Option<&[f64]> {
        self.channel(Channel::TORQUE)
    }

    /// Winding temperature, degrees Celsius.
    pub fn temperature(&self) -> Option<&[f64]> {
        self.channel(Channel::TEMPERATURE)
    }

    /// The same without the samples outside a range; the sampling time stays that of all of them.
    ///
    /// # Errors
    /// A range of fewer than two samples or beyond the end.
    pub fn cut(mut self, range: Range<usize>) -> Result<Recording, Error> {
        if range == (0..self.len()) {
            return Ok(self);
        }
        if range.end > self.len() || range.len() < 2 {
            let message = format!("samples {range:?} of {}", self.t.len());
            return Err(Error::bad(&self.name, message, "choose a range inside it"));
        }
        self.begin_at(range.start);
        self.t.cut(&range);
        let channels = self.channels.values_mut();
        channels.for_each(|values| values.cut(&range));
        Ok(self)
    }

    /// What begins later is said to begin at standstill no more.
    fn begin_at(&mut self, sample: usize) {
        if sample > 0 {
            self.metadata.starts_from = StartsFrom::Unknown;
        }
    }

    /// Speed at the first sample, rad/s: the mean of 2 ms, in which a motor that is switched on there still stands.
    pub fn speed_at_first(&self) -> Option<f64> {
        let speed = self.speed()?;
        let first = ((STILL_S / self.t_sample()) as usize).clamp(1, speed.len());
        Some(speed[..first].iter().sum::<f64>() / first as f64)
    }

    /// The samples of a range, with the same clock, metadata and assumptions.
    ///
    /// # Errors
    /// A range of fewer than two samples or beyond the end.
    pub fn slice(&self, range: Range<usize>) -> Result<Recording, Error> {
        let Some(t) = self.t.get(range.clone()) else {
            let message = format!("samples {range:?} of {}", self.t.len());
            return Err(Error::bad(&self.name, message, "choose a range inside it"));
        };
        let mut cut = Recording::new(&self.name, t.to_vec(), self.metadata.clone())?;
        cut.begin_at(range.start);
        for (channel, values) in self.channels() {
            cut.set(channel, values[range.clone()].to_vec())?;
        }
        cut.made.clone_from(&self.made);
        cut.unknown_speed_scale
            .clone_from(&self.unknown_speed_scale);
        cut.assumptions.clone_from(&self.assumptions);
        cut.reading.clone_from(&self.reading);
        Ok(cut)
    }

    /// Parts that follow one another as one recording, with what is known of the first.
    ///
    /// # Errors
    /// No part, a clock that does not rise from one to the next, or channels that not every part has.
    pub fn of_parts(parts: &[Recording]) -> Result<Recording, Error> {
        let [first, ..] = parts else {
            let message = "holds no samples";
            return Err(Error::bad("the recording", message, "give it a part"));
        };
        let t: Vec<f64> = parts.iter().flat_map(|part| part.t()).copied().collect();
        let mut all = Recording::new(&first.name, t, first.metadata.clone())?;
        for (channel, _) in first.channels() {
            let of_part = |part: &Recording| part.channel(channel).unwrap_or_default().to_vec();
            all.set(channel, parts.iter().flat_map(of_part).collect())?;
        }
        all.made.clone_from(&first.made);
        all.unknown_speed_scale
            .clone_from(&first.unknown_speed_scale);
        all.assumptions.clone_from(&first.assumptions);
        all.reading.clone_from(&first.reading);
        Ok(all)
    }
}

/// Time between two samples, s: from a tenth of a nanosecond to a clock in nanoseconds that is taken for one in seconds.
const STEPS_S: std::ops::RangeInclusive<f64> = 1e-10..=1e11;

fn check_clock(name: &str, t: &[f64]) -> Result<(), Error> {
    if t.len() < 2 {
        let message = format!("{} sample(s), at least 2 are needed", t.len());
        return Err(Error::bad(name, message, "record several supply periods"));
    }
    let bad = |at: usize| {
        let message = format!("time {} at sample {at} does not rise", t[at]);
        Error::at(name, 0, "t", message, "sort the samples by time")
    };
    if !t[0].is_finite() {
        return Err(bad(0));
    }
    match (1..t.len()).find(|&k| !(t[k] > t[k - 1] && t[k].is_finite())) {
        Some(at) => Err(bad(at)),
        None => check_step(name, median_step(t)),
    }
}

fn check_step(name: &str, step: f64) -> Result<(), Error> {
    if STEPS_S.contains(&step) {
        return Ok(());
    }
    let message = format!("the samples are {step:e} s apart, which no recorder does");
    let remedy = "say the unit of the clock, --unit t=ms, or the rate, --sample-rate HZ";
    Err(Error::at(name, 0, "t", message, remedy))
}

fn median_step(t: &[f64]) -> f64 {
    let mut steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Recording {
        Recording::new("x.csv", vec![0.0, 0.1], Metadata::default()).unwrap()
    }

    #[test]
    fn a_cut_keeps_the_samples_of_its_range() {
        let t: Vec<f64> = (0..9).map(f64::from).collect();
        let speed: Vec<f64> = t.iter().map(|t| 10.0 * t).collect();
        let all = Recording::new("x.csv", t, Metadata::default()).unwrap();
        let all = all.with_channel(Channel::SPEED, speed).unwrap();
        for whole in [all.clone(), all.clone().lent()] {
            let cut = whole.cut(3..5).unwrap();
            assert_eq!(
                (cut.t(), cut.speed()),
                (&[3.0, 4.0][..], Some(&[30.0, 40.0][..]))
            );
        }
        assert!(all.clone().cut(8..9).is_err() && all.cut(3..10).is_err());
    }

    #[test]
    fn a_channel_must_fit_the_clock_and_be_finite() {
        let short = two().with_channel(Channel::SPEED, vec![1.0]).unwrap_err();
        assert!(short.to_string().contains("1 values for 2 samples"));
        let nan = two().with_channel(Channel::SPEED, vec![1.0, f64::NAN]);
        assert!(nan.unwrap_err().to_string().contains("sample 1 is NaN"));
    }

    #[test]
    fn a_clock_must_rise() {
        for t in [
            vec![],
            vec![0.0],
            vec![0.0, 0.0],
            vec![1.0, 0.0],
            vec![f64::NAN, 1.0],
        ] {
            assert!(Recording::new("x.csv", t, Metadata::default()).is_err());
        }
    }

    #[test]
    fn a_clock_ticks_as_recorders_do() {
        for step in [1e-300, 1e-12, 1e300] {
            let t = vec![0.0, step, 2.0 * step];
            let error = Recording::new("x.csv", t, Metadata::default()).unwrap_err();
            assert!(error.to_string().contains("--sample-rate"), "{error}");
        }
    }

    #[test]
    fn the_sampling_time_ignores_a_gap() {
        let t = vec![0.0, 0.1, 0.2, 7.0, 7.1];
        let recording = Recording::new("x.csv", t, Metadata::default()).unwrap();
        assert!((recording.t_sample() - 0.1).abs() < 1e-12);
    }
}
