//! Bursts as a report shows them.

use super::pulse::Pulse;
use super::trace::action;
use crate::report::law::{BurstReport, BurstsReport, LawCurve};
use estimation::data::study::{Study, Trial};
use motor::effect::curve::Place;

/// Bursts of all recordings, in units that a person measures in.
pub(crate) fn bursts_report(
    study: &Study,
    place: Place,
    trial: &Trial,
    recordings: &[Vec<Pulse>],
) -> Option<BurstsReport> {
    let (factor, unit) = in_units(study, place, trial);
    let durations = std::iter::once(&study.fitted).chain(&study.proofs);
    let durations: Vec<f64> = durations
        .filter_map(|s| s.case.waveform())
        .map(|waveform| waveform.t_row() * waveform.measured.len() as f64)
        .collect();
    let of = |(number, pulses): (usize, &Vec<Pulse>)| {
        let one = move |pulse: &Pulse| BurstReport {
            recording: number + 1,
            from_s: pulse.from,
            to_s: pulse.to,
            size: factor * pulse.size,
        };
        pulses.iter().map(one).collect::<Vec<_>>()
    };
    let bursts: Vec<BurstReport> = recordings.iter().enumerate().flat_map(of).collect();
    let mut sizes: Vec<f64> = bursts.iter().map(|burst| burst.size).collect();
    sizes.sort_by(f64::total_cmp);
    let time: f64 = bursts.iter().map(|burst| burst.to_s - burst.from_s).sum();
    Some(BurstsReport {
        count: bursts.len(),
        share_of_time_percent: 100.0 * time / durations.iter().sum::<f64>(),
        smallest: *sizes.first()?,
        median: sizes[sizes.len() / 2],
        largest: *sizes.last()?,
        unit: unit.to_owned(),
        bursts,
    })
}

/// Factor from the amount of a place to a unit that a person measures in.
fn in_units(study: &Study, place: Place, trial: &Trial) -> (f64, &'static str) {
    let motor = trial.fit.hypothesis.plant(&study.prior).motor;
    match place {
        Place::Stator | Place::StatorPhaseA | Place::StatorPhaseB | Place::StatorPhaseC => {
            (motor.r_s, "ohm")
        }
        Place::Rotor => (motor.r_r, "ohm"),
        Place::Torque | Place::Friction => (1.0, "N m"),
        _ => (100.0, "%"),
    }
}

/// The bursts of the fitted recording as a curve over time, with the unit of their sizes: its corners.
pub(crate) fn corners(
    study: &Study,
    place: Place,
    trial: &Trial,
    pulses: &[Pulse],
    end: f64,
) -> LawCurve {
    let (factor, unit) = in_units(study, place, trial);
    let mut x = vec![0.0];
    let mut y = vec![0.0];
    for pulse in pulses {
        x.extend([pulse.from, pulse.from, pulse.to, pulse.to]);
        let size = factor * pulse.size;
        y.extend([0.0, size, size, 0.0]);
    }
    x.push(end);
    y.push(0.0);
    LawCurve {
        x,
        lower: y.clone(),
        upper: y.clone(),
        y,
        x_unit: action(place).coordinate.unit().to_owned(),
        y_unit: unit.to_owned(),
    }
}
