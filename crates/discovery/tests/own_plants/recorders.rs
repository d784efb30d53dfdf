//! Recordings of a recorder whose channels are off.

use super::SEED;
use super::foreign::laws::Law;
use super::foreign::{Course, Hidden, LOADS, Machine, STEPS, U, priors, record};
use discovery::{ExplainReport, Verdict, adopt, explain};
use recording::Channel;

/// Samples of a window in which the pulses of an encoder are counted.
const WINDOW: usize = 100;
/// How late the mean of a window is where it is shown first, s: half of it.
const LATE_BY: f64 = 0.005;

/// A recording as a recorder shows it whose channels are off by up to 0.6 %, and which counts the pulses
/// of an encoder over 10 ms.
fn through_a_recorder(
    machine: &Machine,
    hidden: &Hidden,
    course: &Course,
    seed: u64,
) -> recording::Source {
    let rec = record(machine, hidden, course, seed);
    let gains = [0.006, -0.005, 0.003, 0.006, -0.006, 0.004];
    let zeros = [0.006, -0.004, 0.002, 0.006, 0.005, -0.006];
    let counted = |x: &[f64]| {
        let before = |k: usize| (k / WINDOW * WINDOW).saturating_sub(WINDOW);
        let mean = |k: usize| x[before(k)..before(k) + WINDOW].iter().sum::<f64>() / WINDOW as f64;
        (0..x.len()).map(mean).collect::<Vec<f64>>()
    };
    let empty = recording::Recording::new("shown", rec.t().to_vec(), rec.metadata.clone());
    let shown = rec
        .channels()
        .fold(empty.expect("a clock"), |to, (channel, x)| {
            let phases = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
            let shown = match phases.zip(0..6).find(|(known, _)| *known == channel) {
                Some((_, k)) => {
                    let rated = if k < 3 { U } else { machine.current };
                    x.iter()
                        .map(|x| (1.0 + gains[k]) * x + zeros[k] * rated)
                        .collect()
                }
                None if channel == Channel::SPEED => counted(x),
                None => x.to_vec(),
            };
            to.with_channel(channel, shown).expect("as long")
        });
    recording::Source::Recording(shown)
}

/// Two recordings of one recorder.
fn two_through_a_recorder(machine: &Machine, hidden: &Hidden) -> [recording::Source; 2] {
    [
        through_a_recorder(machine, hidden, &LOADS, SEED),
        through_a_recorder(machine, hidden, &STEPS, SEED + 1),
    ]
}

/// What is said of two recordings of one recorder.
fn explained_through_a_recorder(hidden: &Hidden) -> ExplainReport {
    let machine = Machine::of(SEED);
    let sources = two_through_a_recorder(&machine, hidden);
    let report = explain(&sources, &priors(&machine, SEED), &mut |_, _| {}).expect("judged");
    println!("{}", report.summary);
    report
}

/// Of a healthy motor nothing is named; what the recorder does is told beside the answer.
#[test]
fn nothing_of_the_motor_is_named_for_the_errors_of_a_recorder() {
    let report = explained_through_a_recorder(&Hidden::default());
    assert!(report.steps.is_empty() && report.laws.is_empty());
    assert_eq!(report.verdict, Verdict::Adequate);
    assert!(report.final_.expect("fitted").held_out_error_over_noise < 1.02);
    let told = report.channels.expect("channels that are off");
    let speed = told.lags.iter().find(|lag| lag.instrument == "speed");
    let late_by = speed.expect("a late speed").late_by_second;
    // To a fifth: a mean that is held is a delay to first order only.
    assert!((late_by - LATE_BY).abs() < 0.2 * LATE_BY, "{late_by}");
}

/// What is missing in the motor is found beside them, which are more than an explanation has effects.
#[test]
fn a_law_is_found_beside_the_errors_of_a_recorder() {
    let hidden = Hidden {
        law: Some(Law::Jaws),
        ..Hidden::default()
    };
    let report = explained_through_a_recorder(&hidden);
    assert!(report.channels.is_some());
    assert_eq!(report.verdict, Verdict::Law);
    assert!(report.laws.len() == 1 && Law::Jaws.is_named(&report.laws[0]));
}

/// The angle that a counter's late speed adds up to is put in time by as much in both recordings: by a lateness of each, the turn would begin
/// elsewhere in each and 1.13 times the noise be left.
#[test]
fn a_turn_begins_at_one_place_in_all_recordings_of_a_counter() {
    let hidden = Hidden {
        law: Some(Law::Piston),
        ..Hidden::default()
    };
    let report = explained_through_a_recorder(&hidden);
    assert_eq!(report.verdict, Verdict::Law);
    assert!(report.laws.len() == 1 && Law::Piston.is_named(&report.laws[0]));
    assert!(report.final_.expect("fitted").held_out_error_over_noise < 1.05);
}

/// An error of one channel is adopted as well, beside which those of all channels would leave nothing to ask for.
#[test]
fn an_offset_is_adopted_from_recordings_of_a_recorder() {
    let machine = Machine::of(SEED);
    let sources = two_through_a_recorder(&machine, &Hidden::default());
    let believed = priors(&machine, SEED);
    let (report, motor) =
        adopt("voltage-offset", &sources, &believed, &mut |_, _| {}).expect("adopted");
    assert!(report.proven && motor.effects[0].name == "voltage-offset");
}
