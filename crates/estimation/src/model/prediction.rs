//! Weighted residuals of a hypothesis, and their derivatives.

use crate::data::case::{Case, Waveform};
use crate::data::channels::{N_CHANNELS, SPEED};
use crate::data::load_table::{self, LoadPoints, Point};
use crate::model::prior::{Hypothesis, Prior};
use motor::dynamic::cycle_components;
use motor::effect::{
    Inputs, Outputs, Plant, Run, SpeedSource, StateOffset, simulate, simulate_coarsely,
};
use motor::steady_state::SteadyState;
use num_complex::Complex64;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};

/// Recordings simulated by this process so far.
static SIMULATIONS: AtomicU64 = AtomicU64::new(0);

/// How many times this process has simulated a recording: what a search costs, whatever the machine.
pub fn simulations() -> u64 {
    SIMULATIONS.load(Ordering::Relaxed)
}

/// How the speed is treated in a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedObserver {
    /// The model runs freely.
    Off,
    /// The model's speed is drawn to the measured one at this rate, 1/s.
    On(f64),
}

/// What drives a model: voltage, load torque, and the speed where it is given.
#[derive(Clone, Debug)]
pub struct Drive<'a> {
    /// Voltage and load torque.
    pub inputs: Cow<'a, Inputs>,
    /// Smoothed speed, rad/s; empty without a speed channel.
    pub speed: Cow<'a, [f64]>,
    /// Offsets of the state.
    pub offsets: &'a [StateOffset],
}

impl<'a> Drive<'a> {
    /// As the recording has it.
    pub fn of(waveform: &'a Waveform) -> Self {
        Self {
            inputs: Cow::Borrowed(&waveform.inputs),
            speed: Cow::Borrowed(&waveform.speed),
            offsets: &[],
        }
    }
}

/// Simulates a plant on what drives it.
pub fn run(
    waveform: &Waveform,
    plant: &Plant,
    drive: &Drive<'_>,
    observer: SpeedObserver,
) -> Outputs {
    driven(waveform, plant, drive, observer, 1, |run| {
        simulate(plant, run)
    })
}

