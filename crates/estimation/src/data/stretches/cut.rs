//! Stretches of a prepared recording as one case: the motor runs on where a part was left out, the clock goes on.
//!
//! The whole recording is smoothed first: what a short stretch leaves of the noise of a constant input would bias the
//! parameters that damp it.

use super::Stretch;
use crate::data::case::Waveform;
use crate::data::channels::N_CHANNELS;
use crate::fit::nuisance::Nuisance;
use motor::effect::{Cut, Inputs, Rated, Timeline};
use std::ops::Range;

/// Share of the rated voltage below which a motor without a speed channel is taken to stand still.
const OFF: f64 = 0.02;

/// A case of these stretches of a recording, in whole blocks.
pub fn cut(whole: &Waveform, rated: &Rated<f64>, stretches: &[Stretch]) -> Waveform {
    let part = |stretch| Part::of(whole, stretch);
    let parts: Vec<Part> = stretches.iter().map(part).collect();
    let samples: Vec<Range<usize>> = parts.iter().map(|part| part.samples.clone()).collect();
    let coarse = |r: &Range<usize>| r.start / whole.finer..r.end / whole.finer;
    let of_recording: Vec<Range<usize>> = samples.iter().map(coarse).collect();
    let rows: Vec<Range<usize>> = parts.iter().map(|part| part.rows.clone()).collect();
    Waveform {
        inputs: Inputs {
            t_sample: whole.inputs.t_sample,
            u_s: taken(&whole.inputs.u_s, &samples),
            tau_load: taken(&whole.inputs.tau_load, &samples),
        },
        timeline: timeline(whole, &samples).into(),
        speed: taken(&whole.speed, &samples),
        running_at: match samples[0].start {
            0 => whole.running_at,
            first => Some(running_at(whole, rated, first)),
        },
        running_at_cuts: samples[1..]
            .iter()
            .map(|part| Some(running_at(whole, rated, part.start)))
            .collect(),
        open: intersections(&whole.open, &samples),
        measured: taken(&whole.measured, &rows),
        weight: parts.iter().flat_map(|part| part.weight(whole)).collect(),
        supply: whole.supply.taken(&samples),
        coarse: whole.coarse.as_ref().map(|x| x.taken(&of_recording)),
        load_windows: whole.load_windows.taken(&of_recording),
        speed_windows: whole.speed_windows.taken(&of_recording),
        ..unchanged(whole)
    }
}

/// A stretch in whole rows and blocks.
struct Part {
    rows: Range<usize>,
    samples: Range<usize>,
    /// Rows at its beginning that are not judged.
    settles: usize,
}

impl Part {
    fn of(whole: &Waveform, stretch: &Stretch) -> Self {
        let per_row = whole.samples_per_row();
        let row = |sample: usize| (sample * whole.finer).div_ceil(per_row);
        let first = row(stretch.samples.start);
        let last = row(stretch.samples.end)
            .min(whole.measured.len())
            .min(whole.inputs.u_s.len() / per_row);
        let count = last.saturating_sub(first) / whole.block * whole.block;
        Self {
            rows: first..first + count,
            samples: first * per_row..(first + count) * per_row,
            settles: row(stretch.settles),
        }
    }

    fn weight<'a>(&self, whole: &'a Waveform) -> impl Iterator<Item = [f64; N_CHANNELS]> + 'a {
        let settles = self.settles;
        let weight = whole.weight[self.rows.clone()].iter().enumerate();
        weight.map(move |(k, w)| if k < settles { [0.0; N_CHANNELS] } else { *w })
    }
}

/// What does not change with the samples that are taken, without copying those.
fn unchanged(whole: &Waveform) -> Waveform {
    Waveform {
        inputs: Inputs::default(),
        between: whole.between,
        timeline: whole.timeline.clone(),
        speed: Vec::new(),
        speed_is_input: whole.speed_is_input,
        running_at: None,
        running_at_cuts: Vec::new(),
        settles: whole.settles,
        open: Vec::new(),
        decimation: whole.decimation,
        measured: Vec::new(),
        weight: Vec::new(),
        block: whole.block,
        supply: signal::Supply::default(),
        finer: whole.finer,
        coarse: None,
        input_noise: whole.input_noise,
        load_windows: signal::Windows::default(),
        speed_windows: signal::Windows::default(),
        speed_held_s: whole.speed_held_s,
        inverter: whole.inverter,
        speed_scale_is_free: whole.speed_scale_is_free,
        nuisance: Nuisance::default(),
    }
}

fn taken<T: Copy>(x: &[T], parts: &[Range<usize>]) -> Vec<T> {
    let part = |r: &Range<usize>| x.get(r.clone()).unwrap_or_default();
    parts.iter().flat_map(part).copied().collect()
}

fn timeline(whole: &Waveform, samples: &[Range<usize>]) -> Timeline {
    let t_sample = whole.inputs.t_sample;
    let mut sample = 0;
    let mut cuts = Vec::new();
    for part in samples {
        if sample > 0 {
            let t = t_sample * part.start as f64;
            cuts.push(Cut {
                sample,
                t,
                is_new: false,
            });
        }
        sample += part.len();
    }
    Timeline {
        t_sample,
        omega_sync: taken(&whole.timeline.omega_sync, samples),
        theta_mech: taken(&whole.timeline.theta_mech, samples),
        cuts,
    }
}

/// Speed with which a stretch begins, rad/s.
fn running_at(whole: &Waveform, rated: &Rated<f64>, sample: usize) -> f64 {
    let supplied = whole.inputs.u_s[sample].norm() > OFF * rated.voltage;
    let unmeasured = if supplied { rated.speed() } else { 0.0 };
    whole.speed.get(sample).copied().unwrap_or(unmeasured)
}

/// Ranges of a recording as ranges of the samples that are taken.
fn intersections(ranges: &[Range<usize>], parts: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut from = 0;
    let mut all = Vec::new();
    for part in parts {
        for range in ranges {
            let both = range.start.max(part.start)..range.end.min(part.end);
            if both.start < both.end {
                all.push(both.start - part.start + from..both.end - part.start + from);
            }
        }
        from += part.len();
    }
    all
}
