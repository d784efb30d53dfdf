//! How late the measured speed is: so late is the angle that it adds up to, by which torques over a turn are told.
//!
//! A counter of pulses shows the mean over the last few milliseconds and keeps it for as long; a tachometer has a filter. At 1500 1/min ten
//! milliseconds are a quarter of a turn, and another share of it at every other speed.

use crate::data::case::Waveform;
use crate::data::channels::SPEED;
use crate::model::prediction::{Drive, SpeedObserver, run};
use motor::effect::Plant;
use nalgebra::{Matrix4, Vector4};
use std::sync::Arc;

/// Values within so long count as one, s: neighbours are not independent.
const AS_ONE: f64 = 5e-3;
/// Standard deviations beyond which a speed counts as late: an angle that is wrong by one of them does no harm.
const SIGNIFICANT: f64 = 2.0;
/// Latest speed, s: what is later is an error of the model.
const LATEST: f64 = 0.05;

/// A value of the speed by which the model is judged.
struct Judged {
    /// Time, s.
    t: f64,
    /// Speed of the model, rad/s.
    model: f64,
    /// Measured minus modelled, rad/s.
    error: f64,
    weight: f64,
}

/// How late a recording shows its speed to be.
#[derive(Clone, Copy, Debug)]
pub struct Lateness {
    /// Most likely, s.
    late: f64,
    /// One over its variance, 1/s2.
    weight: f64,
}

impl Lateness {
    /// What recordings of one instrument show together, s; zero where that is not significant.
    pub fn of_all(all: &[Self]) -> f64 {
        let weight: f64 = all.iter().map(|one| one.weight).sum();
        let late = all.iter().map(|one| one.weight * one.late).sum::<f64>() / weight;
        match late {
            late if late > SIGNIFICANT / weight.sqrt() => late.min(LATEST),
            _ => 0.0,
        }
    }
}

impl Waveform {
    /// How late the measured speed is, by a model of the motor; `None` where nothing shows it.
    pub fn lateness(&self, plant: &Plant) -> Option<Lateness> {
        match self.judges_speed() {
            true => lateness(&self.judged_speeds(plant)),
            false => None,
        }
    }

    /// The same with the angle as the shaft had it, the measured speed being so late, s; `None` where it is in time.
    #[must_use]
    pub fn with_angle_in_time(&self, late: f64) -> Option<Self> {
        let late = as_held(late, self.speed_held_s) + 0.5 * self.speed_held_s;
        (late > 0.0).then(|| self.with_angle_later(late))
    }

    fn judged_speeds(&self, plant: &Plant) -> Vec<Judged> {
        let outputs = run(self, plant, &Drive::of(self), SpeedObserver::Off);
        let rows = self.measured.iter().zip(&self.weight).enumerate();
        let judged = rows.filter(|(_, (_, weight))| weight[SPEED] > 0.0);
        let value = |(row, (measured, weight)): (usize, (&[f64; _], &[f64; _]))| {
            let model = outputs.omega_mech[row * self.decimation];
            Judged {
                t: row as f64 * self.t_row(),
                model,
                error: measured[SPEED] - model,
                weight: weight[SPEED],
            }
        };
        judged.map(value).collect()
    }

    /// The angle that comes so much later in the recording, s; nothing is taken across a cut.
    fn with_angle_later(&self, late: f64) -> Self {
        let samples = late / self.inputs.t_sample;
        let theta = &self.timeline.theta_mech;
        let cuts = self
            .timeline
            .cuts
            .iter()
            .map(|cut| cut.sample.min(theta.len()));
        let mut later = Vec::with_capacity(theta.len());
        for end in cuts.chain([theta.len()]) {
            let piece = &theta[later.len()..end];
            later.extend((0..piece.len()).map(|k| at(piece, k as f64 + samples)));
        }
        let mut waveform = self.clone();
        Arc::make_mut(&mut waveform.timeline).theta_mech = later;
        waveform
    }
}

/// A series between its samples; beyond the last one it goes on as it has come.
fn at(series: &[f64], sample: f64) -> f64 {
    let k = (sample as usize).min(series.len().saturating_sub(2));
    let slope = series.get(k + 1).map_or(0.0, |next| next - series[k]);
    series[k] + slope * (sample - k as f64)
}

/// How late measured speeds are: what they are off by along the model's acceleration, beside what an inertia that is off, a scale and a
/// zero make of them.
fn lateness(speeds: &[Judged]) -> Option<Lateness> {
    let (mut normal, mut score, mut squares) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
    for three in speeds.windows(3) {
        let [before, now, after] = three else {
            continue;
        };
        let acceleration = (after.model - before.model) / (after.t - before.t);
        let shown = Vector4::new(-acceleration, -now.t * acceleration, now.model, 1.0) * now.weight;
        let error = now.error * now.weight;
        normal += shown * shown.transpose();
        score += shown * error;
        squares += error * error;
    }
    let covariance = normal.try_inverse()?;
    let found = covariance * score;
    let left = (squares - found.dot(&score)).max(0.0) / speeds.len() as f64;
    let variance = values_as_one(speeds) * left.max(1.0) * covariance[(0, 0)];
    (variance > 0.0).then(|| Lateness {
        late: found[0],
        weight: variance.recip(),
    })
}

