use super::*;
use crate::data::case::{Case, Waveform};
use crate::data::channels::N_CHANNELS;
use crate::model::prediction::{SpeedObserver, outputs, residual};
use crate::specimen::{self, T_SAMPLE};
use motor::effects::find;
use recording::{Channel, Metadata, Recording};

/// Time between samples of the recordings that are only cut, s.
const SLOW: f64 = 0.01;

/// A recording of nothing but a torque.
fn only_torque(seconds: f64, torque: impl Fn(f64) -> f64) -> Recording {
    let t: Vec<f64> = (0..(seconds / SLOW) as usize)
        .map(|k| k as f64 * SLOW)
        .collect();
    let values = t.iter().map(|&t| torque(t)).collect();
    let empty = Recording::new("torque", t, Metadata::default()).expect("an even clock");
    empty
        .with_channel(Channel::TORQUE, values)
        .expect("as long as the clock")
}

fn times(stretches: &[Stretch]) -> Vec<(f64, f64)> {
    let judged = |s: &Stretch| s.samples.start + s.settles;
    stretches
        .iter()
        .map(|s| (judged(s) as f64 * SLOW, s.samples.end as f64 * SLOW))
        .collect()
}

#[test]
fn a_minute_is_taken_whole() {
    assert_eq!(stretches(&only_torque(60.0, |_| 1.0)), None);
}

/// A constant load has nothing but its time: sixteen stretches of two seconds, none farther from the next than two
/// sixteenths of the recording (farthest-first is at most twice as coarse as the best choice).
#[test]
fn a_constant_load_is_looked_at_from_begin_to_end() {
    let taken = times(&stretches(&only_torque(600.0, |_| 1.0)).expect("long"));
    assert_eq!(taken[0].0, 0.0);
    let judged: f64 = taken.iter().map(|(from, to)| to - from).sum();
    assert!((judged - 32.0).abs() < 1e-9, "{judged}");
    for pair in taken.windows(2) {
        assert!(pair[1].0 - pair[0].1 < 75.0, "{taken:?}");
    }
    assert!(taken.last().unwrap().1 > 525.0, "{taken:?}");
}

/// Half a second of another load in ten minutes is seen, and so is each of five loads.
#[test]
fn what_happens_once_is_taken() {
    let knock = |t: f64| {
        if (307.2..307.7).contains(&t) {
            1.5
        } else {
            1.0
        }
    };
    let taken = times(&stretches(&only_torque(600.0, knock)).expect("long"));
    let holds = |t: f64| taken.iter().any(|(from, to)| (*from..*to).contains(&t));
    assert!(holds(307.2) && holds(307.6), "{taken:?}");
    let loads = only_torque(600.0, |t| 0.2 + 0.2 * (t / 120.0).floor());
    let taken = times(&stretches(&loads).expect("long"));
    for load in 0..5 {
        let begin = 120.0 * f64::from(load);
        let within = |(from, to): &(f64, f64)| *from >= begin && *to <= begin + 120.0;
        assert!(taken.iter().any(within), "{load}: {taken:?}");
    }
}

#[test]
fn the_stretches_are_told() {
    assert_eq!(told(&only_torque(30.0, |_| 1.0)), None);
    let words = told(&only_torque(100.0, |_| 1.0)).expect("long");
    assert!(words.starts_with("32 s of the 100 s are used"), "{words}");
    assert!(
        words.contains(": 0..2, ") && words.ends_with(" s"),
        "{words}"
    );
}

#[test]
fn fluxes_settle_before_a_stretch_but_not_before_the_recording() {
    let taken = stretches(&only_torque(100.0, |_| 1.0)).expect("long");
    assert_eq!((taken[0].samples.start, taken[0].settles), (0, 0));
    assert!(taken[1..].iter().all(|s| s.settles == 50));
}

fn two_parts() -> Vec<Stretch> {
    let at = |t: f64| (t / T_SAMPLE).round() as usize;
    let part = |from: f64, to: f64, settles: f64| Stretch {
        samples: at(from)..at(to),
        settles: at(settles),
    };
    vec![part(0.0, 1.0, 0.0), part(3.0, 4.5, 0.5)]
}

