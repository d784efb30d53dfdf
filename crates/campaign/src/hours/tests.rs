//! Cycles show the monitor what samples show it.

use monitor::{MonitorState, Report};
use motor::MotorFile;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use replay::calibrate::Surroundings;
use scenario::simulate::Simulation;
use scenario::{Load, LoadSpec, Piecewise, Scenario, SupplySpec};

use super::cycles::Cycles;
use super::events::{components, sensors};
use super::instrument::Shown;
use super::learn::Watched;
use super::machine::Machine;
use super::operating::{Conditions, shows, warmed};
use super::{Doing, Event, live};

/// r1 to r4, significance over its limit, negative over positive sequence of the currents.
const FEATURES: usize = 6;
const NAMES: [&str; FEATURES] = ["r1", "r2", "r3", "r4", "significance", "I2/I1"];
/// Means may differ by this beside four standard errors: r in shares of their scales, the others as they are.
const MEANS: [f64; FEATURES] = [2e-4, 2e-4, 2e-4, 2e-4, 0.05, 2e-4];
/// And by this share: the negative sequence of cycles is off by half a percent, probably because an unbalance makes the speed ripple and cycles know no ripple.
const SHARE_OF_MEAN: f64 = 0.01;
/// Standard deviations may differ by these factors, where they are not both below a tenth of [`MEANS`]: 200 windows that share
/// their cycles tell a deviation to some 15 %. The negative sequence of cycles scatters more than that of samples, by up to three at
/// 1e-5 of the current: cycles are the harder ones there.
const DEVIATIONS: [f64; FEATURES] = [1.5, 1.5, 1.5, 1.5, 1.5, 2.5];
/// Shares of windows beyond half of the limit of FAULT may differ by this.
const SHARES: f64 = 0.1;
/// Windows of five cycles share four of them with their neighbours.
const IN_COMMON: f64 = 5.0;
const STEADY_S: f64 = 4.0;

struct Seen {
    reports: Vec<[f64; FEATURES]>,
    lit: usize,
}

impl Seen {
    fn of(reports: &[Report], limit: f64) -> Seen {
        let judged = reports.iter().filter(|report| report.is_judged());
        let lit = |report: &&Report| report.lamps.fault == monitor::Lamp::On;
        Seen {
            reports: judged
                .clone()
                .map(|report| features(report, limit))
                .collect(),
            lit: judged.filter(lit).count(),
        }
    }

    fn moments(&self, k: usize) -> [f64; 2] {
        let n = self.reports.len() as f64;
        let mean = self.reports.iter().map(|x| x[k]).sum::<f64>() / n;
        let square = self
            .reports
            .iter()
            .map(|x| (x[k] - mean).powi(2))
            .sum::<f64>()
            / n;
        [mean, square.sqrt()]
    }

    fn beyond_half(&self) -> f64 {
        let beyond = self.reports.iter().filter(|x| x[4] > 0.5).count();
        beyond as f64 / self.reports.len() as f64
    }
}

fn features(report: &Report, limit: f64) -> [f64; FEATURES] {
    let mut all = [0.0; FEATURES];
    let residuals = report
        .residuals
        .map_or([f32::NAN; 4], |residuals| residuals.r);
    for (x, r) in all.iter_mut().zip(residuals) {
        *x = f64::from(r);
    }
    all[4] = report.isolation.map_or(f64::NAN, |isolation| {
        f64::from(isolation.significance) / limit
    });
    all[5] = report.window.map_or(f64::NAN, |window| {
        let ratio = window.i_s.negative / window.i_s.positive;
        f64::from(ratio.norm())
    });
    all
}

/// Some seconds of samples, and where they leave the voltage.
fn by_samples(
    watched: &Watched,
    at: &Conditions,
    state: &mut MonitorState,
) -> (Vec<Report>, Complex64) {
    let machine = &watched.machine;
    let mut scenario = Scenario::of(warmed(&machine.truth, at.degc), 1.0 + STEADY_S);
    scenario.seed = 77;
    scenario.sensors = sensors(&machine.instrument, at.cabinet_degc, &scenario);
    scenario.supply = SupplySpec {
        amplitude_volt: Piecewise::constant(at.volt),
        frequency_hz: Piecewise::constant(at.hertz),
        components: components(machine, at),
        ..SupplySpec::rated(&machine.truth.nameplate)
    };
    scenario.load = LoadSpec {
        friction_factor: at.friction,
        other: Load::Constant {
            torque: at.torque,
            active: true,
        },
    };
    let simulation = Simulation::new(&scenario).expect("it carries its load");
    let converter = watched.config.converter;
    let mut reports = Vec::new();
    for (simulated, sample) in Shown::new(simulation, converter, &machine.instrument, false) {
        let report = watched.monitor.update(state, &sample);
        reports.extend(report.filter(|_| simulated.t > 1.0));
    }
    let last = reports
        .last()
        .and_then(|report| report.window)
        .expect("locked");
    let u = last.u_s.positive;
    (
        reports,
        Complex64::from_polar(1.0, f64::from(u.im.atan2(u.re))),
    )
}

