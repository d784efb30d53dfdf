//! A small motor for the tests of this crate: its motor file, and recordings of it in steady state in closed form.

use crate::data::case::{Case, Waveform};
use crate::data::channels::N_CHANNELS;
use crate::data::load_table::table_values;
use crate::data::study::{Study, Subject, Trial};
use crate::fit::normal_equations::{Block, Penalty};
use crate::fit::output_error::Effort;
use crate::model::free_scale::FreeScale;
use crate::model::prior::{FRICTION, Hypothesis, Prior};
use motor::MotorFile;
use motor::effect::{EffectConfig, Plant, from_motor_file};
use motor::effects::find;
use motor::steady_state::{OperatingPoint, SteadyState};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use recording::{
    Channel, LoadTable, LoadTorque, Metadata, Recording, Sensors, Source, StartsFrom, UNITS,
    UnknownScale,
};
use std::sync::OnceLock;

const MOTOR: &str = r#"
name = "specimen"
[nameplate]
pole_pairs = 2
power_watt = 300.0
voltage_line_rms_volt = 220.0
current_rms_amp = 1.3
frequency_hz = 60.0
torque_nm = 1.7
connection = "star"
[parameters]
stator_resistance_ohm = 8.0
rotor_resistance_ohm = 7.0
stator_leakage_henry = 0.028
rotor_leakage_henry = 0.035
magnetizing_inductance_henry = 0.42
inertia_kg_m2 = 0.002
friction_nm_s = 0.0008
load_friction_nm_s = 0.0
[load]
kind = "measured"
"#;

/// The motor with more lines in its file.
pub fn motor(rest: &str) -> MotorFile {
    MotorFile::parse(&format!("{MOTOR}{rest}"), "specimen.toml").expect("a valid motor file")
}

/// What is believed of the motor with more lines in its file.
pub fn prior(rest: &str) -> Prior {
    let file = motor(rest);
    let effects = from_motor_file(&file, "specimen.toml").expect("valid effects");
    Prior::new(&file, effects)
}

/// Sampling time, s.
pub const T_SAMPLE: f64 = 2e-4;

/// Noise that the instrument declares, but the samples do not have: standard deviations of V, A, rad/s, N m.
pub const SIGMA: [f64; 4] = [0.4, 0.005, 0.2, 0.002];

/// The motor's steady state at this brake torque, N m.
pub fn point(torque: f64) -> OperatingPoint<f64> {
    let plant = prior("").plant;
    let u = Complex64::new(plant.rated.voltage, 0.0);
    let curve = SteadyState::new(&plant.motor, plant.mechanics.n_p, u, plant.rated.omega_sync);
    let friction = plant.mechanics.total_friction();
    curve
        .at_load(|omega| torque + friction * omega)
        .expect("below breakdown")
}

fn metadata() -> Metadata {
    Metadata {
        load_torque: LoadTorque::Measured,
        starts_from: StartsFrom::Running,
        sensors: Sensors {
            voltage_full_scale_volt: Some(400.0),
            current_full_scale_amp: Some(5.0),
            speed_full_scale_rad_s: Some(200.0),
            torque_full_scale_nm: Some(2.0),
            noise_sigma_fraction_of_full_scale: Some(0.001),
            ..Sensors::default()
        },
        ..Metadata::default()
    }
}

/// Phase quantities of a space vector that turns with the supply.
fn phases(x: Complex64, t: f64, omega: f64) -> [f64; 3] {
    let third = std::f64::consts::TAU / 3.0;
    [0.0, -third, third].map(|shift| (x * Complex64::from_polar(1.0, omega * t + shift)).re)
}

/// A motor that runs at `torque(t)`, N m, each instant as if it had always been so.
pub fn recording(seconds: f64, torque: impl Fn(f64) -> f64) -> Recording {
    recorded(seconds, &torque)
}

/// Compiled once for all tests.
fn recorded(seconds: f64, torque: &dyn Fn(f64) -> f64) -> Recording {
    let n = (seconds / T_SAMPLE).round() as usize;
    let t: Vec<f64> = (0..n).map(|k| k as f64 * T_SAMPLE).collect();
    let mut columns = vec![Vec::new(); 8];
    let (mut last, mut at) = (f64::NAN, point(0.0));
    for &t in &t {
        let tau = torque(t);
        if tau != last {
            (last, at) = (tau, point(tau));
        }
        let u = phases(at.u_s, t, at.omega_sync);
        let i = phases(at.i_s, t, at.omega_sync);
        let all = u.into_iter().chain(i).chain([at.omega_mech, tau]);
        for (column, x) in columns.iter_mut().zip(all) {
            column.push(x);
        }
    }
    let channels = Channel::VOLTAGES
        .into_iter()
        .chain(Channel::CURRENTS)
        .chain([Channel::SPEED, Channel::TORQUE]);
    let empty = Recording::new("specimen", t, metadata()).expect("an even clock");
    channels.zip(columns).fold(empty, |rec, (channel, values)| {
        rec.with_channel(channel, values)
            .expect("as long as the clock")
    })
}

