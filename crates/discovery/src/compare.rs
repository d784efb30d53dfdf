//! Where the model fails, as the motor file says it, nothing refitted.

use crate::api::{Progress, speed_scale_report};
use crate::case::{Case, N_CHANNELS};
use crate::fit::Effort;
use crate::inconclusive;
use crate::predict::{Teacher, outputs, residual};
use crate::question::{Error, Question};
use crate::report::{
    BandReport, CompareReport, Inconclusive, OrderReport, Overall, RegionReport, SignalReport,
    SpeedScaleReport,
};
use crate::study::Study;
use motor::MotorFile;
use motor::dynamic::clarke;
use num_complex::Complex64;
use recording::Source;
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
pub fn compare(
    sources: &[Source],
    motor: &MotorFile,
    progress: &mut Progress<'_>,
) -> Result<CompareReport, Error> {
    let empty = |audit| CompareReport {
        audit,
        signals: Vec::new(),
        regions: Vec::new(),
        bands: Vec::new(),
        orders: Vec::new(),
        overall: None,
        speed_scale: None,
        cannot_be_concluded: Vec::new(),
    };
    let question = match Question::new(&sources[..sources.len().min(1)], motor, progress) {
        Ok(question) => question,
        Err(Error::Unsupported(audit, _)) => return Ok(empty(*audit)),
        Err(error) => return Err(error),
    };
    progress("simulating", 0.5);
    let study = &question.study;
    let case = &study.fitted.case;
    let model = outputs(case, &study.belief, &study.beliefs(), Teacher::Off);
    let r = residual(case, &model);
    let (speed_scale, cannot_be_concluded) = scale_of(study).unzip();
    progress("done", 1.0);
    Ok(CompareReport {
        signals: signals(case, &r),
        regions: regions(study, &r),
        bands: bands(study, &r),
        orders: orders(case, &r),
        overall: Some(Overall {
            error_over_noise: study.fold_error(&[crate::gram::dot(&r, &r)]),
        }),
        speed_scale,
        cannot_be_concluded: cannot_be_concluded.unwrap_or_default(),
        ..empty(question.audit)
    })
}

/// The scale of the speed that suits the motor file as it is, where it was unknown, and what that leaves open.
fn scale_of(study: &Study) -> Option<(SpeedScaleReport, Vec<Inconclusive>)> {
    study.speed_scale?;
    let nothing_moved = Effort {
        iterations: 0,
        ..Effort::FULL
    };
    let trial = study.trial(&study.beliefs(), nothing_moved);
    let open = inconclusive::list(study, &trial, &[]);
    Some((speed_scale_report(study, &trial)?, open))
}

/// Names and units of the channels of a case.
fn channels(case: &Case) -> [(&'static str, &'static str); N_CHANNELS] {
    if case.table.is_some() {
        return [
            ("current", "A rms"),
            ("speed", "rad/s"),
            ("power_factor", "-"),
            ("efficiency", "-"),
            ("", ""),
        ];
    }
    [
        ("ia", "A"),
        ("ib", "A"),
        ("ic", "A"),
        ("speed", "rad/s"),
        ("v0", "V"),
    ]
}

fn signals(case: &Case, r: &[f64]) -> Vec<SignalReport> {
    let judged = |k: usize| case.weight.iter().filter(|w| w[k] > 0.0).count() as f64;
    let mean = |k: usize, f: &dyn Fn(usize, f64) -> f64| {
        let rows = (0..case.weight.len()).filter(|&row| case.weight[row][k] > 0.0);
        let sum: f64 = rows.map(|row| f(row, 1.0 / case.weight[row][k])).sum();
        (sum / judged(k)).sqrt()
    };
    let one = |(k, (name, unit)): (usize, (&str, &str))| {
        let error = mean(k, &|row, sigma| (r[row * N_CHANNELS + k] * sigma).powi(2));
        let ratio = mean(k, &|row, _| r[row * N_CHANNELS + k].powi(2));
        SignalReport {
            name: name.to_owned(),
            unit: unit.to_owned(),
            rms: mean(k, &|row, _| case.measured[row][k].powi(2)),
            error_rms: error,
            noise_floor: mean(k, &|_, sigma| sigma * sigma),
            error_over_noise: ratio,
        }
    };
    let known = channels(case).into_iter().enumerate();
    known.filter(|(k, _)| judged(*k) > 0.0).map(one).collect()
}

/// Error over noise of a set of blocks.
fn error_of(study: &Study, r: &[f64], blocks: &[Numbered]) -> f64 {
    let sse = |rows: &Range<usize>| {
        let part = &r[rows.start * N_CHANNELS..rows.end * N_CHANNELS];
        crate::gram::dot(part, part)
    };
    let error: f64 = blocks.iter().map(|(_, rows)| sse(rows)).sum();
    let floor: f64 = blocks
        .iter()
        .map(|(k, _)| study.fitted.floor.block[*k])
        .sum();
    (error / floor.max(f64::MIN_POSITIVE)).sqrt()
}