fn by_cycles(
    watched: &Watched,
    at: &Conditions,
    state: &mut MonitorState,
    reference: Complex64,
) -> Vec<Report> {
    let machine = &watched.machine;
    let shown = shows(&machine.truth, &machine.instrument, &machine.harmonics, at);
    let shown = shown.expect("it carries its load");
    let mut random = Pcg64::seed_from_u64(5);
    let config = &watched.config;
    let mut cycles = Cycles::new(&machine.instrument, config, reference, false, &mut random);
    let count = (STEADY_S * at.hertz) as usize;
    (0..count)
        .map(|_| {
            let cycle = cycles.cycle(&shown, &shown, 0.5, &mut random);
            watched.monitor.update_cycle(state, &cycle)
        })
        .collect()
}

fn motors() -> Vec<MotorFile> {
    let names = ["assumed-300w", "peer-2k2", "imc-18k5"];
    let read = |name| MotorFile::read(format!("../../motors/{name}.toml")).expect("it ships");
    names.map(read).to_vec()
}

fn watched(seed: u64) -> Watched {
    let machine = Machine::draw(seed, &motors());
    let mut random = Pcg64::seed_from_u64(seed);
    Watched::learn(machine, &Surroundings::default(), &mut random).expect("it can be calibrated")
}

/// Loads and temperatures of a machine that its calibration did not see.
fn conditions(machine: &Machine, load: f64, kelvin: f64) -> Conditions {
    let plate = &machine.truth.nameplate;
    let torque = if machine.declares_friction() {
        0.0
    } else {
        load
    };
    Conditions {
        volt: machine.voltage * plate.phase_voltage_amplitude(),
        hertz: plate.frequency_hz + 0.03,
        unbalance: machine.unbalance,
        torque: torque * plate.torque_nm,
        friction: 1.0,
        degc: [40.0 + kelvin, 45.0 + kelvin],
        cabinet_degc: 35.0,
    }
}

#[test]
fn cycles_show_what_samples_show() {
    for seed in 0..5 {
        let watched = watched(seed);
        let limit = f64::from(watched.config.healthy.expect("calibrated").significance);
        for (load, kelvin) in [(0.25, 0.0), (0.85, 30.0)] {
            let at = conditions(&watched.machine, load, kelvin);
            let mut state = MonitorState::default();
            let (samples, reference) = by_samples(&watched, &at, &mut state);
            let cycles = by_cycles(&watched, &at, &mut state, reference);
            let [samples, cycles] = [samples, cycles].map(|all| Seen::of(&all, limit));
            let label = format!("{} at {load}", watched.machine.words);
            alike(&samples, &cycles, &label);
        }
    }
}

fn alike(samples: &Seen, cycles: &Seen, label: &str) {
    let counts = [samples, cycles].map(|seen| seen.reports.len());
    assert!(
        counts.iter().all(|count| *count > 150),
        "{label}: {counts:?} judged"
    );
    for k in 0..FEATURES {
        let [[mean, deviation], [mean_c, deviation_c]] =
            [samples, cycles].map(|seen| seen.moments(k));
        println!(
            "{label}: {} samples {mean:+.6} +- {deviation:.6}, cycles {mean_c:+.6} +- {deviation_c:.6}",
            NAMES[k]
        );
        let error =
            (IN_COMMON * (deviation.powi(2) + deviation_c.powi(2)) / counts[0] as f64).sqrt();
        let differs = (mean - mean_c).abs();
        assert!(
            differs < MEANS[k] + SHARE_OF_MEAN * mean.abs() + 4.0 * error
                || [mean, mean_c].iter().all(|mean| mean.is_nan()),
            "{label}: mean of {} {mean} by samples, {mean_c} by cycles",
            NAMES[k]
        );
        let floor = 0.1 * MEANS[k];
        let ratio = (deviation_c + floor) / (deviation + floor);
        assert!(
            (DEVIATIONS[k].recip()..DEVIATIONS[k]).contains(&ratio)
                || [deviation, deviation_c].iter().all(|x| x.is_nan()),
            "{label}: deviation of {} {deviation} by samples, {deviation_c} by cycles",
            NAMES[k]
        );
    }
    let shares = [samples, cycles].map(Seen::beyond_half);
    assert!(
        (shares[0] - shares[1]).abs() < SHARES,
        "{label}: {shares:?}"
    );
    assert_eq!(samples.lit > 0, cycles.lit > 0, "{label}: FAULT");
}

/// What is not right shows in cycles too: a magnetizing inductance that has lost 30 % lights FAULT.
#[test]
fn a_fault_lights_in_cycles() {
    let mut watched = watched(1);
    let at = conditions(&watched.machine, 0.7, 0.0);
    let mut state = MonitorState::default();
    let (_, reference) = by_samples(&watched, &at, &mut state);
    watched.machine.truth.parameters.l_m *= 0.7;
    let reports = by_cycles(&watched, &at, &mut state, reference);
    let last = reports.last().expect("cycles");
    assert_eq!(last.lamps.fault, monitor::Lamp::On);
}

/// The same seed lives the same day, with starts, stops and steps.
#[test]
fn a_day_is_lived_twice() {
    let watched = watched(3);
    let day = || {
        let (mut sum, mut starts, mut before) = (0.0_f64, 0, Doing::Steady);
        let ran = live(&watched, 0.3, 20.0, &mut |moment, report| {
            sum += report
                .residuals
                .map_or(0.0, |residuals| f64::from(residuals.r[0]));
            starts +=
                u32::from(moment.doing == Doing::Event(Event::Start) && before != moment.doing);
            before = moment.doing;
        });
        (sum, starts, ran)
    };
    let first = day();
    assert!(first.1 > 0, "{first:?}");
    assert_eq!(first, day());
}