/// How late a value is where it is shown for so long: that is that of its instant or, of a counter, the mean over the same time. Torques that
/// nobody knows yet blur what a recording tells of it.
fn as_held(late: f64, held_s: f64) -> f64 {
    let of_a_counter = 0.5 * held_s;
    match (late - of_a_counter).abs() < 0.5 * of_a_counter {
        true => of_a_counter,
        false => late,
    }
}

/// How many values count as one.
fn values_as_one(speeds: &[Judged]) -> f64 {
    match speeds {
        [first, .., last] => {
            let apart = (last.t - first.t) / (speeds.len() - 1) as f64;
            (AS_ONE / apart).max(1.0)
        }
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;
    use recording::Channel;

    /// A start in 0.3 s behind an instrument that is so late, by an inertia that is 1 % off, 0.3 % too fast.
    fn start(late: f64) -> Vec<Judged> {
        let speed = |t: f64| 157.0 * (t / 0.3).clamp(0.0, 1.0).powi(2);
        let judged = |k: usize| {
            let t = 0.005 * k as f64;
            let model = speed(t);
            let shown = 1.003 * speed((t - late) * 1.01);
            let tremble = if k.is_multiple_of(2) { 0.1 } else { -0.1 };
            Judged {
                t,
                model,
                error: shown + tremble - model,
                weight: 10.0,
            }
        };
        (0..200).map(judged).collect()
    }

    #[test]
    fn a_late_speed_is_told_from_an_inertia_that_is_off() {
        let late_by = |speeds: &[&[Judged]]| {
            let all: Vec<Lateness> = speeds.iter().filter_map(|one| lateness(one)).collect();
            Lateness::of_all(&all)
        };
        assert_eq!(late_by(&[]), 0.0);
        assert_eq!(late_by(&[&start(0.0)]), 0.0);
        let late = late_by(&[&start(5e-3)]);
        assert!((late - 5e-3).abs() < 1e-3, "{late}");
        // A speed that does not change shows nothing.
        let steady: Vec<Judged> = start(5e-3).split_off(80);
        assert_eq!(late_by(&[&steady]), 0.0);
        // Beside another recording it does not matter.
        let both = late_by(&[&start(5e-3), &steady]);
        assert!((both - late).abs() < 1e-4, "{both}");
    }

    #[test]
    fn a_value_that_is_held_is_a_counters_or_of_its_instant() {
        assert_eq!(as_held(0.0, 0.01), 0.0);
        assert_eq!(as_held(3.3e-3, 0.01), 5e-3);
        assert_eq!(as_held(6.6e-3, 0.01), 5e-3);
        assert_eq!(as_held(9e-3, 0.01), 9e-3);
        assert_eq!(as_held(3e-3, 0.0), 3e-3);
    }

    /// A load that swings behind a counter of 10 ms: the angle that its values add up to is 10 ms late, and is put right.
    #[test]
    fn the_angle_behind_a_counter_is_put_in_time() {
        let prior = specimen::prior("");
        let waveform = |rec| Waveform::new(rec, &prior.plant.rated).expect("judged");
        let with_speed = |rec, speed: &[f64]| {
            specimen::changed(rec, |channel, x| {
                Some(match channel == Channel::SPEED {
                    true => speed.to_vec(),
                    false => x,
                })
            })
        };
        let swings = specimen::recording(1.0, |t| 1.0 + (40.0 * t).sin());
        let first = waveform(&swings);
        let shaft = run(&first, &prior.plant, &Drive::of(&first), SpeedObserver::Off).omega_mech;
        let mut shaft = signal::refined(shaft, first.between.stride());
        shaft.resize(swings.len(), shaft[shaft.len() - 1]);
        let exact = with_speed(&swings, &shaft);
        let length = (0.01 / exact.t_sample()).round() as usize;
        let counted = with_speed(&exact, &counts(&shaft, length));
        let truth = waveform(&exact);
        let late = waveform(&counted);
        assert!(
            (late.speed_held_s - 0.01).abs() < 1e-4,
            "{}",
            late.speed_held_s
        );
        let put_in_time = |one: &Waveform| {
            let lateness = one.lateness(&prior.plant).expect("shown");
            one.with_angle_in_time(Lateness::of_all(&[lateness]))
        };
        assert!(put_in_time(&truth).is_none(), "in time");
        let in_time = put_in_time(&late).expect("late");
        let off = |one: &Waveform| {
            let both = one
                .timeline
                .theta_mech
                .iter()
                .zip(&truth.timeline.theta_mech);
            // Where it begins nobody knows.
            let ahead: Vec<f64> = both.map(|(a, b)| a - b).collect();
            let mean = ahead.iter().sum::<f64>() / ahead.len() as f64;
            ahead.iter().map(|x| (x - mean).powi(2)).sum::<f64>().sqrt()
        };
        let [before, after] = [&late, &in_time].map(off);
        assert!(after < 0.2 * before, "{before} {after}");
    }

    /// What a counter shows that counts for so many samples.
    fn counts(speed: &[f64], length: usize) -> Vec<f64> {
        let mean = |k: usize| {
            let window = &speed[(k / length).saturating_sub(1) * length..][..length];
            window.iter().sum::<f64>() / length as f64
        };
        (0..speed.len()).map(mean).collect()
    }

    #[test]
    fn a_series_goes_on_as_it_has_come() {
        assert_eq!(at(&[0.0, 1.0, 3.0], 1.5), 2.0);
        assert_eq!(at(&[0.0, 1.0, 3.0], 4.0), 7.0);
        assert_eq!(at(&[2.0], 4.0), 2.0);
    }
}
