//! What nobody knows of the state in which a motor is when a recording of it begins.
//!
//! A recording that begins while the motor runs shows no fluxes. The model begins settled on its supply; a motor whose iron
//! saturates, or whose load has just changed, was elsewhere. Such a difference fades, but in the first tenths of a second
//! it is larger than the noise. To first order it is a sum of five known responses with unknown amounts.

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

/// What the states at the running starts of a case do to the outputs of a plant: fluxes, and the speed unless it is given.
pub fn unknown_state(case: &Case, plant: &Plant) -> Nuisance {
    let starts = running_starts(case);
    if starts.is_empty() {
        return Nuisance::default();
    }
    let shown = |offsets: &[StateOffset]| {
        let drive = Drive {
            offsets,
            ..Drive::of(case)
        };
        as_shown(case, &run(case, plant, &drive, SpeedObserver::Off))
    };
    let base = shown(&[]);
    let response = |offset: &StateOffset| {
        let offsets: Vec<StateOffset> = starts.iter().map(|s| at(offset, s.sample)).collect();
        let mut there = shown(&offsets);
        there.iter_mut().zip(&base).for_each(|(x, b)| *x -= b);
        there
    };
    let responses: Vec<Vec<f64>> = units(plant).par_iter().map(response).collect();
    let mut unknown = Nuisance::default();
    for start in &starts {
        for response in &responses {
            unknown.add(start.values.start, response[start.values.clone()].to_vec());
        }
    }
    unknown
}

/// The first sample of a stretch that begins with a running motor, and the values of its rows.
struct Start {
    sample: usize,
    values: Range<usize>,
}

fn running_starts(case: &Case) -> Vec<Start> {
    if case.table.is_some() {
        return Vec::new();
    }
    let cuts = case.timeline.cuts.iter().map(|cut| cut.sample);
    let later = cuts.zip(case.running_at_cuts.iter().copied());
    let all: Vec<(usize, Option<f64>)> = [(0, case.running_at)].into_iter().chain(later).collect();
    let value = |sample: usize| {
        sample
            .div_ceil(case.samples_per_row())
            .min(case.measured.len())
            * N_CHANNELS
    };
    let ends = all
        .iter()
        .skip(1)
        .map(|(sample, _)| *sample)
        .chain([usize::MAX]);
    let running = all
        .iter()
        .zip(ends)
        .filter(|((_, omega), _)| omega.is_some());
    let starts = running.map(|(&(sample, _), end)| Start {
        sample,
        values: value(sample)..value(end),
    });
    starts.filter(|start| !start.values.is_empty()).collect()
}

/// One offset of each state.
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

fn at(offset: &StateOffset, sample: usize) -> StateOffset {
    StateOffset { sample, ..*offset }
}
