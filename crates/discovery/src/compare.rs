//! Where the model fails, as the motor file says it, nothing refitted.

use crate::api::{Progress, speed_scale_report};
use crate::report::types::{
    BandReport, CompareReport, Inconclusive, OrderReport, Overall, RegionReport, SignalReport,
};
use crate::search::inconclusive;
use estimation::data::case::{Case, Waveform};
use estimation::data::channels::N_CHANNELS;
use estimation::data::given::Sources;
use estimation::data::question::{Error, Question};
use estimation::data::study::Study;
use estimation::fit::output_error::Effort;
use estimation::model::prediction::{SpeedObserver, outputs, residual};
use estimation::model::scale_report::SpeedScaleReport;
use motor::MotorFile;
use motor::dynamic::clarke;
use num_complex::Complex64;
use std::ops::Range;

/// A block with its number.
type Numbered = (usize, Range<usize>);

/// Orders of the supply frequency that are looked for in the current error.
const ORDERS: [f64; 7] = [0.0, 1.0, -1.0, -5.0, 7.0, -11.0, 13.0];
/// Bands of load, voltage and slip, in percent of rated.
const BANDS: [f64; 8] = [0.0, 5.0, 25.0, 50.0, 75.0, 95.0, 105.0, 1000.0];

/// Compares the first source with the model of the motor file.
///
/// # Errors
/// Wrong effects in the motor file or no source. A recording that cannot be judged gives a report with an
/// audit and nothing else.
pub fn compare<'a>(
    sources: impl Into<Sources<'a>>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<CompareReport, Error> {
    compared(sources.into().first(), motor, progress)
}

