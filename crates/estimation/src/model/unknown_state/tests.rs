use super::*;
use crate::model::prediction::{residual, weighted};
use crate::specimen;

/// What is left of a recording of a motor that was elsewhere, as a share of what was there before anything was taken out.
fn left(case: &mut Waveform, plant: &Plant, elsewhere: StateOffset) -> f64 {
    left_through(None, case, plant, elsewhere)
}

/// The same where an instrument shows the speed, of the recording and of the model that is held against it.
fn left_through(
    meter: Option<EffectConfig>,
    case: &mut Waveform,
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
    let error = |case: &Waveform| length(&residual(&case.clone().into(), &weighted(case, &model)));
    let before = error(case);
    case.nuisance = unknown_state(case, plant);
    error(case) / before
}

fn running() -> (Waveform, Plant) {
    let prior = specimen::prior("");
    let rec = specimen::recording(1.0, |_| 1.0);
    let waveform = Waveform::new(&rec, &prior.plant.rated).expect("judged");
    (waveform, prior.plant)
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

/// The case with its speed given, and currents of a negative sequence: amplitude in A.
fn driven_by_its_speed(negative: f64) -> (Waveform, Plant) {
    let (mut case, plant) = running();
    case.speed_is_input = true;
    case.running_at = None;
    case.speed = vec![0.98 * plant.rated.speed(); case.inputs.u_s.len()];
    let (t_row, omega) = (case.t_row(), plant.rated.omega_sync);
    for (row, measured) in case.measured.iter_mut().enumerate() {
        for (phase, current) in measured[..3].iter_mut().enumerate() {
            let shift = std::f64::consts::TAU / 3.0 * phase as f64;
            *current += negative * (omega * t_row * row as f64 + shift - 0.4).cos();
        }
    }
    (case, plant)
}

/// Flux times current of negative sequence is a torque, and over twice the frequency and the inertia a speed.
#[test]
fn a_ripple_is_expected_to_be_as_large_as_its_torque_makes_it() {
    let (case, plant) = driven_by_its_speed(0.05);
    let (rated, inertia) = (&plant.rated, plant.mechanics.inertia);
    let torque = 1.5 * rated.n_p * rated.flux() * 0.05;
    let expected = torque / (2.0 * rated.omega_sync * inertia);
    for ripple in Ripple::expected(&case, &plant) {
        let moved = ripple.added(&case);
        let largest = moved.iter().zip(&case.speed);
        let found = largest.fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        // 41.7 samples a period of the ripple: the largest may miss the amplitude by 1 - cos(pi/41.7), 0.3 %.
        assert!((found / expected - 1.0).abs() < 3e-3, "{found} {expected}");
    }
}

/// The same motor with two phases swapped: its field turns backwards.
#[test]
fn a_field_that_turns_backwards_ripples_as_much() {
    let (case, plant) = driven_by_its_speed(0.05);
    let forward = Ripple::expected(&case, &plant);
    let mut swapped = case.clone();
    let timeline = std::sync::Arc::make_mut(&mut swapped.timeline);
    timeline
        .omega_sync
        .iter_mut()
        .for_each(|omega| *omega = -*omega);
    swapped.inputs.u_s.iter_mut().for_each(|u| *u = u.conj());
    swapped.measured.iter_mut().for_each(|row| row.swap(1, 2));
    let largest = |ripple: &Ripple, case: &Waveform| {
        let moved = ripple.added(case);
        let both = moved.iter().zip(&case.speed);
        both.fold(0.0f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let [forth, back] = [
        largest(&forward[0], &case),
        largest(&Ripple::expected(&swapped, &plant)[0], &swapped),
    ];
    // The same sums in another order.
    assert!((back / forth - 1.0).abs() < 1e-9, "{forth} {back}");
}

/// What is left where the motor's shaft trembles beside the speed that is given: 0.01 rad/s at `over` times the supply's frequency.
fn left_of_a_trembling(over: f64, plant: &Plant, case: &Waveform) -> f64 {
    let (omega, t_sample) = (over * plant.rated.omega_sync, case.inputs.t_sample);
    let trembling =
        |(k, mean): (usize, &f64)| mean + 0.01 * (omega * t_sample * k as f64 + 0.7).cos();
    let drive = Drive {
        speed: Cow::Owned(case.speed.iter().enumerate().map(trembling).collect()),
        ..Drive::of(case)
    };
    let of = |drive: &Drive<'_>| as_shown(case, &run(case, plant, drive, SpeedObserver::Off));
    let mut rows = of(&drive);
    take(&mut rows, &of(&Drive::of(case)));
    left_of(case, plant, rows)
}

/// Length of what a case's unknowns leave of weighted rows, as a share of theirs.
fn left_of(case: &Waveform, plant: &Plant, mut rows: Vec<f64>) -> f64 {
    let before = length(&rows);
    unknown_state(case, plant).project_out(&mut rows);
    length(&rows) / before
}

#[test]
fn a_ripple_at_twice_the_supplys_frequency_is_unknown_where_the_speed_is_given() {
    let (case, plant) = driven_by_its_speed(0.2);
    let twice = left_of_a_trembling(2.0, &plant, &case);
    // One over the response's length in deviations: what is expected here stands out of the noise by far more than ten of them.
    assert!(twice < 0.1, "{twice}");
    // A fan's ripple at another frequency is no part of it.
    let other = left_of_a_trembling(1.5, &plant, &case);
    assert!(other > 0.95, "{other}");
    // Nor is any expected of balanced currents.
    let (case, plant) = driven_by_its_speed(0.0);
    let balanced = left_of_a_trembling(2.0, &plant, &case);
    assert!(balanced > 0.95, "{balanced}");
}

/// What makes currents of negative sequence makes none of three times the frequency, as a ripple does: it is still seen.
#[test]
fn an_unknown_ripple_does_not_hide_an_asymmetry() {
    let (case, plant) = driven_by_its_speed(0.2);
    let mut asymmetric = plant.clone();
    let effect = motor::effects::find("stator-asymmetry", "").expect("in the library");
    let mut config = EffectConfig::absent(effect, &plant.rated);
    config.values[0] = 0.02;
    asymmetric.effects.push(config);
    let of = |plant| {
        as_shown(
            &case,
            &run(&case, plant, &Drive::of(&case), SpeedObserver::Off),
        )
    };
    let mut rows = of(&asymmetric);
    take(&mut rows, &of(&plant));
    let left = left_of(&case, &plant, rows);
    // The two have the currents of negative sequence in common, and no others: most of the asymmetry must be left.
    assert!(left > 0.8, "{left}");
}

/// An encoder's counts in 10 ms hold none of the ripple that the shaft has: no model is judged by it. A tachometer shows it.
#[test]
fn the_ripple_of_counts_is_not_judged() {
    let (mut case, plant) = running();
    case.running_at = None;
    let t_row = case.t_row();
    let rows = case.measured.len();
    let ripple = |over: f64| {
        let omega = over * plant.rated.omega_sync;
        let mut values = vec![0.0; rows * N_CHANNELS];
        for row in 0..rows {
            values[row * N_CHANNELS + SPEED] = (omega * t_row * row as f64 + 0.4).cos();
        }
        values
    };
    let count = |row: usize| (187.3 + 0.3 * (0.05 * row as f64).sin()).round();
    for (row, measured) in case.measured.iter_mut().enumerate() {
        measured[SPEED] = count(row);
    }
    let counted = left_of(&case, &plant, ripple(2.0));
    assert!(counted < 0.02, "{counted}");
    let slower = left_of(&case, &plant, ripple(0.7));
    assert!(slower > 0.98, "{slower}");
    for (row, measured) in case.measured.iter_mut().enumerate() {
        measured[SPEED] = 187.3 + 0.1 * (0.61 * (row * row) as f64).sin();
    }
    assert_eq!(left_of(&case, &plant, ripple(2.0)), 1.0);
}