fn cut_waveform(torque: impl Fn(f64) -> f64) -> Waveform {
    let rated = specimen::prior("").plant.rated;
    let whole = Waveform::new(&specimen::recording(5.0, torque), &rated).expect("judged");
    cut(&whole, &rated, &two_parts())
}

/// The motor's steady state in closed form on both sides of the cut: nothing is left, and the clock goes on.
#[test]
fn a_cut_leaves_no_error_and_keeps_the_clock() {
    let prior = specimen::prior("");
    let waveform = cut_waveform(|t| if t < 2.0 { 1.0 } else { 0.4 });
    let case = Case::from(waveform.clone());
    let h = crate::model::prior::Hypothesis::at_prior(false);
    let r = residual(&case, &outputs(&case, &prior, &h, SpeedObserver::Off));
    let judged: Vec<f64> = case
        .weight()
        .iter()
        .flatten()
        .zip(&r)
        .filter(|(w, _)| **w > 0.0)
        .map(|(_, r)| r * r)
        .collect();
    assert_eq!(judged.len() as f64, case.judged());
    let rms = (judged.iter().sum::<f64>() / judged.len() as f64).sqrt();
    // In units of the declared noise, which the samples do not have: what is left is the integration.
    assert!(rms < 0.1, "{rms}");
    let first = waveform.time_of(0);
    let rows = waveform.measured.len();
    let step = waveform.time_of(rows - 1) - waveform.time_of(0);
    assert!(first == 0.0 && (4.4..4.5).contains(&step), "{step}");
    let half = waveform.weight.iter().position(|w| *w == [0.0; N_CHANNELS]);
    let half = half.expect("fluxes settle");
    assert!((waveform.time_of(half) - 3.0).abs() < 0.01);
}

/// The shaft goes on turning where a part was left out: 2 s at the speed of the load.
#[test]
fn the_shaft_turns_through_a_cut() {
    let case = cut_waveform(|_| 1.0);
    let omega = specimen::point(1.0).omega_mech;
    let theta = &case.timeline.theta_mech;
    let cut = case.timeline.cuts[0].sample;
    let across = (theta[cut] - theta[cut - 1]) / omega;
    let left_out = 3.0 - (cut - 1) as f64 * T_SAMPLE;
    assert!((across - left_out).abs() < 1e-6, "{across} {left_out}");
}

/// A winding that warms is as warm after the cut as the clock says, in closed form.
#[test]
fn an_effect_over_time_follows_the_clock() {
    let prior = specimen::prior("");
    let case = cut_waveform(|_| 1.0);
    let with = |entry: &str| {
        let file = specimen::motor(entry);
        motor::effect::from_motor_file(&file, "specimen.toml").expect("valid effects")
    };
    let currents = |plant: &motor::effect::Plant| {
        let drive = crate::model::prediction::Drive::of(&case);
        crate::model::prediction::outputs_on(&case, plant, &drive)
    };
    let mut warm = prior.plant.clone();
    warm.effects = with(
        "[[effects]]\nname = \"stator-heating\"\nresistance_rise = 0.2\ntime_constant_s = 5.0\n",
    );
    let warm = currents(&warm);
    // At the end of the second part: 8 (1 + 0.2 (1 - e^(-4.4/5))) ohm.
    let mut hot = prior.plant.clone();
    hot.motor.r_s *= 1.0 + 0.2 * (1.0 - (-4.4f64 / 5.0).exp());
    let (hot, cold) = (currents(&hot), currents(&prior.plant));
    let row = case.measured.len() - (0.1 / case.t_row()).round() as usize;
    let near = |a: &[f64], b: &[f64]| {
        let around = (row - 40) * N_CHANNELS..(row + 40) * N_CHANNELS;
        let pairs = a[around.clone()].iter().zip(&b[around]);
        pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    assert!(find("stator-heating", "").is_some());
    assert!(near(&warm, &hot) < 0.02 * near(&cold, &hot));
}