/// A study of one such recording.
pub fn study(seconds: f64, torque: impl Fn(f64) -> f64) -> Study {
    let prior = prior("");
    let case = Case::new(&recording(seconds, torque), &prior.plant.rated).expect("judged");
    Study::new(prior, case, Vec::new(), None)
}

/// The measured rows of a case, to be changed.
pub fn measured_of(case: &mut Case) -> &mut [[f64; N_CHANNELS]] {
    match case {
        Case::Waveform(waveform) => &mut waveform.measured,
        Case::LoadTable(table) => &mut table.measured,
    }
}

/// The weights of a case, to be changed.
pub fn weight_of(case: &mut Case) -> &mut [[f64; N_CHANNELS]] {
    match case {
        Case::Waveform(waveform) => &mut waveform.weight,
        Case::LoadTable(table) => &mut table.weight,
    }
}

/// The samples of a study of a recording.
///
/// # Panics
/// With a study of a load table.
pub fn waveform_of(study: &Study) -> &Waveform {
    study.fitted.case.waveform().expect("a recording")
}

/// The same to be changed.
///
/// # Panics
/// With a study of a load table.
pub fn waveform_mut_of(study: &mut Study) -> &mut Waveform {
    study.fitted.case.waveform_mut().expect("a recording")
}

/// The priors of a study as they are, hardly fitted.
pub fn trial(study: &Study) -> Trial {
    let effort = Effort {
        iterations: 1,
        ..Effort::FULL
    };
    study.trial(&study.at_prior(), effort)
}

/// Shaft powers of a table, W: from idling to rated power.
fn loads() -> Vec<f64> {
    (0..12).map(|k| 27.0 * f64::from(k)).collect()
}

/// A load table of the motor at these shaft powers, W, its columns in closed form; `change` makes the machine another
/// than believed.
fn table_at(watts: Vec<f64>, change: &dyn Fn(&mut Plant)) -> LoadTable {
    use recording::TableColumn::{Current, Efficiency, Power, PowerFactor, Speed};
    let mut plant = prior("").plant;
    change(&mut plant);
    let asked = [
        (Power, watts.clone()),
        (Current, vec![1.0; watts.len()]),
        (Speed, vec![1750.0; watts.len()]),
    ];
    let asked = LoadTable::new("asked", asked.into_iter().collect()).expect("a valid table");
    let values: Vec<[f64; 4]> = table_values(&asked, &plant).into_iter().flatten().collect();
    let column = |k: usize| values.iter().map(|v| v[k]).collect::<Vec<f64>>();
    let rpm = 60.0 / std::f64::consts::TAU;
    let columns = [
        (Power, watts),
        (Current, column(0)),
        (Speed, column(1).iter().map(|w| w * rpm).collect()),
        (PowerFactor, column(2)),
        (Efficiency, column(3).iter().map(|x| x.max(0.0)).collect()),
    ];
    LoadTable::new("table", columns.into_iter().collect()).expect("a valid table")
}

/// A load table of a machine other than believed, as a source.
pub fn table_source(change: impl Fn(&mut Plant)) -> Source {
    Source::LoadTable(table_at(loads(), &change))
}

/// A load table of a machine other than believed, as a study.
pub fn table_study(change: impl Fn(&mut Plant)) -> Study {
    let prior = prior("");
    let case = Case::of_table(&table_at(loads(), &change), &prior.plant.rated);
    Study::new(prior, case.expect("twelve points"), Vec::new(), None)
}

/// The same with a second table of the machine that proves.
pub fn proven_table_study(change: impl Fn(&mut Plant)) -> Study {
    let prior = prior("");
    let between = loads().iter().map(|x| x + 11.0).collect();
    let [fitted, proof] = [loads(), between].map(|watts| {
        Case::of_table(&table_at(watts, &change), &prior.plant.rated).expect("twelve points")
    });
    Study::new(prior, fitted, vec![proof], None)
}

/// An effect with its first parameter so many typical sizes large.
pub fn effect(name: &str, size: f64) -> EffectConfig {
    let rated = prior("").plant.rated;
    let mut config = EffectConfig::absent(find(name, "").expect("in the library"), &rated);
    let p = &config.effect.descriptor().parameters[0];
    config.values[0] = size * p.typical * p.scale.of(&rated);
    config
}

