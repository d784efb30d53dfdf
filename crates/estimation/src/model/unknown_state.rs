//! What nobody knows of the state of a motor: where a recording of it begins while it runs, and where its voltage jumps.
//!
//! A recording that begins while the motor runs shows no fluxes. The model begins settled on its supply; a motor whose iron
//! saturates, or whose load has just changed, was elsewhere. Where the voltage jumps nobody knows when between two samples it
//! did: a part of a sampling interval times the jump is missing in the stator flux. Such differences fade, but at first they
//! are larger than the noise. To first order they are sums of known responses with unknown amounts; where a recording is slow, what
//! a jump leaves is so large a part of the flux that the second order is taken as unknown too.
//!
//! Where the measured speed drives the model, nobody knows either how the shaft trembles at twice the supply's frequency: that is gone with the
//! noise that is smoothed away, and in what an encoder counts during one period of it. Nor is a model judged by how such counts tremble.

mod ripple;

use crate::data::case::Waveform;
use crate::data::channels::{N_CHANNELS, SPEED};
use crate::fit::nuisance::{Nuisance, Strip, length, unfaded};
use crate::model::prediction::{Drive, SpeedObserver, as_shown, run, speed_shown};
use motor::effect::{EffectConfig, Outputs, Plant, StateOffset};
use num_complex::Complex64;
use rayon::prelude::*;
use ripple::Ripple;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::ops::Range;

/// Offset that shows a response, in the size of rated flux and speed: small against the curvature, large against rounding.
const OFFSET: f64 = 1e-3;

/// Jumps of the voltage in a stretch whose instants are unknown; a supply with more of them does not jump now and then.
const MOST_JUMPS: usize = 6;

/// Flux that a jump to the rated voltage leaves, at most, over the rated flux, from which responses are curved. At 0.08 (2 kHz, 50 Hz) a
/// healthy start of an 18.5 kW motor was left 1.03 to 1.08 times the noise away by the first order alone, at 0.03 (5 kHz) 0.98 times.
const CURVED: f64 = 0.05;

/// What unknown states of a motor do to the outputs of a case: fluxes and speed (unless that is given) at running starts, the
/// stator flux at jumps of the voltage.
pub fn unknown_state(waveform: &Waveform, plant: &Plant) -> Nuisance {
    let stretches = stretches(waveform);
    let mut all = unknowns(&stretches, plant, left_by_a_jump(waveform, plant));
    all.extend(trembling(waveform, plant, &stretches));
    let mut nuisance = Nuisance::default();
    for strip in stretches
        .iter()
        .flat_map(|stretch| stretch.trembling_counts(waveform))
    {
        nuisance.add(&strip, strip.length());
    }
    if all.is_empty() {
        return nuisance;
    }
    let meters = speedometers(waveform, plant);
    // As shown, and the shaft's speed: of a long recording no more is kept.
    let shown = |drive: &Drive<'_>| {
        let outputs = run(waveform, plant, drive, SpeedObserver::Off);
        (as_shown(waveform, &outputs), speed_of(&outputs))
    };
    let (rows_without, without) = shown(&Drive::of(waveform));
    let response = |unknown: &Unknown| {
        let (mut rows, mut with) = shown(&unknown.departure.drive(waveform));
        take(&mut rows, &rows_without);
        if unknown.curved {
            let (mut other_rows, mut other) = shown(&unknown.departure.opposite().drive(waveform));
            take(&mut other_rows, &rows_without);
            take(&mut other.omega_mech, &without.omega_mech);
            add(&mut rows, &other_rows);
            add(&mut with.omega_mech, &other.omega_mech);
        }
        let rows = &rows;
        let lengths = unknown.lengths(&stretches, rows);
        let others = meters.iter().map(|meter| {
            let read = |speed| speed_shown(waveform, &read_by(meter, plant, speed));
            let mut speed = read(&with);
            take(&mut speed, &read(&without));
            let shaft = rows.iter().skip(SPEED).step_by(N_CHANNELS);
            speed.iter_mut().zip(shaft).for_each(|(x, r)| *x -= r);
            unknown.in_speed(&stretches, &speed)
        });
        let mut parts: Vec<Vec<Strip>> = others.collect();
        parts.push(unknown.in_all(&stretches, rows));
        Responses {
            lengths,
            parts,
            expected: matches!(unknown.departure, Departure::Ripple(_)),
        }
    };
    let responses: Vec<Responses> = all.par_iter().map(response).collect();
    // What instruments make of a response is in the speed alone, and stays there as long as nothing else was added.
    for part in 0..=meters.len() {
        for response in &responses {
            let strips = response.parts[part].iter().zip(&response.lengths);
            strips.for_each(|(strip, length)| match response.expected {
                true => nuisance.add_expected(strip, *length),
                false => nuisance.add(strip, *length),
            });
        }
    }
    nuisance
}

