//! What nobody knows of the state of a motor: where a recording of it begins while it runs, and where its voltage jumps.
//!
//! A recording that begins while the motor runs shows no fluxes. The model begins settled on its supply; a motor whose iron
//! saturates, or whose load has just changed, was elsewhere. Where the voltage jumps nobody knows when between two samples it
//! did: a part of a sampling interval times the jump is missing in the stator flux. Such differences fade, but at first they
//! are larger than the noise. To first order they are sums of known responses with unknown amounts; where a recording is slow, what
//! a jump leaves is so large a part of the flux that the second order is taken as unknown too.

use crate::data::case::Case;
use crate::data::channels::{N_CHANNELS, SPEED};
use crate::fit::nuisance::{Nuisance, Strip, length, unfaded};
use crate::model::prediction::{Drive, SpeedObserver, as_shown, run, speed_shown};
use motor::effect::{EffectConfig, Outputs, Plant, StateOffset};
use num_complex::Complex64;
use rayon::prelude::*;
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
pub fn unknown_state(case: &Case, plant: &Plant) -> Nuisance {
    let stretches = stretches(case);
    let all = unknowns(&stretches, plant, left_by_a_jump(case, plant));
    let mut nuisance = Nuisance::default();
    if all.is_empty() {
        return nuisance;
    }
    let meters = speedometers(case, plant);
    // As shown, and the shaft's speed: of a long recording no more is kept.
    let shown = |offsets: &[StateOffset]| {
        let drive = Drive {
            offsets,
            ..Drive::of(case)
        };
        let outputs = run(case, plant, &drive, SpeedObserver::Off);
        (as_shown(case, &outputs), speed_of(&outputs))
    };
    let (rows_without, without) = shown(&[]);
    let response = |unknown: &Unknown| {
        let (mut rows, mut with) = shown(&unknown.offsets);
        take(&mut rows, &rows_without);
        if unknown.curved {
            let (mut other_rows, mut other) = shown(&unknown.opposite());
            take(&mut other_rows, &rows_without);
            take(&mut other.omega_mech, &without.omega_mech);
            add(&mut rows, &other_rows);
            add(&mut with.omega_mech, &other.omega_mech);
        }
        let rows = &rows;
        let lengths = unknown.lengths(&stretches, rows);
        let others = meters.iter().map(|meter| {
            let read = |speed| speed_shown(case, &read_by(meter, plant, speed));
            let mut speed = read(&with);
            take(&mut speed, &read(&without));
            let shaft = rows.iter().skip(SPEED).step_by(N_CHANNELS);
            speed.iter_mut().zip(shaft).for_each(|(x, r)| *x -= r);
            unknown.in_speed(&stretches, &speed)
        });
        let mut parts: Vec<Vec<Strip>> = others.collect();
        parts.push(unknown.in_all(&stretches, rows));
        Responses { lengths, parts }
    };
    let responses: Vec<Responses> = all.par_iter().map(response).collect();
    // What instruments make of a response is in the speed alone, and stays there as long as nothing else was added.
    for part in 0..=meters.len() {
        for response in &responses {
            let strips = response.parts[part].iter().zip(&response.lengths);
            strips.for_each(|(strip, length)| nuisance.add(strip, *length));
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
}

fn take(from: &mut [f64], what: &[f64]) {
    from.iter_mut().zip(what).for_each(|(x, w)| *x -= w);
}

fn add(to: &mut [f64], what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(x, w)| *x += w);
}

/// Stator flux that nobody knows after a jump to the rated voltage, at most, as a share of the rated flux: half a sampling interval
/// of the recording, during which the voltage was there or not.
fn left_by_a_jump(case: &Case, plant: &Plant) -> f64 {
    0.5 * case.inputs.t_sample * case.finer as f64 * plant.rated.omega_sync
}

/// Instruments through which a speed may have been read: the counts of an encoder. Whether that is so is asked
/// later; until then a start that is unknown looks different through each of them.
fn speedometers(case: &Case, plant: &Plant) -> Vec<EffectConfig> {
    let is_judged = case.weight.iter().any(|w| w[SPEED] > 0.0);
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
    /// Whether what it does beside its first order is asked for: what it does in either direction together.
    curved: bool,
    /// Their numbers.
    stretches: Vec<usize>,
}

impl Unknown {
    fn ranges<'a>(&'a self, stretches: &'a [Stretch]) -> impl Iterator<Item = &'a Range<usize>> {
        self.stretches.iter().map(|&k| &stretches[k].values)
    }

    fn opposite(&self) -> Vec<StateOffset> {
        let turned = |offset: &StateOffset| StateOffset {
            sample: offset.sample,
            psi_s: -offset.psi_s,
            psi_r: -offset.psi_r,
            omega_mech: -offset.omega_mech,
        };
        self.offsets.iter().map(turned).collect()
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
            offsets,
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
mod tests {
    use super::*;
    use crate::model::prediction::residual;
    use crate::specimen;

    /// What is left of a recording of a motor that was elsewhere, as a share of what was there before anything was taken out.
    fn left(case: &mut Case, plant: &Plant, elsewhere: StateOffset) -> f64 {
        left_through(None, case, plant, elsewhere)
    }

    /// The same where an instrument shows the speed, of the recording and of the model that is held against it.
    fn left_through(
        meter: Option<EffectConfig>,
        case: &mut Case,
        plant: &Plant,
        elsewhere: StateOffset,
    ) -> f64 {
        let shown = |offsets: &[StateOffset]| {
            let drive = Drive {
                offsets,
                ..Drive::of(case)
            };
            let mut outputs = run(case, plant, &drive, SpeedObserver::Off);
            if let Some(config) = &meter {
                let values = config.effect.prepared(&config.values, &plant.rated);
                config.effect.outputs(&values, &plant.rated, &mut outputs);
            }
            outputs
        };
        let (there, model) = (shown(&[elsewhere]), shown(&[]));
        let rows = (0..case.measured.len()).map(|row| row * case.decimation);
        case.measured = rows
            .map(|k| {
                let [a, b, c] = there.i_s_abc[k];
                [a, b, c, there.omega_mech[k], there.u_zero[k]]
            })
            .collect();
        let model = as_shown(case, &model);
        let error =
            |case: &Case| signal::dot(&residual(case, &model), &residual(case, &model)).sqrt();
        let before = error(case);
        case.nuisance = unknown_state(case, plant);
        error(case) / before
    }

    fn running() -> (Case, Plant) {
        let study = specimen::study(1.0, |_| 1.0);
        let case = Case {
            nuisance: Nuisance::default(),
            ..study.fitted.case
        };
        (case, study.prior.plant)
    }

    /// The motor's equations are linear but for products of speed, flux and current: what is left is of second order, ten times
    /// as little of what began ten times as near.
    #[test]
    fn a_motor_that_began_elsewhere_is_explained() {
        let begun = |share: f64| {
            let (mut case, plant) = running();
            let flux = share * plant.rated.flux();
            let elsewhere = StateOffset {
                sample: 0,
                psi_s: Complex64::from_polar(flux, 0.3),
                psi_r: Complex64::from_polar(flux, -2.0),
                omega_mech: 0.1 * share * plant.rated.speed(),
            };
            left(&mut case, &plant, elsewhere)
        };
        let (far, near) = (begun(0.1), begun(0.01));
        // A tenth of the flux and a hundredth of the speed: products of both, some of them.
        assert!(far < 0.05, "{far}");
        assert!(near < 0.15 * far, "{near} {far}");
    }

    /// The counts of an encoder show a start that is unknown as another one.
    #[test]
    fn a_motor_that_began_elsewhere_is_explained_through_an_encoder_too() {
        let through = |delay_s: f64| {
            let (mut case, plant) = running();
            let encoder = motor::effects::find("speed-delay", "mean").expect("in the library");
            let mut meter = EffectConfig::absent(encoder, &plant.rated);
            meter.values[0] = delay_s;
            let elsewhere = StateOffset {
                sample: 0,
                psi_s: Complex64::ZERO,
                psi_r: Complex64::ZERO,
                omega_mech: 0.01 * plant.rated.speed(),
            };
            left_through(Some(meter), &mut case, &plant, elsewhere)
        };
        // One of those that are looked through leaves what is of second order, a hundredth of the speed; between two of them half
        // of what is left without any (0.076) must be gone at least.
        assert!(through(5e-3) < 0.02, "{}", through(5e-3));
        assert!(through(3.5e-3) < 0.038, "{}", through(3.5e-3));
    }

    /// A voltage that jumps between two samples leaves a part of a sampling interval in the stator flux.
    #[test]
    fn the_instant_of_a_jump_is_unknown() {
        let (mut case, plant) = running();
        let n = case.inputs.u_s.len();
        let elsewhere = StateOffset {
            sample: n / 2,
            psi_s: Complex64::new(0.0, 0.02 * plant.rated.flux()),
            psi_r: Complex64::ZERO,
            omega_mech: 0.0,
        };
        case.running_at = None;
        let smooth = left(&mut case.clone(), &plant, elsewhere);
        assert_eq!(smooth, 1.0, "nothing jumps there");
        case.supply.segments = vec![0..n / 2, n / 2..n];
        let left = left(&mut case, &plant, elsewhere);
        assert!(left < 0.01, "{left}");
    }

    /// A slow recording leaves so much open that the first order alone is not enough: of the same eight hundredths of the flux, in any
    /// direction, at least nine tenths of what the first order leaves is gone.
    #[test]
    fn what_a_jump_leaves_in_a_slow_recording_is_unknown_to_second_order() {
        let (mut case, plant) = running();
        let n = case.inputs.u_s.len();
        case.running_at = None;
        case.supply.segments = vec![0..n / 2, n / 2..n];
        for angle in [0.3, 1.2, 2.4, 4.0] {
            let elsewhere = StateOffset {
                sample: n / 2,
                psi_s: Complex64::from_polar(0.08 * plant.rated.flux(), angle),
                psi_r: Complex64::ZERO,
                omega_mech: 0.0,
            };
            case.finer = 1;
            let first = left(&mut case.clone(), &plant, elsewhere);
            case.finer = 3;
            assert!(left_by_a_jump(&case, &plant) > CURVED);
            let second = left(&mut case.clone(), &plant, elsewhere);
            assert!(second < 0.1 * first, "{angle}: {first} {second}");
        }
    }

    /// An instrument that averages the speed changes nothing else, and needs nothing else: what it is shown here is enough.
    #[test]
    fn an_instrument_of_the_speed_reads_the_speed_alone() {
        let (case, plant) = running();
        let outputs = run(&case, &plant, &Drive::of(&case), SpeedObserver::Off);
        let meters = speedometers(&case, &plant);
        assert!(!meters.is_empty());
        for meter in meters {
            let mut whole = outputs.clone();
            let values = meter.effect.prepared(&meter.values, &plant.rated);
            meter.effect.outputs(&values, &plant.rated, &mut whole);
            assert_ne!(whole.omega_mech, outputs.omega_mech);
            assert_eq!(
                read_by(&meter, &plant, &speed_of(&outputs)),
                whole.omega_mech
            );
            whole.omega_mech.clone_from(&outputs.omega_mech);
            assert_eq!(whole, outputs);
        }
    }

    /// Of a motor that starts from rest on a smooth supply everything is known.
    #[test]
    fn a_start_from_rest_leaves_nothing_open() {
        let (mut case, plant) = running();
        case.running_at = None;
        assert!(unknowns(&stretches(&case), &plant, 0.1).is_empty());
    }
}