/// State of the machine in one block: what it does, its load and voltage in percent.
fn state(study: &Study, rows: &Range<usize>) -> String {
    let case = &study.fitted.case;
    let rated = &study.belief.plant.rated;
    let [load, voltage, slip, _] = percents(study, rows);
    let stride = case.between.stride() * case.decimation;
    let part = rows.start * stride..(rows.end * stride).min(case.inputs.u_s.len());
    if voltage < 2.0 {
        return "off".to_owned();
    }
    if slip > 20.0 {
        return "start-up".to_owned();
    }
    let torque = &case.inputs.tau_load[part.clone()];
    let half = torque.len() / 2;
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let step = (mean(&torque[..half]) - mean(&torque[half..])).abs();
    let stepped = case
        .supply
        .segments
        .iter()
        .any(|s| part.contains(&s.start) && s.start > 0);
    if step > 0.1 * rated.torque || stepped {
        return "step".to_owned();
    }
    let round = |x: f64| (x / 5.0).round() * 5.0 + 0.0; // -0 becomes 0: one region, not two
    format!("load {:.0} %, voltage {:.0} %", round(load), round(voltage))
}

/// Load, voltage, slip and frequency of a block, percent of rated (slip: percent).
fn percents(study: &Study, rows: &Range<usize>) -> [f64; 4] {
    let case = &study.fitted.case;
    let rated = &study.belief.plant.rated;
    let stride = case.between.stride() * case.decimation;
    let mean = |f: &dyn Fn(usize) -> f64| rows.clone().map(f).sum::<f64>() / rows.len() as f64;
    let sync = &case.timeline.omega_sync;
    let omega = mean(&|row| sync[(row * stride).min(sync.len() - 1)]);
    let speed = mean(&|row| {
        case.speed
            .get(row * stride)
            .copied()
            .unwrap_or(case.measured[row][3])
    });
    let voltage = mean(&|row| case.inputs.u_s[row * stride].norm());
    [
        100.0 * mean(&|row| case.inputs.tau_load[row * stride]) / rated.torque,
        100.0 * voltage / rated.voltage,
        100.0 * (1.0 - rated.n_p * speed / omega),
        100.0 * omega / rated.omega_sync,
    ]
}

/// Stretches of time in which the machine does the same.
fn regions(study: &Study, r: &[f64]) -> Vec<RegionReport> {
    let case = &study.fitted.case;
    if case.table.is_some() {
        return Vec::new();
    }
    let mut groups: Vec<(String, Vec<Numbered>)> = Vec::new();
    for (k, rows) in case.blocks().into_iter().enumerate() {
        let name = state(study, &rows);
        match groups.last_mut() {
            Some((last, blocks)) if *last == name => blocks.push((k, rows)),
            _ => groups.push((name, vec![(k, rows)])),
        }
    }
    let t_row = case.t_row();
    let report = |(name, blocks): &(String, Vec<Numbered>)| RegionReport {
        name: name.clone(),
        from_s: blocks[0].1.start as f64 * t_row,
        to_s: blocks[blocks.len() - 1].1.end as f64 * t_row,
        error_over_noise: error_of(study, r, blocks),
    };
    groups.iter().map(report).collect()
}