/// What one unknown does to each of its stretches, until it has faded.
struct Responses {
    /// Length of the response of each stretch.
    lengths: Vec<f64>,
    /// What each instrument makes of it beside that, and the response itself.
    parts: Vec<Vec<Strip>>,
    /// Whether the unknown is as large as it is expected to be, not any size.
    expected: bool,
}

fn take(from: &mut [f64], what: &[f64]) {
    from.iter_mut().zip(what).for_each(|(x, w)| *x -= w);
}

fn add(to: &mut [f64], what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(x, w)| *x += w);
}

/// Stator flux that nobody knows after a jump to the rated voltage, at most, as a share of the rated flux: half a sampling interval
/// of the recording, during which the voltage was there or not.
fn left_by_a_jump(waveform: &Waveform, plant: &Plant) -> f64 {
    0.5 * waveform.inputs.t_sample * waveform.finer as f64 * plant.rated.omega_sync
}

/// Instruments through which a speed may have been read: the counts of an encoder. Whether that is so is asked
/// later; until then a start that is unknown looks different through each of them.
fn speedometers(waveform: &Waveform, plant: &Plant) -> Vec<EffectConfig> {
    let is_judged = waveform.weight.iter().any(|w| w[SPEED] > 0.0);
    let encoders = motor::effects::ALL.iter().filter(|e| e.averages_speed());
    let late = encoders.filter(|_| is_judged).flat_map(|encoder| {
        let window = &encoder.descriptor().parameters[0];
        window.grid.iter().map(|late| {
            let mut config = EffectConfig::absent(*encoder, &plant.rated);
            config.values[0] = late * window.scale.of(&plant.rated);
            config
        })
    });
    late.collect()
}

/// The shaft's speed alone.
fn speed_of(outputs: &Outputs) -> Outputs {
    Outputs {
        t_start: outputs.t_start,
        t_sample: outputs.t_sample,
        omega_mech: outputs.omega_mech.clone(),
        ..Outputs::default()
    }
}

/// The speed that an instrument shows, rad/s, of outputs that hold the shaft's alone.
fn read_by(meter: &EffectConfig, plant: &Plant, speed: &Outputs) -> Vec<f64> {
    let mut read = speed.clone();
    let values = meter.effect.prepared(&meter.values, &plant.rated);
    meter.effect.outputs(&values, &plant.rated, &mut read);
    read.omega_mech
}

/// A stretch that nothing interrupts.
struct Stretch {
    sample: usize,
    /// Values of its rows.
    values: Range<usize>,
    /// Whether the motor runs where it begins.
    running: bool,
    /// Samples at which the voltage has jumped.
    jumps: Vec<usize>,
}

impl Stretch {
    /// How counts may tremble, from one jump of the voltage to the next: an unbalanced supply's ripple changes there.
    fn trembling_counts(&self, waveform: &Waveform) -> Vec<Strip> {
        let rows = self.values.start / N_CHANNELS..self.values.end / N_CHANNELS;
        let jumps = self
            .jumps
            .iter()
            .map(|k| k.div_ceil(waveform.samples_per_row()));
        let begins: Vec<usize> = [rows.start]
            .into_iter()
            .chain(jumps)
            .chain([rows.end])
            .collect();
        let parts = begins.windows(2).map(|ends| ends[0]..ends[1]);
        parts
            .flat_map(|part| ripple::of_counts(waveform, part))
            .collect()
    }
}

