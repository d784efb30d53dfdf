//! A speed of unknown scale: where its fit starts, and its result.
//!
//! A running motor turns a little slower than its field. The reading of least slip lies therefore just below the
//! synchronous speed; the reading at rest, where the recording holds one, is the offset; the sense of rotation is the
//! supply's.

use crate::data::case::Case;
use crate::data::unsupported::Unsupported;
use crate::fit::output_error::{Effort, fit};
use crate::model::prediction::{SpeedObserver, outputs, residual};
use crate::model::prior::{Hypothesis, N_NOMINAL, Prior};
use crate::model::scale_report::{AtRest, ErrorSource, SpeedScaleReport};
use crate::model::speed_gain::gain_of;
use motor::dynamic::clarke;
use motor::effect::{EffectConfig, Instrument, Rated};
use motor::effects;
use recording::{Recording, StartsFrom, UnknownScale};
use signal::dot;
use signal::estimated_sigma;
use std::ops::Range;

/// Share of the rated voltage and current below which a motor is not supplied.
const QUIET: f64 = 0.05;
/// Share of the running reading below which the reading of an unsupplied motor is that of rest, and by which it may
/// drift: a coasting motor slows down.
const REST: (f64, f64) = (0.1, 0.005);
/// Time over which a motor that starts with the recording has not moved yet, s.
const NOT_MOVED: f64 = 5e-4;
/// A running motor: at least this share of its rated flux, at most this many times its rated current.
const RUNNING: (f64, f64) = (0.5, 1.5);
/// Relative change of the reading, from one period to the next, of a steady speed.
const STEADY: f64 = 0.005;
/// Fewest periods of steady running.
const LEAST_PERIODS: usize = 5;
/// Share of the periods that may show less slip than the one that is taken for the least.
const OUTLIERS: f64 = 0.05;
/// Slips, percent, that the reading of least slip is tried with before the fit.
const SLIPS_PERCENT: [f64; 5] = [0.0, 1.0, 2.0, 4.0, 6.0];
/// Relative difference of two starting values beyond which they belong to two instruments.
const SAME: f64 = 0.1;

/// How the speed channel of the recordings becomes a speed: `factor (channel - at_rest)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeScale {
    /// Factor on the channel.
    pub factor: f64,
    /// The channel at rest, rad/s of its own scale.
    pub at_rest: f64,
    /// Its standard error where it was measured.
    pub at_rest_error: f64,
    /// Where `at_rest` comes from.
    pub source: AtRest,
    /// What the reader knows.
    unknown: UnknownScale,
}

impl FreeScale {
    /// From the first recording; the others must have been made with the same instrument.
    ///
    /// # Errors
    /// No steady running, or recordings of instruments with different scales.
    pub fn start(recordings: &[&Recording], rated: &Rated<f64>) -> Result<Self, Unsupported> {
        let of = |at_rest: Option<f64>| {
            recordings
                .iter()
                .map(|rec| Readings::new(rec, rated)?.least_slip(at_rest.unwrap_or(0.0)))
                .collect::<Result<Vec<f64>, _>>()
        };
        let raw = of(None)?;
        let unknown = recordings[0].unknown_speed_scale.as_deref().copied();
        let unknown = unknown.ok_or_else(|| Unsupported::new("the scale is known", ""))?;
        let given = unknown.offset;
        let measured = || {
            let pairs = recordings.iter().zip(&raw);
            pairs.clone().find_map(|(rec, factor)| {
                Readings::new(rec, rated)
                    .ok()?
                    .at_rest(rated.speed() / factor.abs())
            })
        };
        let ((at_rest, at_rest_error), source) = match (given, measured()) {
            (Some(_), _) => ((0.0, 0.0), AtRest::Given),
            (None, Some(x)) => (x, AtRest::Measured),
            (None, None) => ((0.0, 0.0), AtRest::Assumed),
        };
        let factors = of(Some(at_rest))?;
        let factor = factors[0];
        if let Some(k) = factors.iter().position(|x| (x / factor - 1.0).abs() > SAME) {
            return Err(Unsupported::new(
                format!(
                    "the speeds of {} and {} have scales of their own ({:.4} and {factor:.4}, taken from the least slip)",
                    recordings[k].name(),
                    recordings[0].name(),
                    factors[k]
                ),
                "ask about recordings of one instrument at a time",
            ));
        }
        Ok(Self {
            factor,
            at_rest,
            at_rest_error,
            source,
            unknown,
        })
    }