/// A trial with these effects on top of the priors, nothing moved.
pub fn trial_with(study: &Study, effects: &[(&str, f64)]) -> Trial {
    let rated = &study.prior.plant.rated;
    let add = |h: Hypothesis, (name, size): &(&str, f64)| h.with(effect(name, *size), rated);
    let nothing_moved = Effort {
        iterations: 0,
        ..Effort::FULL
    };
    study.trial(&effects.iter().fold(study.at_prior(), add), nothing_moved)
}

/// Squared errors of so many blocks that make up an error over noise.
fn squares(floor: f64, blocks: usize, error: f64) -> Vec<f64> {
    vec![error * error * floor / blocks as f64; blocks]
}

/// The trial as if its errors over noise were these, on the folds and on what proves.
pub fn with_errors(study: &Study, trial: &Trial, folds: f64, proof: f64) -> Trial {
    let expected = |s: &Subject| s.floor.mean * s.case.judged();
    let proofs: f64 = study.proofs.iter().map(expected).sum();
    Trial {
        folds: squares(expected(&study.fitted), trial.folds.len(), folds),
        proof: squares(proofs, trial.proof.len(), proof),
        ..trial.clone()
    }
}

/// The trial as if its fitted coordinates had these standard errors, none of them correlated.
pub fn known_to(trial: &Trial, errors: &[f64]) -> Trial {
    let n = trial.fit.free.len();
    assert_eq!(errors.len(), n, "one for each fitted coordinate");
    let precision = DVector::from_iterator(n, errors.iter().map(|e| e.powi(-2)));
    let mut known = trial.clone();
    known.fit.inflation = 1.0;
    known.fit.penalty = Penalty {
        weight: DVector::zeros(n),
        pull: DVector::zeros(n),
    };
    known.fit.blocks = vec![Block {
        gram: DMatrix::from_diagonal(&precision),
        score: DVector::zeros(n),
        sse: 0.0,
    }];
    let variance = errors.iter().map(|e| e * e);
    known.covariance = OnceLock::from(DMatrix::from_diagonal(&DVector::from_iterator(n, variance)));
    known
}

/// A study of steady running whose speed channel shows `gain` times the speed, in an unknown unit.
pub fn scaled_study(seconds: f64, gain: f64) -> Study {
    let prior = prior("");
    let rated = &prior.plant.rated;
    let rec = unknown_speed(seconds, gain);
    let scale = FreeScale::start(&[&rec], rated).expect("it runs");
    let waveform = Waveform {
        speed_scale_is_free: true,
        ..Waveform::new(&scale.applied(&rec), rated).expect("judged")
    };
    Study::new(prior, waveform.into(), Vec::new(), Some(scale))
}

/// The recording of such a study, at the torque of 1 N m.
pub fn unknown_speed(seconds: f64, gain: f64) -> Recording {
    let rec = recording(seconds, |_| 1.0);
    let shown = rec.speed().expect("measured").iter().map(|w| gain * w);
    let shown = shown.collect();
    let mut rec = rec.with_channel(Channel::SPEED, shown).expect("as long");
    let unit = UNITS.into_iter().find(|unit| unit.name == "rad/s");
    rec.unknown_speed_scale = Some(Box::new(UnknownScale {
        unit: unit.expect("a unit"),
        offset: None,
    }));
    rec
}

/// A plant with an effect more.
pub fn with(name: &'static str, size: f64) -> impl Fn(&mut Plant) {
    move |plant| plant.effects.push(effect(name, size))
}

/// 220 V and 1.3 A: the power to which a core loss is related, W.
pub fn apparent_power() -> f64 {
    3f64.sqrt() * 220.0 * 1.3
}

/// The priors with nominals moved, each of the fitted ones known to `error`.
pub fn moved(study: &Study, effects: &[(&str, f64)], z: &[(usize, f64)], error: f64) -> Trial {
    let mut trial = trial_with(study, effects);
    for &(k, z) in z {
        trial.fit.hypothesis.z[k] = z;
    }
    if !trial.fit.free.contains(&FRICTION) {
        // A table does not fit the friction; here it is to be judged like the others.
        trial.fit.free.insert(4, FRICTION);
    }
    let errors = vec![error; trial.fit.free.len()];
    known_to(&trial, &errors)
}

/// The same recording with its channels changed, or without them.
pub fn changed(
    rec: &Recording,
    change: impl Fn(Channel, Vec<f64>) -> Option<Vec<f64>>,
) -> Recording {
    let empty = Recording::new("changed", rec.t().to_vec(), rec.metadata.clone());
    rec.channels()
        .fold(empty.expect("a clock"), |to, (channel, x)| {
            match change(channel, x.to_vec()) {
                Some(x) => to.with_channel(channel, x).expect("as long"),
                None => to,
            }
        })
}
