use super::*;
use crate::data::case::Case;
use crate::fit::output_error::Effort;
use crate::specimen;
use recording::Recording;

/// Errors of gain and zero (share of the rated amplitude) of va, vb, vc, ia, ib, ic: within class 0.5.
const ERRORS: [(f64, f64); 6] = [
    (0.006, 0.008),
    (-0.004, -0.006),
    (0.002, 0.004),
    (0.008, 0.006),
    (-0.006, 0.002),
    (0.004, -0.008),
];

fn electrical() -> [Channel; 6] {
    let [a, b, c] = Channel::VOLTAGES;
    let [d, e, f] = Channel::CURRENTS;
    [a, b, c, d, e, f]
}

/// Two seconds of the small motor as a recorder with these errors shows it.
fn shown(errors: [(f64, f64); 6]) -> Recording {
    let rated = specimen::prior("").plant.rated;
    let amplitude = [[rated.voltage; 3], [rated.current; 3]].concat();
    specimen::changed(&specimen::recording(2.0, |_| 1.0), |channel, x| {
        let place = electrical().iter().position(|known| *known == channel);
        let Some(k) = place else { return Some(x) };
        let (gain, zero) = errors[k];
        let one = |x: f64| (1.0 + gain) * x + zero * amplitude[k];
        Some(x.into_iter().map(one).collect())
    })
}

fn asked(errors: [(f64, f64); 6]) -> (Study, Trial) {
    let prior = specimen::prior("");
    let case = Case::new(&shown(errors), &prior.plant.rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
    (study, trial)
}

#[test]
fn what_all_channels_are_off_by_is_found_together() {
    let (study, plain) = asked(ERRORS);
    let (beside, baseline) = study
        .with_unknown_instruments(&plain)
        .expect("samples over time");
    assert!(beside.instruments_explain_most(&baseline));
    let report = beside
        .channels(&baseline, &baseline)
        .expect("a study that knows");
    assert!(report.held_out_error_over_noise < 1.05);
    assert!(report.held_out_error_over_noise_without > 1.3 * report.held_out_error_over_noise);
    let names: Vec<&str> = report.channels.iter().map(|c| c.channel.as_str()).collect();
    assert_eq!(names, ["va", "vb", "vc", "ia", "ib", "ic", "torque"]);
    assert!(
        report.channels.iter().all(|c| c.is_within_class),
        "{report:?}"
    );
    // What three gains have in common is the motor's impedance as well: their differences are told.
    for group in [0, 3] {
        for k in [1, 2] {
            let of = |k: usize| report.channels[group + k].gain_error_percent;
            let true_of = |k: usize| 100.0 * ERRORS[group + k].0;
            let off = (of(k) - of(0)) - (true_of(k) - true_of(0));
            // A tenth of a per cent: a third of the class.
            assert!(off.abs() < 0.1, "{group} {k}: {off}");
        }
    }
    assert!(study.channels(&plain, &plain).is_none());
    assert!(beside.with_unknown_instruments(&baseline).is_none());
}

#[test]
fn exact_channels_are_no_part_of_an_answer() {
    let (study, plain) = asked([(0.0, 0.0); 6]);
    let (beside, baseline) = study
        .with_unknown_instruments(&plain)
        .expect("samples over time");
    assert!(!beside.instruments_explain_most(&baseline));
    assert_eq!(study.taken_by_instruments(&plain), 0.0);
    assert!(beside.channels(&baseline, &baseline).is_none());
    assert!(beside.gains_are_plausible(&baseline));
    assert!(!beside.has_a_channel_out_of_order(&baseline));
    let table = specimen::table_study(|_| ());
    let bare = specimen::trial_with(&table, &[]);
    assert!(table.with_unknown_instruments(&bare).is_none());
}

#[test]
fn a_gain_out_of_order_is_not_plausible() {
    let mut errors = [(0.0, 0.0); 6];
    errors[4].0 = 0.04;
    let (study, plain) = asked(errors);
    let (beside, baseline) = study
        .with_unknown_instruments(&plain)
        .expect("samples over time");
    assert!(!beside.gains_are_plausible(&baseline));
    assert!(beside.has_a_channel_out_of_order(&baseline));
}

#[test]
fn a_zero_is_out_of_order_from_three_per_cent_of_the_rated_amplitude_on() {
    let is_out_of_order = |zero: f64| {
        let mut errors = [(0.0, 0.0); 6];
        errors[3].1 = zero;
        let (study, plain) = asked(errors);
        let unknown = study.with_unknown_instruments(&plain);
        let (beside, baseline) = unknown.expect("samples over time");
        beside.has_a_channel_out_of_order(&baseline)
    };
    assert!(is_out_of_order(0.06) && !is_out_of_order(0.015));
}

/// A torque that is shown 4 ms late while the load steps.
#[test]
fn a_late_torque_is_read_to_a_tenth() {
    let stepping = |t: f64| if (0.8..1.4).contains(&t) { 1.2 } else { 0.3 };
    let exact = specimen::recording(2.0, stepping);
    let late_by = (0.004 / (exact.t()[1] - exact.t()[0])).round() as usize;
    let shown = specimen::changed(&exact, |channel, x| match channel == Channel::TORQUE {
        true => Some((0..x.len()).map(|k| x[k.saturating_sub(late_by)]).collect()),
        false => Some(x),
    });
    let prior = specimen::prior("");
    let case = Case::new(&shown, &prior.plant.rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let plain = study.trial(&study.at_prior(), Effort::FULL);
    let unknown = study.with_unknown_instruments(&plain);
    let (beside, baseline) = unknown.expect("samples over time");
    let report = beside
        .channels(&baseline, &baseline)
        .expect("a late torque");
    let torque = report.lags.iter().find(|lag| lag.instrument == "torque");
    let read = torque.expect("a lag").late_by_second;
    assert!((read - 0.004).abs() < 0.0004, "{read}");
}

#[test]
fn the_furthest_are_told_and_those_beyond_the_class_named() {
    let channel = |channel: Channel, gain, zero| ChannelReport::new(channel, gain, zero, 10.0);
    let told = |channels| {
        let report = ChannelsReport {
            held_out_error_over_noise_without: 5.831,
            held_out_error_over_noise: 1.032,
            channels,
            lags: vec![LagReport {
                instrument: "torque".to_owned(),
                late_by_second: 0.00412,
            }],
        };
        report.told()
    };
    let [ia, ib, _] = Channel::CURRENTS;
    let within = told(vec![channel(ia, 0.002, -0.05), channel(ib, -0.004, 0.01)]);
    assert_eq!(
        within,
        " The recorder's channels are off, too: gains by up to -0.40 % (ib), zeros by up to -0.50 % (ia) of the rated amplitude; with \
         that alone the error falls from 5.83 to 1.03 x noise. Late are: torque 4.1 ms."
    );
    let beyond = told(vec![channel(ia, 0.021, 0.0)]);
    assert!(beyond.contains(
        " Further off than instruments of class 0.5 are: ia gain +2.10 %, zero +0.000 A."
    ));
}