    /// Relative error of the factor that the reading at rest brings, at rated frequency.
    pub fn error_of_rest(&self, rated: &Rated<f64>) -> f64 {
        (self.at_rest_error * self.factor / rated.speed()).abs()
    }

    /// The recording in rad/s.
    pub fn applied(&self, rec: &Recording) -> Recording {
        rec.clone().with_speed_scale(self.factor, self.at_rest)
    }

    /// The same with its factor fitted to one recording, everything else as believed.
    pub fn fitted(self, case: &Case, prior: &Prior) -> Self {
        let mut h = free(&prior_frozen(), prior);
        let error = |z: f64| {
            let mut h = h.clone();
            h.z[N_NOMINAL] = z;
            let r = residual(case, &outputs(case, prior, &h, SpeedObserver::Off));
            dot(&r, &r)
        };
        let typical = h.parameter(N_NOMINAL).typical;
        let starts = SLIPS_PERCENT.map(|slip| slip / (100.0 - slip) / typical);
        let best = starts
            .into_iter()
            .min_by(|a, b| error(*a).total_cmp(&error(*b)));
        h.z[N_NOMINAL] = best.unwrap_or(0.0);
        let found = fit(case, prior, &h, Effort::FULL);
        self.over(gain(&found.hypothesis, prior))
    }

    fn over(self, gain: f64) -> Self {
        Self {
            factor: self.factor / gain,
            ..self
        }
    }

    /// What a report says of it, after a fit found `h`; `error`: standard error, a share of the factor, and its source.
    pub fn report(
        &self,
        h: &Hypothesis,
        prior: &Prior,
        (error, source): (f64, ErrorSource),
    ) -> SpeedScaleReport {
        let factor = self.over(gain(h, prior)).factor;
        let unit = self.unknown.unit;
        let given = self.unknown.offset.unwrap_or(0.0);
        SpeedScaleReport {
            factor,
            std_error: (factor * error).abs(),
            std_error_is: source,
            unit: format!("{} per unit of the column", unit.name),
            offset: given + self.at_rest / unit.factor,
            offset_std_error: self.at_rest_error / unit.factor,
            offset_is: self.source,
            at_rest_rad_s: self.at_rest,
        }
    }
}

/// The hypothesis with the scale of the speed free.
pub fn free(h: &Hypothesis, prior: &Prior) -> Hypothesis {
    let rated = &prior.plant.rated;
    match effects::gain_of(Instrument::Speed) {
        Some(effect) => h.with(EffectConfig::absent(effect, rated), rated),
        None => h.clone(),
    }
}

fn prior_frozen() -> Hypothesis {
    let mut h = Hypothesis::at_prior(true);
    h.free.fill(false);
    h
}

/// What the channel shows over the truth, in a hypothesis.
fn gain(h: &Hypothesis, prior: &Prior) -> f64 {
    gain_of(&h.configs(&prior.plant.rated))
}

/// Means over one period.
struct Period {
    voltage: f64,
    current: f64,
    /// Turn of the voltage per second, rad/s; negative against the phases.
    omega: f64,
    /// Speed channel.
    reading: f64,
}

/// What a recording shows period by period.
struct Readings<'a> {
    rec: &'a Recording,
    rated: &'a Rated<f64>,
    speed: &'a [f64],
    periods: Vec<Period>,
    length: usize,
}

