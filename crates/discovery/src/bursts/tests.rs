//! The smoothed amount of what comes and goes, held against a simulation.

use super::fit::Scene;
use super::pulse::{Pulse, drawn};
use super::trace::{action, places, trace};
use crate::laws::sensitivity::Sensitivities;
use estimation::data::study::Study;
use estimation::fit::output_error::{Effort, Fit, fit};
use estimation::fit::smoother::{Measured, Wander, smooth};
use estimation::model::prediction::{SpeedObserver, outputs};
use estimation::specimen;
use motor::effect::curve::Place;

/// Outputs of a model in which something comes at a place, one row of the case after the other.
fn shown(study: &Study, model: &Fit, place: Place, pulses: &[Pulse]) -> Vec<f64> {
    let waveform = specimen::waveform_of(study);
    let steps = waveform.inputs.u_s.len() / waveform.between.stride() + 1;
    let hidden = drawn(pulses, waveform.t_step(), steps);
    let there = trace(place, waveform.t_step(), &hidden);
    let h = model.hypothesis.with(there, &study.prior.plant.rated);
    outputs(&study.fitted.case, &study.prior, &h, SpeedObserver::Off)
}

/// A torque that comes for 40 ms in a simulation without noise: the smoothed amount is there when it is, and no other
/// place explains it as well.
#[test]
fn the_amount_is_found_where_and_when_it_was() {
    let study = specimen::study(1.0, |_| 1.0);
    let (case, prior) = (&study.fitted.case, &study.prior);
    let fit = fit(case, prior, &study.at_prior(), Effort::NONE);
    let waveform = specimen::waveform_of(&study);
    let of = Sensitivities::of(waveform, prior, &fit);
    let t_step = waveform.t_step();
    let torque = 0.1 * prior.plant.rated.torque;
    let pulse = Pulse {
        from: 0.5,
        to: 0.54,
        size: torque,
    };
    let there = shown(&study, &fit, Place::Torque, &[pulse]);
    let row = |(k, w): (usize, &[f64; 5])| -> [f64; 4] {
        core::array::from_fn(|c| match w[c] > 0.0 {
            true => (there[5 * k + c] - fit.outputs[5 * k + c]) / w[c],
            false => 0.0,
        })
    };
    let residual: Vec<[f64; 4]> = waveform.weight.iter().enumerate().map(row).collect();
    let weight: Vec<[f64; 4]> = waveform
        .weight
        .iter()
        .map(|w| [w[0], w[1], w[2], w[3]])
        .collect();
    let measured = Measured {
        residual: &residual,
        weight: &weight,
        decimation: waveform.decimation,
        t_step,
    };
    let asked = |place: Place, deviation: f64| {
        let wander = Wander {
            deviation,
            memory: 0.01,
        };
        smooth(of.tangent(), &of.push(action(place)), &measured, wander)
    };
    let found = asked(Place::Torque, torque);
    let mean = |from: f64, to: f64| {
        let range = (from / t_step) as usize..(to / t_step) as usize;
        found.amount[range.clone()].iter().sum::<f64>() / range.len() as f64
    };
    // Noise that is assumed but not there: the amount leaks some milliseconds over the edges.
    assert!(
        (mean(0.51, 0.53) / torque - 1.0).abs() < 0.15,
        "{}",
        mean(0.51, 0.53) / torque
    );
    assert!(mean(0.3, 0.45).abs() < 0.05 * torque && mean(0.6, 0.9).abs() < 0.05 * torque);
    let elsewhere = asked(Place::Rotor, 1.0);
    assert!(found.evidence > elsewhere.evidence + 1000.0);
}

/// A contact of phase b that opens to four times the winding's resistance: a model that was linearised without it makes no clean bursts of it at
/// its own place, but at a less likely one.
#[test]
fn a_contact_that_opens_far_is_suspected_where_a_less_likely_place_shows_bursts() {
    let study = specimen::study(1.0, |_| 1.0);
    let (case, prior) = (&study.fitted.case, &study.prior);
    let believed = fit(case, prior, &study.at_prior(), Effort::NONE);
    let waveform = specimen::waveform_of(&study);
    let pulse = |k: u32| Pulse {
        from: 0.3 + 0.08 * f64::from(k),
        to: 0.33 + 0.08 * f64::from(k),
        size: 3.0 * prior.plant.motor.r_s,
    };
    let pulses: Vec<Pulse> = (0..7).map(pulse).collect();
    let there = shown(&study, &believed, Place::StatorPhaseB, &pulses);
    let mut measured = case.clone();
    let weights = waveform.weight.clone();
    for (k, row) in specimen::measured_of(&mut measured).iter_mut().enumerate() {
        for c in (0..4).filter(|&c| weights[k][c] > 0.0) {
            row[c] += (there[5 * k + c] - believed.outputs[5 * k + c]) / weights[k][c];
        }
    }
    let scene = Scene {
        waveform: measured.waveform().expect("samples"),
        case: &measured,
        prior,
        without: believed.hypothesis.clone(),
    };
    let suspected = scene.suspected(&places().collect::<Vec<_>>(), 3, 0.0);
    let places: Vec<Place> = suspected.iter().map(|(place, _)| *place).collect();
    assert!(places.contains(&Place::StatorPhaseB), "{places:?}");
}