fn bands(study: &Study, r: &[f64]) -> Vec<BandReport> {
    let case = &study.fitted.case;
    if case.table.is_some() {
        return Vec::new();
    }
    let blocks: Vec<_> = case.blocks().into_iter().enumerate().collect();
    let values: Vec<[f64; 4]> = blocks
        .iter()
        .map(|(_, rows)| percents(study, rows))
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
    if case.table.is_some() {
        return Vec::new();
    }
    let stride = case.between.stride() * case.decimation;
    let error = |row: usize| {
        let at = |k: usize| {
            let w = case.weight[row][k];
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
            let theta = case.supply.theta[(row * stride).min(case.supply.theta.len() - 1)];
            error(row) * Complex64::from_polar(1.0, -order * theta)
        };
        let sum: Complex64 = (0..case.weight.len()).map(turned).sum();
        OrderReport {
            order,
            amplitude_amp: sum.norm() / case.weight.len() as f64,
        }
    };
    ORDERS.into_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;

    /// A model that is exactly right, but for what `error` adds to a channel in units of its noise.
    fn residual_of(study: &Study, error: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let rows = 0..study.fitted.case.measured.len();
        rows.flat_map(|row| (0..N_CHANNELS).map(move |k| (row, k)))
            .map(|(row, k)| error(row, k))
            .collect()
    }

    #[test]
    fn load_voltage_slip_and_frequency_are_percent_of_rated() {
        let study = specimen::study(0.5, |_| 1.0);
        let point = specimen::point(1.0);
        let [load, voltage, slip, frequency] = percents(&study, &(500..600));
        assert!((load - 100.0 / 1.7).abs() < 1e-6, "{load}");
        assert!((voltage - 100.0).abs() < 0.1, "{voltage}");
        let expected = 100.0 * point.omega_slip / point.omega_sync;
        assert!((slip - expected).abs() < 0.02, "{slip} {expected}");
        assert!((frequency - 100.0).abs() < 0.02, "{frequency}");
    }

    /// Steady at 0.6 and at 1.3 N m: 35 and 75 per cent of 1.7 N m to the nearest five; between them a step.
    #[test]
    fn regions_follow_what_the_machine_does() {
        let study = specimen::study(1.0, |t| if t < 0.5 { 0.6 } else { 1.3 });
        let r = residual_of(&study, |_, _| 2.0);
        let regions = regions(&study, &r);
        let names: Vec<&str> = regions.iter().map(|r| r.name.as_str()).collect();
        let expected = [
            "load 35 %, voltage 100 %",
            "step",
            "load 75 %, voltage 100 %",
        ];
        assert_eq!(names, expected);
        assert_eq!(regions[0].from_s, 0.0);
        assert!(
            (regions[1].from_s..regions[1].to_s).contains(&0.5),
            "{regions:?}"
        );
        assert!(regions.windows(2).all(|w| w[0].to_s == w[1].from_s));
        assert!((regions[2].to_s - 1.0).abs() < 1e-9);
        for region in &regions {
            // Twice the sensors' noise over a floor that holds a little of the inputs' noise as well.
            let floor = study.fitted.floor.mean.sqrt();
            assert!(
                (region.error_over_noise * floor / 2.0 - 1.0).abs() < 0.05,
                "{region:?}"
            );
        }
    }

    #[test]
    fn a_machine_that_is_off_or_starts_is_no_load() {
        let mut study = specimen::study(0.5, |_| 1.0);
        study.fitted.case.speed.iter_mut().for_each(|w| *w *= 0.7);
        assert_eq!(state(&study, &(500..600)), "start-up");
        study
            .fitted
            .case
            .inputs
            .u_s
            .iter_mut()
            .for_each(|u| *u *= 0.01);
        assert_eq!(state(&study, &(500..600)), "off");
    }

    #[test]
    fn a_step_of_the_voltage_is_a_step() {
        let mut study = specimen::study(0.5, |_| 1.0);
        assert_eq!(state(&study, &(500..600)), "load 60 %, voltage 100 %");
        study.fitted.case.supply.segments = vec![0..1050, 1050..2500];
        assert_eq!(state(&study, &(500..600)), "step");
        assert_eq!(state(&study, &(600..700)), "load 60 %, voltage 100 %");
        assert_eq!(
            state(&study, &(0..100)),
            "load 60 %, voltage 100 %",
            "the beginning is no step"
        );
    }

    /// Each block lies in one band of each quantity.
    #[test]
    fn bands_hold_the_blocks_of_their_range() {
        let study = specimen::study(1.0, |t| if t < 0.5 { 0.6 } else { 1.3 });
        let half = study.fitted.case.measured.len() / 2;
        let r = residual_of(&study, |row, _| if row < half { 1.0 } else { 3.0 });
        let bands = bands(&study, &r);
        let of = |quantity: &str| -> Vec<(f64, f64, f64)> {
            let mine = bands.iter().filter(|b| b.quantity == quantity);
            mine.map(|b| (b.from_percent, b.to_percent, b.error_over_noise))
                .collect()
        };
        let load = of("load");
        assert_eq!(load.len(), 3, "{load:?}");
        assert_eq!((load[0].0, load[0].1), (25.0, 50.0));
        assert_eq!((load[1].0, load[1].1), (50.0, 75.0));
        assert_eq!((load[2].0, load[2].1), (75.0, 95.0));
        // The floor holds a little of the inputs' noise beside the sensors'.
        assert!((0.85..1.0).contains(&load[0].2), "{load:?}");
        assert!((load[2].2 / load[0].2 / 3.0 - 1.0).abs() < 0.05, "{load:?}");
        assert_eq!(of("voltage").len(), 1);
        assert_eq!((of("frequency")[0].0, of("frequency")[0].1), (95.0, 105.0));
        assert_eq!((of("slip")[0].0, of("slip")[0].1), (0.0, 5.0));
    }

    /// Root mean squares in the channel's unit: an error of three noises in one channel.
    #[test]
    fn signals_are_compared_in_their_units() {
        let study = specimen::study(0.5, |_| 1.0);
        let case = &study.fitted.case;
        let r = residual_of(&study, |_, k| if k == 3 { 3.0 } else { 0.0 });
        let all = signals(case, &r);
        let names: Vec<_> = all
            .iter()
            .map(|s| (s.name.as_str(), s.unit.as_str()))
            .collect();
        let expected = [
            ("ia", "A"),
            ("ib", "A"),
            ("ic", "A"),
            ("speed", "rad/s"),
            ("v0", "V"),
        ];
        assert_eq!(names, expected);
        let speed = &all[3];
        assert!((speed.error_over_noise - 3.0).abs() < 1e-9);
        assert!((speed.noise_floor - 0.2).abs() < 1e-9 && (speed.error_rms - 0.6).abs() < 1e-9);
        assert!((speed.rms - specimen::point(1.0).omega_mech).abs() < 1e-6);
        let current = &all[0];
        assert_eq!((current.error_rms, current.error_over_noise), (0.0, 0.0));
        let amplitude = specimen::point(1.0).i_s.norm();
        assert!((current.rms / (amplitude / 2f64.sqrt()) - 1.0).abs() < 1e-3);
        let mut blind = case.clone();
        blind.weight.iter_mut().for_each(|w| w[3] = 0.0);
        assert!(signals(&blind, &r).iter().all(|s| s.name != "speed"));
    }

    /// An error of the currents that turns backwards at 0.1 A is the order -1.
    #[test]
    fn a_rotating_error_is_found_at_its_order() {
        let study = specimen::study(0.5, |_| 1.0);
        let case = &study.fitted.case;
        let error = |row: usize, k: usize| {
            if k > 2 {
                return 0.0;
            }
            let theta = -case.supply.theta[2 * row] + 0.6;
            let shift = [0.0, -1.0, 1.0][k] * std::f64::consts::TAU / 3.0;
            0.1 * (theta + shift).cos() * case.weight[row][k]
        };
        let found = orders(case, &residual_of(&study, error));
        let at = |order: f64| {
            found
                .iter()
                .find(|o| o.order == order)
                .expect("listed")
                .amplitude_amp
        };
        assert!((at(-1.0) - 0.1).abs() < 1e-3, "{found:?}");
        for order in [0.0, 1.0, -5.0, 7.0, -11.0, 13.0] {
            assert!(at(order) < 2e-3, "{found:?}");
        }
    }

    #[test]
    fn a_table_has_signals_of_its_own_and_no_time() {
        let study = specimen::table_study(|_| ());
        let r = residual_of(&study, |_, _| 0.0);
        assert!(regions(&study, &r).is_empty() && bands(&study, &r).is_empty());
        assert!(orders(&study.fitted.case, &r).is_empty());
        let names: Vec<_> = signals(&study.fitted.case, &r)
            .into_iter()
            .map(|s| s.name)
            .collect();
        assert_eq!(names, ["current", "speed", "power_factor", "efficiency"]);
    }

    /// The whole question on a recording of the believed machine without noise, and with a speed that is off by three
    /// of its noise: 9 in one of five channels.
    #[test]
    fn a_comparison_holds_signals_regions_bands_and_orders() {
        let exact = specimen::recording(1.0, |_| 1.0);
        let off = exact
            .speed()
            .expect("measured")
            .iter()
            .map(|w| w + 3.0 * specimen::SIGMA[2]);
        let off = exact
            .clone()
            .with_channel(recording::Channel::SPEED, off.collect())
            .expect("as long");
        let mut told = Vec::new();
        let mut error = |rec: &recording::Recording| {
            let mut progress = |what: &str, share: f64| told.push((what.to_owned(), share));
            let source = Source::Recording(rec.clone());
            let report = compare(
                &[source.clone(), source],
                &specimen::motor(""),
                &mut progress,
            )
            .expect("judged");
            assert!(report.audit.supported);
            assert_eq!(
                (report.signals.len(), report.orders.len()),
                (5, ORDERS.len())
            );
            assert!(!report.regions.is_empty() && !report.bands.is_empty());
            report.overall.expect("judged").error_over_noise
        };
        let (exact, off) = (error(&exact), error(&off));
        assert!(exact < 0.5, "{exact}");
        assert!((1.0..1.5).contains(&off), "{off}");
        assert!(told.windows(2).take(2).all(|w| w[0].1 <= w[1].1));
        assert_eq!(told.last().map(|t| t.1), Some(1.0));
        assert!(compare(&[], &specimen::motor(""), &mut |_, _| {}).is_err());
    }
}
