//! What must be left out is left out, and comes back when the flux is known again.

use super::plant::{MOTOR, Plant, State};
use super::rows::INSTRUMENT;
use super::{believed, cycles};
use crate::{MotionCycle, MotionSample, NotInMotion};
use monitor::{ClippedChannels, SpeedSample};

/// `3 L_r/R_r` of the motor, in cycles.
fn memory() -> usize {
    let time = 3.0 * (MOTOR.l_lr + MOTOR.l_m) / MOTOR.r_r;
    (time / 0.02).ceil() as usize
}

fn reasons(cycles: &[MotionCycle]) -> Vec<Option<NotInMotion>> {
    cycles.iter().map(|cycle| cycle.not_judged).collect()
}

#[test]
fn a_start_from_rest_is_judged_from_the_third_cycle_on() {
    let cycles = cycles(&believed(&INSTRUMENT), &INSTRUMENT.run(0.4, 1));
    let reasons = reasons(&cycles);
    assert_eq!(reasons[..2], [Some(NotInMotion::FluxUnknown); 2]);
    assert!(reasons[2..].iter().all(Option::is_none), "{reasons:?}");
}

/// What runs already when the samples begin has a flux that must first be found: four rotor time constants.
#[test]
fn on_a_turning_shaft_the_flux_must_first_be_forgotten() {
    let samples = INSTRUMENT.run(2.0, 2);
    let late = &samples[8000..];
    let cycles = cycles(&believed(&INSTRUMENT), late);
    let left_out = cycles.iter().take_while(|c| c.not_judged.is_some()).count();
    let expected = (memory() as f64 * 4.0 / 3.0) as usize;
    assert!(
        left_out.abs_diff(expected) <= 2,
        "{left_out} and {expected}"
    );
    assert!(cycles[left_out..].iter().all(|c| c.not_judged.is_none()));
    let rows = cycles[left_out..].iter().flat_map(|c| c.rows[..4].to_vec());
    assert!(super::root_mean_square(rows) < 0.26 * 0.006);
}

#[test]
fn a_clip_is_remembered_for_three_rotor_time_constants() {
    let mut samples = INSTRUMENT.run(1.5, 3);
    let mut clipped = ClippedChannels::NONE;
    clipped.mark_current(1);
    samples[5030].0.sample.clipped = clipped;
    let cycles = cycles(&believed(&INSTRUMENT), &samples);
    let out = |c: &&MotionCycle| c.not_judged == Some(NotInMotion::Clipped);
    assert!(cycles.iter().filter(out).count().abs_diff(memory()) <= 1);
    assert!(cycles.last().is_some_and(|c| c.not_judged.is_none()));
}

/// Plugging: the field is reversed on a turning shaft, slip above 1.
#[test]
fn against_the_field_nothing_is_judged() {
    let plant = Plant {
        reverses_s: 0.8,
        ..INSTRUMENT
    };
    let cycles = cycles(&believed(&plant), &plant.run(0.95, 4));
    let braking = &cycles[42..46];
    let out = |c: &MotionCycle| c.not_judged == Some(NotInMotion::AgainstField);
    assert!(braking.iter().all(out), "{:?}", reasons(&cycles));
    assert!(cycles.iter().all(|c| c.alarm.is_none()));
}

#[test]
fn without_current_supply_or_speed_nothing_is_judged() {
    let dark = |t: f64| if t < 0.5 { 1.0 } else { 0.0 };
    let plant = Plant {
        supply: dark,
        ..INSTRUMENT
    };
    let mut samples = plant.run(1.2, 5);
    for (sample, _) in samples.iter_mut().skip(11_000) {
        sample.supply = None;
    }
    let after = cycles(&believed(&plant), &samples);
    assert_eq!(
        after.last().map(|c| c.not_judged),
        Some(Some(NotInMotion::NoSupply))
    );
    for (sample, _) in &mut samples {
        sample.sample.speed = SpeedSample::None;
    }
    let without = cycles(&believed(&plant), &samples);
    assert!(!without.is_empty());
    assert!(
        without
            .iter()
            .all(|c| c.not_judged == Some(NotInMotion::Missing))
    );
}

/// Numbers that are none, absurd counts and infinities end in "not judged", not in a panic or an alarm.
#[test]
fn what_is_no_number_raises_nothing() {
    let poison: [fn(&mut MotionSample); 4] = [
        |s| s.sample.i_s_abc.as_mut().expect("there").a = f32::NAN,
        |s| s.sample.u_s_abc.as_mut().expect("there").c = f32::INFINITY,
        |s| s.sample.speed = SpeedSample::RadPerSecond(f32::NAN),
        |s| s.sample.speed = SpeedSample::Count(30_000),
    ];
    for (kind, poison) in poison.into_iter().enumerate() {
        let mut samples: Vec<(MotionSample, State)> = INSTRUMENT.run(0.6, 6);
        for (sample, _) in samples.iter_mut().skip(3000).step_by(50).take(20) {
            poison(sample);
        }
        let cycles = cycles(&believed(&INSTRUMENT), &samples);
        let alarm = cycles.iter().find(|c| c.alarm.is_some());
        assert!(alarm.is_none(), "{kind}: {alarm:?}");
        assert!(cycles.iter().all(|c| c.rows.iter().all(|x| x.is_finite())));
    }
}
