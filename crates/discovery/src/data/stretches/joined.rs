//! Stretches of a recording as one case: the motor runs on where a part was left out, the clock goes on.

use super::Stretch;
use crate::data::case::{Case, measured_angle};
use crate::data::channels::N_CHANNELS;
use crate::data::inputs::InputNoise;
use crate::data::unsupported::{Unsupported, check_clock, check_size};
use motor::effect::{Cut, Rated, Timeline};
use recording::{Recording, StartsFrom};
use std::ops::Range;

/// Prepares the stretches of a recording.
///
/// # Errors
/// As [`Case::new`], for the recording or one of its stretches.
pub(crate) fn joined(
    rec: &Recording,
    rated: &Rated<f64>,
    stretches: &[Stretch],
) -> Result<Case, Unsupported> {
    check_clock(rec)?;
    check_size(rec)?;
    let prepared = stretches
        .iter()
        .map(|stretch| prepared(rec, rated, stretch));
    let mut cases = prepared.collect::<Result<Vec<Case>, _>>()?;
    let finer = cases[0].finer;
    if cases.iter().any(|case| case.finer != finer) {
        // The voltage can be refined in some stretches only: one integration step for all needs the whole.
        return Case::new(rec, rated);
    }
    let angle = measured_angle(rec);
    for (case, stretch) in cases.iter_mut().zip(stretches) {
        trim(case);
        turn(case, angle.get(stretch.samples.start).copied());
    }
    let mut cases = cases.into_iter().zip(stretches);
    let Some((mut whole, _)) = cases.next() else {
        return Case::new(rec, rated);
    };
    for (case, stretch) in cases {
        append(
            &mut whole,
            case,
            stretch.samples.start as f64 * rec.t_sample(),
        );
    }
    Ok(whole)
}

fn prepared(rec: &Recording, rated: &Rated<f64>, stretch: &Stretch) -> Result<Case, Unsupported> {
    let beyond = |error: recording::Error| Unsupported::new(error.to_string(), "cut the recording");
    let mut cut = rec.slice(stretch.samples.clone()).map_err(beyond)?;
    if stretch.samples.start > 0 {
        cut.metadata.starts_from = StartsFrom::Unknown;
    }
    let mut case = Case::new(&cut, rated)?;
    let settles = stretch.settles as f64 * rec.t_sample() / case.t_row();
    for weight in case.weight.iter_mut().take(settles.round() as usize) {
        *weight = [0.0; N_CHANNELS];
    }
    Ok(case)
}

/// Whole blocks, so that rows, samples and blocks of the joined case keep their ratios.
fn trim(case: &mut Case) {
    let per_row = case.samples_per_row();
    let rows = case.measured.len().min(case.inputs.u_s.len() / per_row);
    let rows = rows / case.block * case.block;
    let samples = rows * per_row;
    case.measured.truncate(rows);
    case.weight.truncate(rows);
    case.inputs.u_s.truncate(samples);
    case.inputs.tau_load.truncate(samples);
    case.speed.truncate(samples);
    change(case, |timeline| {
        timeline.omega_sync.truncate(samples);
        timeline.theta_mech.truncate(samples);
    });
    case.supply.truncate(samples);
    let of_recording = samples / case.finer;
    if let Some(coarse) = &mut case.coarse {
        coarse.truncate(of_recording);
    }
    case.load_windows.truncate(of_recording);
    case.speed_windows.truncate(of_recording);
    case.open.retain_mut(|open| {
        open.end = open.end.min(samples);
        open.start < open.end
    });
}

/// Lets the shaft angle begin at what the parts before have turned.
fn turn(case: &mut Case, angle: Option<f64>) {
    let Some(angle) = angle else { return };
    change(case, |timeline| {
        timeline.theta_mech.iter_mut().for_each(|x| *x += angle);
    });
}

fn change(case: &mut Case, what: impl FnOnce(&mut Timeline)) {
    let mut timeline = (*case.timeline).clone();
    what(&mut timeline);
    case.timeline = timeline.into();
}

/// Appends a stretch that begins `t` seconds after the recording.
fn append(whole: &mut Case, mut next: Case, t: f64) {
    let sample = whole.inputs.u_s.len();
    let later = |r: &Range<usize>| r.start + sample..r.end + sample;
    let shares = [whole.measured.len(), next.measured.len()];
    whole.input_noise = rms(whole.input_noise, next.input_noise, shares);
    whole.inputs.u_s.append(&mut next.inputs.u_s);
    whole.inputs.tau_load.append(&mut next.inputs.tau_load);
    whole.speed.append(&mut next.speed);
    whole.measured.append(&mut next.measured);
    whole.weight.append(&mut next.weight);
    whole.open.extend(next.open.iter().map(later));
    // A motor that does not run stands still.
    whole.running_at_cuts.push(next.running_at.unwrap_or(0.0));
    change(whole, |timeline| {
        timeline.omega_sync.extend(&next.timeline.omega_sync);
        timeline.theta_mech.extend(&next.timeline.theta_mech);
        timeline.cuts.push(Cut { sample, t });
    });
    whole.supply.append(next.supply);
    if let (Some(coarse), Some(more)) = (&mut whole.coarse, next.coarse) {
        coarse.append(more);
    }
    whole.load_windows.append(next.load_windows);
    whole.speed_windows.append(next.speed_windows);
}

/// Noise of two parts together, by their lengths.
fn rms(one: InputNoise, other: InputNoise, shares: [usize; 2]) -> InputNoise {
    let [a, b] = shares.map(|n| n as f64 / (shares[0] + shares[1]) as f64);
    let mean = |x: f64, y: f64| (a * x * x + b * y * y).sqrt();
    InputNoise {
        voltage: mean(one.voltage, other.voltage),
        torque: mean(one.torque, other.torque),
        speed: mean(one.speed, other.speed),
    }
}