fn stretches(waveform: &Waveform) -> Vec<Stretch> {
    let cuts = waveform.timeline.cuts.iter().map(|cut| cut.sample);
    let later = cuts.zip(waveform.running_at_cuts.iter().copied());
    let starts: Vec<(usize, Option<f64>)> = [(0, waveform.running_at)]
        .into_iter()
        .chain(later)
        .collect();
    let ends = starts
        .iter()
        .skip(1)
        .map(|(sample, _)| *sample)
        .chain([usize::MAX]);
    let rows = waveform.measured.len();
    let value = |sample: usize| sample.div_ceil(waveform.samples_per_row()).min(rows) * N_CHANNELS;
    let one = |(&(sample, running_at), end): (&(usize, Option<f64>), usize)| Stretch {
        sample,
        values: value(sample)..value(end),
        running: running_at.is_some(),
        jumps: jumps(waveform, sample + 1..end),
    };
    let all = starts.iter().zip(ends).map(one);
    all.filter(|stretch| !stretch.values.is_empty()).collect()
}

/// Samples in a range at which the amplitude of the voltage has jumped: the first of an integration step.
fn jumps(waveform: &Waveform, within: Range<usize>) -> Vec<usize> {
    let stride = waveform.between.stride();
    let segments = waveform
        .supply
        .segments
        .iter()
        .filter(|_| waveform.supply.denoised);
    let starts = segments
        .map(|segment| segment.start)
        .filter(|k| within.contains(k));
    let jumps: Vec<usize> = starts.map(|k| k.next_multiple_of(stride)).collect();
    if jumps.len() > MOST_JUMPS {
        Vec::new()
    } else {
        jumps
    }
}

/// How a motor may depart from the model of it.
enum Departure {
    /// Offsets of its state.
    State(Vec<StateOffset>),
    /// A ripple of the speed that is given, as large as may be.
    Ripple(Ripple),
}

impl Departure {
    /// What drives a model that departs so.
    fn drive<'a>(&'a self, waveform: &'a Waveform) -> Drive<'a> {
        let given = Drive::of(waveform);
        match self {
            Self::State(offsets) => Drive { offsets, ..given },
            Self::Ripple(ripple) => Drive {
                speed: Cow::Owned(ripple.added(waveform)),
                ..given
            },
        }
    }

    fn opposite(&self) -> Self {
        let turned = |offset: &StateOffset| StateOffset {
            sample: offset.sample,
            psi_s: -offset.psi_s,
            psi_r: -offset.psi_r,
            omega_mech: -offset.omega_mech,
        };
        match self {
            Self::State(offsets) => Self::State(offsets.iter().map(turned).collect()),
            Self::Ripple(ripple) => Self::Ripple(ripple.opposite()),
        }
    }
}

/// An unknown of some stretches: the same departure in each of them.
struct Unknown {
    departure: Departure,
    /// Whether what it does beside its first order is asked for: what it does in either direction together.
    curved: bool,
    /// Their numbers.
    stretches: Vec<usize>,
}

impl Unknown {
    fn ranges<'a>(&'a self, stretches: &'a [Stretch]) -> impl Iterator<Item = &'a Range<usize>> {
        self.stretches.iter().map(|&k| &stretches[k].values)
    }

    /// Length of what it does to each of its stretches.
    fn lengths(&self, stretches: &[Stretch], rows: &[f64]) -> Vec<f64> {
        let ranges = self.ranges(stretches);
        ranges.map(|range| length(&rows[range.clone()])).collect()
    }

    /// Of weighted rows, what is there of it in each of its stretches.
    fn in_all(&self, stretches: &[Stretch], rows: &[f64]) -> Vec<Strip> {
        let one = |range: &Range<usize>| {
            let part = &rows[range.clone()];
            let kept = unfaded(part);
            Strip::new(range.start + kept.start, part[kept].to_vec())
        };
        self.ranges(stretches).map(one).collect()
    }

