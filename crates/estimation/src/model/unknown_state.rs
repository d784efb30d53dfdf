//! What nobody knows of the state of a motor: where a recording of it begins while it runs, and where its voltage jumps.
//!
//! A recording that begins while the motor runs shows no fluxes. The model begins settled on its supply; a motor whose iron
//! saturates, or whose load has just changed, was elsewhere. Where the voltage jumps nobody knows when between two samples it
//! did: a part of a sampling interval times the jump is missing in the stator flux. Such differences fade, but at first they
//! are larger than the noise. To first order they are sums of known responses with unknown amounts.

use crate::data::case::Case;
use crate::data::channels::N_CHANNELS;
use crate::fit::nuisance::Nuisance;
use crate::model::prediction::{Drive, SpeedObserver, as_shown, run};
use motor::effect::{Plant, StateOffset};
use num_complex::Complex64;
use rayon::prelude::*;
use std::ops::Range;

/// Offset that shows a response, in the size of rated flux and speed: small against the curvature, large against rounding.
const OFFSET: f64 = 1e-3;

/// Jumps of the voltage in a stretch whose instants are unknown; a supply with more of them does not jump now and then.
const MOST_JUMPS: usize = 6;

/// What unknown states of a motor do to the outputs of a case: fluxes and speed (unless that is given) at running starts, the
/// stator flux at jumps of the voltage.
pub fn unknown_state(case: &Case, plant: &Plant) -> Nuisance {
    let stretches = stretches(case);
    let all = unknowns(&stretches, plant);
    let mut nuisance = Nuisance::default();
    if all.is_empty() {
        return nuisance;
    }
    let shown = |offsets: &[StateOffset]| {
        let drive = Drive {
            offsets,
            ..Drive::of(case)
        };
        as_shown(case, &run(case, plant, &drive, SpeedObserver::Off))
    };
    let base = shown(&[]);
    let response = |unknown: &Unknown| {
        let mut there = shown(&unknown.offsets);
        there.iter_mut().zip(&base).for_each(|(x, b)| *x -= b);
        there
    };
    let responses: Vec<Vec<f64>> = all.par_iter().map(response).collect();
    for (unknown, response) in all.iter().zip(&responses) {
        for values in unknown.stretches.iter().map(|&k| &stretches[k].values) {
            nuisance.add(values.start, response[values.clone()].to_vec());
        }
    }
    nuisance
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

fn stretches(case: &Case) -> Vec<Stretch> {
    if case.table.is_some() {
        return Vec::new();
    }
    let cuts = case.timeline.cuts.iter().map(|cut| cut.sample);
    let later = cuts.zip(case.running_at_cuts.iter().copied());
    let starts: Vec<(usize, Option<f64>)> =
        [(0, case.running_at)].into_iter().chain(later).collect();
    let ends = starts
        .iter()
        .skip(1)
        .map(|(sample, _)| *sample)
        .chain([usize::MAX]);
    let rows = case.measured.len();
    let value = |sample: usize| sample.div_ceil(case.samples_per_row()).min(rows) * N_CHANNELS;
    let one = |(&(sample, running_at), end): (&(usize, Option<f64>), usize)| Stretch {
        sample,
        values: value(sample)..value(end),
        running: running_at.is_some(),
        jumps: jumps(case, sample + 1..end),
    };
    let all = starts.iter().zip(ends).map(one);
    all.filter(|stretch| !stretch.values.is_empty()).collect()
}

/// Samples in a range at which the amplitude of the voltage has jumped: the first of an integration step.
fn jumps(case: &Case, within: Range<usize>) -> Vec<usize> {
    let stride = case.between.stride();
    let segments = case.supply.segments.iter().filter(|_| case.supply.denoised);
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

/// An unknown of some stretches: the same offset, once in each of them.
struct Unknown {
    offsets: Vec<StateOffset>,
    /// Their numbers.
    stretches: Vec<usize>,
}

fn unknowns(stretches: &[Stretch], plant: &Plant) -> Vec<Unknown> {
    let units = units(plant);
    let of = |unit: &StateOffset, sample: &dyn Fn(&Stretch) -> Option<usize>| {
        let there = stretches.iter().enumerate();
        let there = there.filter_map(|(k, stretch)| Some((k, sample(stretch)?)));
        let (stretches, offsets) = there
            .map(|(k, sample)| (k, StateOffset { sample, ..*unit }))
            .unzip();
        Unknown { offsets, stretches }
    };
    let begun = units
        .iter()
        .map(|unit| of(unit, &|s| s.running.then_some(s.sample)));
    let stator = &units[..2];
    let jumped = (0..MOST_JUMPS).flat_map(|n| stator.iter().map(move |unit| (n, unit)));
    let jumped = jumped.map(|(n, unit)| of(unit, &|s| s.jumps.get(n).copied()));
    begun
        .chain(jumped)
        .filter(|unknown| !unknown.stretches.is_empty())
        .collect()
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