fn compared(
    first: Sources<'_>,
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<CompareReport, Error> {
    let empty = |audit| CompareReport {
        audit,
        stretches: Vec::new(),
        signals: Vec::new(),
        regions: Vec::new(),
        bands: Vec::new(),
        orders: Vec::new(),
        overall: None,
        speed_scale: None,
        cannot_be_concluded: Vec::new(),
    };
    let question = match Question::new(first, motor, progress) {
        Ok(question) => question,
        Err(Error::Unsupported(audit, _)) => return Ok(empty(*audit)),
        Err(error) => return Err(error),
    };
    progress("simulating", 0.5);
    let study = &question.study;
    let case = &study.fitted.case;
    let model = outputs(case, &study.prior, &study.at_prior(), SpeedObserver::Off);
    let r = residual(case, &model);
    let (speed_scale, cannot_be_concluded) = scale_of(study).unzip();
    progress("done", 1.0);
    Ok(CompareReport {
        signals: signals(case, &r),
        regions: regions(study, &r),
        bands: bands(study, &r),
        orders: orders(case, &r),
        overall: Some(Overall {
            error_over_noise: study.fold_error(&[signal::dot(&r, &r)]),
        }),
        speed_scale,
        cannot_be_concluded: cannot_be_concluded.unwrap_or_default(),
        stretches: question.stretches,
        ..empty(question.audit)
    })
}

/// The scale of the speed that suits the motor file as it is, where it was unknown, and what that leaves open.
fn scale_of(study: &Study) -> Option<(SpeedScaleReport, Vec<Inconclusive>)> {
    study.speed_scale?;
    let trial = study.trial(&study.at_prior(), Effort::NONE);
    let open = inconclusive::list(study, &trial, &[]);
    Some((speed_scale_report(study, &trial)?, open))
}

fn signals(case: &Case, r: &[f64]) -> Vec<SignalReport> {
    let (measured, weight) = (case.measured(), case.weight());
    let judged = |k: usize| weight.iter().filter(|w| w[k] > 0.0).count() as f64;
    let mean = |k: usize, f: &dyn Fn(usize, f64) -> f64| {
        let rows = (0..weight.len()).filter(|&row| weight[row][k] > 0.0);
        let sum: f64 = rows.map(|row| f(row, 1.0 / weight[row][k])).sum();
        (sum / judged(k)).sqrt()
    };
    let one = |(k, (name, unit)): (usize, (&str, &str))| {
        let error = mean(k, &|row, sigma| (r[row * N_CHANNELS + k] * sigma).powi(2));
        let ratio = mean(k, &|row, _| r[row * N_CHANNELS + k].powi(2));
        SignalReport {
            name: name.to_owned(),
            unit: unit.to_owned(),
            rms: mean(k, &|row, _| measured[row][k].powi(2)),
            error_rms: error,
            noise_floor: mean(k, &|_, sigma| sigma * sigma),
            error_over_noise: ratio,
        }
    };
    let known = case.channels().into_iter().enumerate();
    known.filter(|(k, _)| judged(*k) > 0.0).map(one).collect()
}

/// Error over noise of a set of blocks.
fn error_of(study: &Study, r: &[f64], blocks: &[Numbered]) -> f64 {
    let sse = |rows: &Range<usize>| {
        let part = &r[rows.start * N_CHANNELS..rows.end * N_CHANNELS];
        signal::dot(part, part)
    };
    let error: f64 = blocks.iter().map(|(_, rows)| sse(rows)).sum();
    let floor: f64 = blocks
        .iter()
        .map(|(k, _)| study.fitted.floor.block[*k])
        .sum();
    (error / floor.max(f64::MIN_POSITIVE)).sqrt()
}

/// State of the machine in one block: what it does, its load and voltage in percent.
fn state(study: &Study, waveform: &Waveform, rows: &Range<usize>) -> String {
    let rated = &study.prior.plant.rated;
    let [load, voltage, slip, _] = percents(study, waveform, rows);
    let stride = waveform.samples_per_row();
    let part = rows.start * stride..(rows.end * stride).min(waveform.inputs.u_s.len());
    if voltage < 2.0 {
        return "off".to_owned();
    }
    if slip > 20.0 {
        return "start-up".to_owned();
    }
    let half = rows.start + rows.len() / 2;
    let step = (load_torque(study, waveform, rows.start..half)
        - load_torque(study, waveform, half..rows.end))
    .abs();
    let stepped = waveform
        .supply
        .segments
        .iter()
        .any(|s| part.contains(&s.start) && s.start > 0 && !is_cut(waveform, s.start));
    if step > 0.1 * rated.torque || stepped {
        return "step".to_owned();
    }
    let round = |x: f64| (x / 5.0).round() * 5.0 + 0.0; // -0 becomes 0: one region, not two
    format!("load {:.0} %, voltage {:.0} %", round(load), round(voltage))
}

fn is_cut(waveform: &Waveform, sample: usize) -> bool {
    let cuts = &waveform.timeline.cuts;
    cuts.iter().any(|cut| cut.sample == sample)
}

/// Mean load torque of some rows, N m: as measured, or that of the air gap (its power over the synchronous speed).
fn load_torque(study: &Study, waveform: &Waveform, rows: Range<usize>) -> f64 {
    let stride = waveform.samples_per_row();
    let r_s = study.prior.plant.motor.r_s;
    let n_p = study.prior.plant.rated.n_p;
    let torque = |row: usize| {
        let k = row * stride;
        if waveform.input_noise.torque > 0.0 {
            return waveform.inputs.tau_load[k];
        }
        let [a, b, c, ..] = waveform.measured[row];
        let i_s = clarke([a, b, c]);
        let power = 1.5 * ((waveform.inputs.u_s[k] - i_s * r_s) * i_s.conj()).re;
        power * n_p / waveform.timeline.omega_sync[k].abs().max(1.0)
    };
    let n = rows.len().max(1) as f64;
    rows.map(torque).sum::<f64>() / n
}

/// Load, voltage, slip and frequency of a block, percent of rated (slip: percent).
fn percents(study: &Study, waveform: &Waveform, rows: &Range<usize>) -> [f64; 4] {
    let rated = &study.prior.plant.rated;
    let stride = waveform.samples_per_row();
    let mean = |f: &dyn Fn(usize) -> f64| rows.clone().map(f).sum::<f64>() / rows.len() as f64;
    let sync = &waveform.timeline.omega_sync;
    let omega = mean(&|row| sync[(row * stride).min(sync.len() - 1)]);
    let speed = mean(&|row| {
        waveform
            .speed
            .get(row * stride)
            .copied()
            .unwrap_or(waveform.measured[row][3])
    });
    let voltage = mean(&|row| waveform.inputs.u_s[row * stride].norm());
    [
        100.0 * load_torque(study, waveform, rows.clone()) / rated.torque,
        100.0 * voltage / rated.voltage,
        100.0 * (1.0 - rated.n_p * speed / omega),
        100.0 * omega / rated.omega_sync,
    ]
}

/// Stretches of time in which the machine does the same.
fn regions(study: &Study, r: &[f64]) -> Vec<RegionReport> {
    let Some(waveform) = study.fitted.case.waveform() else {
        return Vec::new();
    };
    let mut groups: Vec<(String, Vec<Numbered>)> = Vec::new();
    for (k, rows) in waveform.blocks().into_iter().enumerate() {
        let name = state(study, waveform, &rows);
        match groups.last_mut() {
            Some((last, blocks)) if *last == name => blocks.push((k, rows)),
            _ => groups.push((name, vec![(k, rows)])),
        }
    }
    let report = |(name, blocks): &(String, Vec<Numbered>)| RegionReport {
        name: name.clone(),
        from_s: waveform.time_of(blocks[0].1.start),
        to_s: waveform.time_of(blocks[blocks.len() - 1].1.end - 1) + waveform.t_row(),
        error_over_noise: error_of(study, r, blocks),
    };
    groups.iter().map(report).collect()
}

fn bands(study: &Study, r: &[f64]) -> Vec<BandReport> {
    let Some(waveform) = study.fitted.case.waveform() else {
        return Vec::new();
    };
    let blocks: Vec<_> = waveform.blocks().into_iter().enumerate().collect();
    let values: Vec<[f64; 4]> = blocks
        .iter()
        .map(|(_, rows)| percents(study, waveform, rows))
        .collect();
    let mut out = Vec::new();
    for (k, quantity) in ["load", "voltage", "slip", "frequency"]
        .into_iter()
        .enumerate()
    {
        for pair in BANDS.windows(2) {
            let inside = |(b, _): &Numbered| (pair[0]..pair[1]).contains(&values[*b][k]);
            let part: Vec<_> = blocks.iter().filter(|b| inside(b)).cloned().collect();
            if !part.is_empty() {
                out.push(BandReport {
                    quantity: quantity.to_owned(),
                    from_percent: pair[0],
                    to_percent: pair[1],
                    error_over_noise: error_of(study, r, &part),
                });
            }
        }
    }
    out
}

/// Rotating components of the current error.
fn orders(case: &Case, r: &[f64]) -> Vec<OrderReport> {
    let Some(waveform) = case.waveform() else {
        return Vec::new();
    };
    let stride = waveform.samples_per_row();
    let error = |row: usize| {
        let at = |k: usize| {
            let w = waveform.weight[row][k];
            if w > 0.0 {
                r[row * N_CHANNELS + k] / w
            } else {
                0.0
            }
        };
        clarke([at(0), at(1), at(2)])
    };
    let one = |order: f64| {
        let turned = |row: usize| {
            let theta = waveform.supply.theta[(row * stride).min(waveform.supply.theta.len() - 1)];
            error(row) * Complex64::from_polar(1.0, -order * theta)
        };
        let sum: Complex64 = (0..waveform.weight.len()).map(turned).sum();
        OrderReport {
            order,
            amplitude_amp: sum.norm() / waveform.weight.len() as f64,
        }
    };
    ORDERS.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests;