    /// The same of the weighted speed of each row.
    fn in_speed(&self, stretches: &[Stretch], speed: &[f64]) -> Vec<Strip> {
        let one = |range: &Range<usize>| {
            let first = range.start / N_CHANNELS;
            let part = &speed[first..range.end / N_CHANNELS];
            let kept = unfaded(part);
            Strip::of_channel(SPEED, first + kept.start, part[kept].to_vec())
        };
        self.ranges(stretches).map(one).collect()
    }
}

/// Unknown states of stretches, where a jump leaves an unknown share of the rated flux.
fn unknowns(stretches: &[Stretch], plant: &Plant, share: f64) -> Vec<Unknown> {
    let units = units(plant);
    let of = |unit: &StateOffset, curved: bool, sample: &dyn Fn(&Stretch) -> Option<usize>| {
        let there = stretches.iter().enumerate();
        let there = there.filter_map(|(k, stretch)| Some((k, sample(stretch)?)));
        let (stretches, offsets) = there
            .map(|(k, sample)| (k, StateOffset { sample, ..*unit }))
            .unzip();
        Unknown {
            departure: Departure::State(offsets),
            curved,
            stretches,
        }
    };
    let begun = units
        .iter()
        .map(|unit| of(unit, false, &|s| s.running.then_some(s.sample)));
    let straight = units[..2].iter().map(|unit| (*unit, false));
    let curved = curvatures(plant, share).into_iter().flatten();
    let at_a_jump: Vec<(StateOffset, bool)> = straight
        .chain(curved.map(|offset| (offset, true)))
        .collect();
    let jumped = (0..MOST_JUMPS).flat_map(|n| at_a_jump.iter().map(move |unit| (n, unit)));
    let jumped = jumped.map(|(n, (unit, curved))| of(unit, *curved, &|s| s.jumps.get(n).copied()));
    begun
        .chain(jumped)
        .filter(|unknown| !unknown.stretches.is_empty())
        .collect()
}

/// What is unknown of the speed within the stretches where it is given.
fn trembling(waveform: &Waveform, plant: &Plant, stretches: &[Stretch]) -> Vec<Unknown> {
    let is_given = waveform.speed_is_input && !stretches.is_empty();
    let ripples = is_given.then(|| Ripple::expected(waveform, plant));
    let one = |ripple: Ripple| Unknown {
        departure: Departure::Ripple(ripple),
        curved: false,
        stretches: (0..stretches.len()).collect(),
    };
    ripples.into_iter().flatten().map(one).collect()
}

/// Offsets of the stator flux whose second orders span those of all: along both axes and between them, as large as a jump leaves.
fn curvatures(plant: &Plant, share: f64) -> Option<[StateOffset; 3]> {
    let size = share * plant.rated.flux();
    let along = |angle: f64| StateOffset {
        sample: 0,
        psi_s: Complex64::from_polar(size, angle),
        psi_r: Complex64::ZERO,
        omega_mech: 0.0,
    };
    (share > CURVED).then(|| [0.0, FRAC_PI_2, FRAC_PI_4].map(along))
}

/// One offset of each state, those of the stator flux first.
fn units(plant: &Plant) -> [StateOffset; 5] {
    let (flux, speed) = (OFFSET * plant.rated.flux(), OFFSET * plant.rated.speed());
    let none = StateOffset {
        sample: 0,
        psi_s: Complex64::ZERO,
        psi_r: Complex64::ZERO,
        omega_mech: 0.0,
    };
    let axes = [Complex64::new(flux, 0.0), Complex64::new(0.0, flux)];
    let [s_re, s_im] = axes.map(|psi_s| StateOffset { psi_s, ..none });
    let [r_re, r_im] = axes.map(|psi_r| StateOffset { psi_r, ..none });
    let faster = StateOffset {
        omega_mech: speed,
        ..none
    };
    [s_re, s_im, r_re, r_im, faster]
}

#[cfg(test)]
mod tests;
