//! The decision against the same formulas in double precision by another library, and on faults that come in motion.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::plant::{Plant, press_torque};
use super::rows::INSTRUMENT;
use super::{MotionCycle, MotionState, believed, cycles};
use crate::decision::{Decision, Limits};
use crate::departures::{ALL, Hypothesis, UNKNOWNS};
use crate::information::{Information, ROWS, White};
use crate::{MotionSample, Named};
use monitor::{Cause, MovingCause, Phase, SensorFinding};

const LIMITS: Limits = Limits {
    statistic: 5.5,
    square: 75.0,
};

fn random_cycle(random: &mut Pcg64, departure: &[f64; UNKNOWNS]) -> White {
    let mut white = White::default();
    for (row, z) in white.sensitivities.iter_mut().zip(&mut white.rows) {
        let mut shown: f64 = StandardNormal.sample(random);
        for (a, q) in row.iter_mut().zip(departure) {
            let x: f64 = StandardNormal.sample(random);
            *a = (2.0 * x) as f32;
            shown -= 2.0 * x * q;
        }
        *z = shown as f32;
    }
    white
}

fn wide(x: &[f32; UNKNOWNS]) -> DVector<f64> {
    DVector::from_iterator(UNKNOWNS, x.iter().map(|x| f64::from(*x)))
}

/// `H` and `b` of cycles with weights, by definition.
fn information(cycles: &[(White, f64)]) -> (DMatrix<f64>, DVector<f64>) {
    let mut h = DMatrix::zeros(UNKNOWNS, UNKNOWNS);
    let mut b = DVector::zeros(UNKNOWNS);
    for (cycle, weight) in cycles {
        for (a, z) in cycle.sensitivities.iter().zip(cycle.rows) {
            let a = wide(a);
            h += &a * a.transpose() * *weight;
            b -= a * f64::from(z) * *weight;
        }
    }
    (h, b)
}

/// `T_h` as the document writes it.
fn statistics(p: &DMatrix<f64>, m: &DVector<f64>, h: &DMatrix<f64>, b: &DVector<f64>) -> Vec<f64> {
    let inverse = (p + h).try_inverse().expect("positive definite");
    let e = b - h * m;
    let u = &e - h * &inverse * &e;
    let w = h - h * &inverse * h;
    let of = |hypothesis: &Hypothesis| {
        let mut direction = [0.0; UNKNOWNS];
        hypothesis.add_direction(&mut direction);
        let v = wide(&direction);
        (v.transpose() * &u)[0] / (v.transpose() * &w * &v)[0].sqrt()
    };
    ALL.iter().map(of).collect()
}

/// Single precision, four roundings of sums over some hundred terms: 1e-3 of a statistic near the limit.
#[test]
fn statistics_agree_with_the_formulas_in_double_precision() {
    let mut random = Pcg64::seed_from_u64(4);
    let mut decision = Decision::default();
    let mut departure = [0.0; UNKNOWNS];
    let mut past = Vec::new();
    for k in 0..30 {
        departure[0] = if k < 24 { 0.0 } else { 0.5 };
        past.push(random_cycle(&mut random, &departure));
        let outcome = decision.take(
            &past[k],
            &Limits {
                statistic: 1e9,
                square: 1e9,
            },
        );
        let faded = |(n, c): (usize, &White)| (*c, 0.9_f64.powi((k - n) as i32));
        let (h, b) = information(&past.iter().enumerate().map(faded).collect::<Vec<_>>());
        let unit = DMatrix::identity(UNKNOWNS, UNKNOWNS);
        let mut expected = statistics(&unit, &DVector::zeros(UNKNOWNS), &h, &b);
        // Blocks of four: the latest and the waiting one against all before.
        let open = (k + 1) % 4;
        let baseline = (k + 1) - open - 4_usize.min(k + 1 - open);
        if baseline + 4 >= 18 {
            let blocks = baseline / 4;
            let old =
                |(n, c): (usize, &White)| (*c, 0.98_f64.powi(4 * (blocks - 1 - n / 4) as i32));
            let old: Vec<_> = past[..baseline].iter().enumerate().map(old).collect();
            let (h_old, b_old) = information(&old);
            let new: Vec<_> = past[baseline..].iter().map(|c| (*c, 1.0)).collect();
            let (h, b) = information(&new);
            let p = unit + h_old * 0.3;
            let m = p.clone().try_inverse().expect("positive definite") * b_old * 0.3;
            for (x, other) in expected.iter_mut().zip(statistics(&p, &m, &h, &b)) {
                if other.abs() > x.abs() {
                    *x = other;
                }
            }
        }
        let only_adds = |x: (&f64, &crate::departures::Hypothesis)| {
            if x.1.cause.only_adds() {
                x.0.max(0.0)
            } else {
                x.0.abs()
            }
        };
        let largest = expected.iter().zip(&ALL).map(only_adds).fold(0.0, f64::max);
        let got = f64::from(outcome.best.statistic.abs());
        // A series resistance whose negative statistic is the larger of its two counts as none: rare, and then only smaller.
        assert!(
            (got - largest).abs() < 5e-3 * (1.0 + largest),
            "{k}: {got} and {largest}"
        );
    }
}