/// Does something with the run of a plant that costs as much as so many simulations.
pub fn driven<T>(
    waveform: &Waveform,
    plant: &Plant,
    drive: &Drive<'_>,
    observer: SpeedObserver,
    simulations: u64,
    of: impl FnOnce(&Run<'_>) -> T,
) -> T {
    SIMULATIONS.fetch_add(simulations, Ordering::Relaxed);
    let speeds = waveform.speeds(plant, &drive.speed);
    let speed = match observer {
        _ if waveform.speed_is_input => SpeedSource::Imposed(&speeds.speed),
        SpeedObserver::On(rate) if !drive.speed.is_empty() => {
            SpeedSource::Observed(&speeds.speed, rate)
        }
        _ => SpeedSource::Free,
    };
    let starts = |measured: f64, k: usize| match waveform.settles {
        true => carried_speed(plant, &drive.inputs, speeds.timeline.omega_sync[k], k)
            .unwrap_or(measured),
        false => measured,
    };
    let cuts = speeds.timeline.cuts.iter().zip(&speeds.running_at_cuts);
    let running_at_cuts: Vec<Option<f64>> = cuts
        .map(|(cut, omega)| omega.map(|omega| starts(omega, cut.sample)))
        .collect();
    of(&Run {
        inputs: &drive.inputs,
        between: waveform.between,
        speed,
        timeline: &speeds.timeline,
        running_at: speeds.running_at.map(|measured| starts(measured, 0)),
        running_at_cuts: &running_at_cuts,
        open: &waveform.open,
        offsets: drive.offsets,
    })
}

/// Speed at which the motor carries what sample `k` asks of it, rad/s, on a supply of `omega_sync`, rad/s; `None` beyond breakdown.
pub fn carried_speed(plant: &Plant, inputs: &Inputs, omega_sync: f64, k: usize) -> Option<f64> {
    let torque = *inputs.tau_load.get(k)?;
    let cycle = cycle_components(inputs.u_s.get(k..)?, omega_sync, inputs.t_sample);
    let positive = cycle.iter().find(|part| part.omega == omega_sync)?;
    let amplitude = Complex64::new(positive.u.norm(), 0.0);
    let friction = plant.mechanics.total_friction();
    let curve = SteadyState::new(&plant.motor, plant.mechanics.n_p, amplitude, omega_sync);
    let point = curve.at_load(|omega| torque + friction * omega);
    point.ok().map(|point| point.omega_mech)
}

/// Weighted model outputs, row after row, without what the unknown state of the motor moves in them. A model that left the
/// finite numbers counts as infinitely wrong.
pub fn weighted(waveform: &Waveform, outputs: &Outputs) -> Vec<f64> {
    let mut rows = as_shown(waveform, outputs);
    waveform.nuisance.project_out(&mut rows);
    rows
}

/// Weighted model outputs, row after row.
pub(crate) fn as_shown(waveform: &Waveform, outputs: &Outputs) -> Vec<f64> {
    let mut out = Vec::with_capacity(waveform.measured.len() * N_CHANNELS);
    for (row, w) in waveform.weight.iter().enumerate() {
        let k = row * waveform.decimation;
        let [a, b, c] = outputs.i_s_abc[k];
        let values = [a, b, c, outputs.omega_mech[k], outputs.u_zero[k]];
        out.extend(values.iter().zip(w).map(|(x, w)| x * w));
    }
    out
}

/// The weighted speed of each row, of a speed that an instrument shows, rad/s.
pub(crate) fn speed_shown(waveform: &Waveform, omega_mech: &[f64]) -> Vec<f64> {
    let speeds = omega_mech.iter().step_by(waveform.decimation);
    let both = waveform.weight.iter().zip(speeds);
    both.map(|(w, omega)| omega * w[SPEED]).collect()
}

/// Weighted outputs of a load table.
fn steady(table: &LoadPoints, plant: &Plant) -> Vec<f64> {
    let row = |(point, w): (&Point, &[f64; N_CHANNELS])| {
        let values = load_table::predict(plant, point);
        let weight = *w;
        (0..N_CHANNELS).map(move |k| values[k] * weight[k])
    };
    table
        .points
        .iter()
        .zip(&table.weight)
        .flat_map(row)
        .collect()
}

/// Weighted outputs of a hypothesis.
pub fn outputs(case: &Case, prior: &Prior, h: &Hypothesis, observer: SpeedObserver) -> Vec<f64> {
    coarse_outputs(case, prior, h, observer, 1)
}

/// The same with so many integration steps taken at once (1 or more); a load table has none.
pub(crate) fn coarse_outputs(
    case: &Case,
    prior: &Prior,
    h: &Hypothesis,
    observer: SpeedObserver,
    at_once: usize,
) -> Vec<f64> {
    let plant = h.plant(prior);
    match case {
        Case::LoadTable(table) => steady(table, &plant),
        Case::Waveform(waveform) => {
            let simulated = |run: &Run<'_>| simulate_coarsely(&plant, run, at_once);
            let drive = Drive::of(waveform);
            weighted(
                waveform,
                &driven(waveform, &plant, &drive, observer, 1, simulated),
            )
        }
    }
}

/// Weighted outputs of a plant that something else drives (noise propagation).
pub fn outputs_on(waveform: &Waveform, plant: &Plant, drive: &Drive<'_>) -> Vec<f64> {
    weighted(waveform, &run(waveform, plant, drive, SpeedObserver::Off))
}

/// Residual: weighted measurement minus weighted model ([`weighted`]), both without what nobody knows of the motor's state.
pub fn residual(case: &Case, model: &[f64]) -> Vec<f64> {
    let measured = case.measured().iter().zip(case.weight());
    let rows = measured.flat_map(|(y, w)| (0..N_CHANNELS).map(move |k| y[k] * w[k]));
    let mut rows: Vec<f64> = rows.collect();
    case.project_out(&mut rows);
    rows.iter_mut().zip(model).for_each(|(y, m)| *y -= m);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;

    #[test]
    fn the_believed_table_leaves_nothing() {
        let study = specimen::table_study(|_| ());
        let (case, prior) = (&study.fitted.case, &study.prior);
        let model = outputs(case, prior, &study.at_prior(), SpeedObserver::Off);
        assert_eq!(model.len(), 12 * N_CHANNELS);
        assert!(residual(case, &model).iter().all(|r| r.abs() < 1e-4));
        // In units of the accuracy: one revolution per minute is one.
        let mut slower = study.fitted.case.clone();
        let Case::LoadTable(table) = &mut slower else {
            panic!("a table");
        };
        let rows = table.measured.iter_mut();
        rows.for_each(|row| row[1] -= 2.0 * std::f64::consts::TAU / 60.0);
        for row in residual(&slower, &model).chunks(N_CHANNELS) {
            assert!((row[1] + 2.0).abs() < 1e-3 && row[0].abs() < 1e-3);
        }
    }

    /// A free run settles at the operating point of the closed form; each row is weighed by its noise.
    #[test]
    fn a_recording_is_simulated_row_by_row() {
        let study = specimen::study(1.0, |_| 1.0);
        let (case, prior) = (&study.fitted.case, &study.prior);
        let before = simulations();
        let model = outputs(case, prior, &study.at_prior(), SpeedObserver::Off);
        assert!(simulations() > before);
        let (measured, weight) = (case.measured(), case.weight());
        let row = measured.len() - 1;
        for k in 0..N_CHANNELS {
            let got = model[row * N_CHANNELS + k] / weight[row][k];
            let scale = measured[row][k].abs().max(0.1);
            assert!((got - measured[row][k]).abs() < 0.02 * scale, "{k}: {got}");
        }
        // Drawn to the measured speed the start is over sooner.
        let speed_error = |observer| {
            let model = outputs(case, prior, &study.at_prior(), observer);
            let rows = residual(case, &model);
            rows.chunks(N_CHANNELS).map(|r| r[3] * r[3]).sum::<f64>()
        };
        assert!(speed_error(SpeedObserver::On(200.0)) < 0.5 * speed_error(SpeedObserver::Off));
    }
}