impl<'a> Readings<'a> {
    fn new(rec: &'a Recording, rated: &'a Rated<f64>) -> Result<Self, Unsupported> {
        let missing = || {
            let remedy = "record va vb vc, ia ib ic and speed";
            Unsupported::new("the scale of the speed needs voltages and currents", remedy)
        };
        let speed = rec.speed().ok_or_else(missing)?;
        let (u, i) = rec.voltages().zip(rec.currents()).ok_or_else(missing)?;
        let period = std::f64::consts::TAU / rated.omega_sync;
        let length = ((period / rec.t_sample()).round() as usize).max(4);
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let vector = |x: [&[f64]; 3], k: usize| clarke(x.map(|x| x[k]));
        let one = |part: Range<usize>| {
            let size = |x: [&[f64]; 3]| part.clone().map(|k| vector(x, k).norm()).sum::<f64>();
            let turn = |k: usize| (vector(u, k) * vector(u, k - 1).conj()).arg();
            let n = part.len() as f64;
            let turned: f64 = (part.start + 1..part.end).map(turn).sum();
            Period {
                voltage: size(u) / n,
                current: size(i) / n,
                omega: turned / ((n - 1.0) * rec.t_sample()),
                reading: mean(&speed[part.clone()]),
            }
        };
        let starts = (0..rec.len() / length).map(|k| k * length);
        Ok(Self {
            periods: starts.map(|k| one(k..k + length)).collect(),
            rec,
            rated,
            speed,
            length,
        })
    }

    /// Factor that puts the steady running of least slip at synchronous speed.
    fn least_slip(&self, at_rest: f64) -> Result<f64, Unsupported> {
        let flux = |p: &Period| p.voltage / p.omega.abs() / self.rated.flux();
        let runs = |p: &Period| {
            flux(p) > RUNNING.0
                && p.voltage > QUIET * self.rated.voltage
                && p.current < RUNNING.1 * self.rated.current
        };
        let steady = |pair: &&[Period]| {
            let change = (pair[1].reading - pair[0].reading).abs();
            pair.iter().all(runs) && change < STEADY * (pair[1].reading - at_rest).abs()
        };
        let ratio = |p: &Period| (p.reading - at_rest) * self.rated.n_p / p.omega;
        let pairs = self.periods.windows(2).filter(steady);
        let mut ratios: Vec<f64> = pairs.map(|pair| ratio(&pair[1])).collect();
        if ratios.len() < LEAST_PERIODS {
            return Err(Unsupported::new(
                format!(
                    "the scale of the speed is unknown, and in {} the motor nowhere runs steadily near its synchronous speed",
                    self.rec.name()
                ),
                "record some steady running, best without load, or give --scale speed=FACTOR",
            ));
        }
        ratios.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let least = ratios[((1.0 - OUTLIERS) * (ratios.len() - 1) as f64) as usize];
        Ok(1.0 / least)
    }