/// Counting a departure from another point changes nothing that is said of the others.
#[test]
fn a_shifted_origin_is_what_other_rows_would_have_given() {
    let mut random = Pcg64::seed_from_u64(5);
    let cycle = random_cycle(&mut random, &[0.0; UNKNOWNS]);
    let (mut shifted, mut anew) = (Information::default(), Information::default());
    shifted.add(&cycle);
    shifted.shift(20, 0.7);
    let mut moved = cycle;
    for (z, a) in moved.rows.iter_mut().zip(&cycle.sensitivities) {
        *z += a[20] * 0.7;
    }
    anew.add(&moved);
    for (x, y) in shifted.vector.iter().zip(anew.vector) {
        assert!((x - y).abs() < 1e-4 * (1.0 + y.abs()), "{x} {y}");
    }
    assert_eq!(ROWS, 9);
}

#[test]
fn noise_alone_raises_no_alarm() {
    let mut random = Pcg64::seed_from_u64(6);
    let mut decision = Decision::default();
    for _ in 0..3000 {
        let outcome = decision.take(&random_cycle(&mut random, &[0.0; UNKNOWNS]), &LIMITS);
        assert!(!outcome.raised);
    }
}

fn press() -> Plant {
    Plant {
        load: press_torque,
        ..INSTRUMENT
    }
}

/// Cycles of the press with a change of the samples from 1.2 s on.
fn with_fault(mut change: impl FnMut(&mut MotionSample)) -> Vec<MotionCycle> {
    let plant = press();
    let motion = believed(&plant);
    let mut samples = plant.run(2.2, 8);
    samples
        .iter_mut()
        .skip(12_000)
        .for_each(|(sample, _)| change(sample));
    cycles(&motion, &samples)
}

fn alarm(cycles: &[MotionCycle]) -> (f64, Option<MovingCause>) {
    let raised = cycles.iter().find_map(|c| c.alarm).expect("an alarm");
    let named = cycles.iter().filter_map(|c| c.alarm).find_map(|a| a.named);
    let onset = raised.onset_sample as f64 * 1e-4;
    assert!((onset - 1.2).abs() < 0.06, "onset at {onset}");
    let cause = named.and_then(|named| match named {
        Named::Fault(fault) => Some(fault.cause),
        Named::Untold => None,
    });
    (raised.raised_sample as f64 * 1e-4 - 1.2, cause)
}

#[test]
fn a_healthy_press_is_judged_and_raises_nothing() {
    let cycles = with_fault(|_| {});
    let judged = cycles.iter().filter(|c| c.not_judged.is_none()).count();
    assert!(judged > 9 * cycles.len() / 10);
    assert!(cycles.iter().all(|c| c.alarm.is_none()));
}

#[test]
fn a_gain_that_jumps_in_a_press_is_found_within_the_time_of_the_document_and_named() {
    let cycles = with_fault(|s| s.sample.i_s_abc.as_mut().expect("there").b *= 1.05);
    let (delay, named) = alarm(&cycles);
    assert!(delay < 0.15, "{delay}");
    assert_eq!(
        named,
        Some(MovingCause::Departure(Cause::CurrentChannel(Phase::B)))
    );
}

#[test]
fn a_sensor_that_dies_in_a_press_is_named_by_its_silence() {
    let cycles = with_fault(|s| s.sample.u_s_abc.as_mut().expect("there").c = 0.0);
    let (delay, named) = alarm(&cycles);
    assert!(delay < 0.1, "{delay}");
    assert_eq!(
        named,
        Some(MovingCause::Dead(SensorFinding::DeadVoltage(Phase::C)))
    );
}

/// The state is what a board would carry: two matrices of 231 for each of five stores are 5 kB of it.
#[test]
fn the_state_stays_below_eight_kilobytes() {
    assert!(
        size_of::<MotionState>() < 8192,
        "{}",
        size_of::<MotionState>()
    );
}