    /// The channel while the motor surely stands, and the standard error of that; `running` is about what it shows at
    /// synchronous speed.
    fn at_rest(&self, running: f64) -> Option<(f64, f64)> {
        let quiet = |p: &&Period| {
            p.voltage < QUIET * self.rated.voltage && p.current < QUIET * self.rated.current
        };
        let before = self.periods.iter().take_while(quiet).count();
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let noise = estimated_sigma(self.speed);
        let read = |x: &[f64]| (mean(x), noise / (x.len() as f64).sqrt());
        let declared = self.rec.metadata.starts_from == StartsFrom::Standstill;
        if before == 0 && declared {
            let n = (NOT_MOVED / self.rec.t_sample()) as usize;
            return Some(read(&self.speed[..n.clamp(1, self.speed.len())]));
        }
        let rest = &self.speed[..before * self.length];
        let (first, last) = rest.split_at(rest.len() / 2);
        let stands = before > 0
            && (mean(first) - mean(last)).abs() < REST.1 * running
            && mean(rest).abs() < REST.0 * running;
        (stands || before > 0 && declared).then(|| read(rest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;
    use recording::{Channel, Metadata, UNITS};
    use std::f64::consts::TAU;

    const RATED: Rated<f64> = Rated {
        voltage: 325.0,
        current: 10.0,
        omega_sync: TAU * 50.0,
        n_p: 2.0,
        torque: 20.0,
    };

    /// Half a second at rest, then 1 s of running with 4 % slip and 1 s with 1 %; `sense` is the supply's.
    fn recording(sense: f64, show: &dyn Fn(f64) -> f64) -> Recording {
        let t: Vec<f64> = (0..12_500).map(|k| f64::from(k) / 5000.0).collect();
        let on = |t: f64| f64::from(u8::from(t >= 0.5));
        let wave = |amplitude: f64, k: usize| -> Vec<f64> {
            let at = |t: &f64| {
                let angle = sense * TAU * 50.0 * t - k as f64 * TAU / 3.0;
                on(*t) * amplitude * angle.cos()
            };
            t.iter().map(at).collect()
        };
        let slip = |t: f64| if t < 1.5 { 0.04 } else { 0.01 };
        let speed = |t: &f64| show(sense * on(*t) * (1.0 - slip(*t)) * TAU * 25.0);
        let mut rec = Recording::new("x", t.clone(), Metadata::default()).expect("a clock");
        for k in 0..3 {
            rec = rec
                .with_channel(Channel::VOLTAGES[k], wave(325.0, k))
                .and_then(|rec| rec.with_channel(Channel::CURRENTS[k], wave(5.0, k)))
                .expect("as long");
        }
        rec = rec
            .with_channel(Channel::SPEED, t.iter().map(speed).collect())
            .expect("as long");
        rec.unknown_speed_scale = Some(Box::new(UnknownScale {
            unit: *UNITS
                .iter()
                .find(|unit| unit.name == "rad/s")
                .expect("a unit"),
            offset: None,
        }));
        rec
    }

    #[test]
    fn the_least_slip_is_put_at_the_synchronous_speed_and_rest_at_zero() {
        for sense in [1.0, -1.0] {
            let rec = recording(sense, &|x| -0.3 * x - 2.0);
            let found = FreeScale::start(&[&rec], &RATED).expect("it runs");
            assert_eq!(found.source, AtRest::Measured);
            assert!((found.at_rest + 2.0).abs() < 1e-9, "{found:?}");
            // True factor -1/0.3; the slip of 1 % is not known yet.
            let expected = -1.0 / 0.3 / 0.99;
            assert!((found.factor / expected - 1.0).abs() < 1e-6, "{found:?}");
            let speed = found.applied(&rec);
            let last = speed.speed().expect("a speed")[12_000];
            assert!((last / (sense * TAU * 25.0) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn two_instruments_are_not_one_question() {
        let (a, b) = (recording(1.0, &|x| 0.3 * x), recording(1.0, &|x| 0.5 * x));
        let refused = FreeScale::start(&[&a, &b], &RATED).expect_err("two scales");
        assert!(
            refused.reason.contains("scales of their own"),
            "{refused:?}"
        );
    }

    #[test]
    fn a_motor_that_never_runs_has_no_scale() {
        let rec = recording(1.0, &|x| 0.3 * x);
        let rest = rec.slice(0..2000).expect("inside");
        let refused = FreeScale::start(&[&rest], &RATED).expect_err("it stands");
        assert!(refused.reason.contains("nowhere runs"), "{refused:?}");
    }

    /// A reading that falls while nothing is supplied is a shaft that coasts, and no offset.
    #[test]
    fn a_coasting_shaft_is_not_at_rest() {
        let rec = recording(1.0, &|x| 0.3 * x);
        let coasting = |k: usize, x: f64| if k < 2500 { 20.0 - k as f64 / 500.0 } else { x };
        let speed = rec.speed().expect("a speed").iter().enumerate();
        let shown = speed.map(|(k, x)| coasting(k, *x)).collect();
        let rec = rec.with_channel(Channel::SPEED, shown).expect("as long");
        let found = FreeScale::start(&[&rec], &RATED).expect("it runs");
        assert_eq!((found.source, found.at_rest), (AtRest::Assumed, 0.0));
    }

    /// Counts of 0.1 rad/s each, 10 of them at zero speed by the data sheet; at rest 2 rad/s less than that.
    #[test]
    fn offset_and_error_are_reported_in_the_unit_of_the_column() {
        let study = specimen::scaled_study(0.4, 0.4);
        let trial = specimen::trial_with(&study, &[]);
        let mut unit = UNITS[0];
        unit.factor = 0.1;
        let scale = FreeScale {
            at_rest: -2.0,
            at_rest_error: 0.3,
            unknown: UnknownScale {
                unit,
                offset: Some(10.0),
            },
            ..study.speed_scale.expect("free")
        };
        let report = scale.report(
            &trial.fit.hypothesis,
            &study.prior,
            (0.01, ErrorSource::Physics),
        );
        assert!((report.offset - -10.0).abs() < 1e-12, "{report:?}");
        assert!((report.offset_std_error - 3.0).abs() < 1e-12, "{report:?}");
        assert_eq!(report.at_rest_rad_s, -2.0);
    }
}
