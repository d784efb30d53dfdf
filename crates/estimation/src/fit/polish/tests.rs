use super::*;
use crate::data::case::Case;
use crate::fit::uncertainty::coordinate_error;
use crate::model::prior::LEAKAGE;
use crate::specimen;
use recording::{Channel, Recording};

/// The recording with each channel's values passed through `f`.
fn mapped(rec: &Recording, f: impl Fn(Channel, f64) -> f64) -> Recording {
    let each = |channel, x: Vec<f64>| x.into_iter().map(|x| f(channel, x)).collect();
    specimen::changed(rec, |channel, x| Some(each(channel, x)))
}

/// What a channel has of these values, else nothing.
fn of(values: &[(Channel, f64)], channel: Channel) -> Option<f64> {
    values
        .iter()
        .find_map(|(known, value)| (*known == channel).then_some(*value))
}

/// The recording with these channels so many times what they are.
fn with_gains(rec: &Recording, gains: &[(Channel, f64)]) -> Recording {
    mapped(rec, |channel, x| of(gains, channel).unwrap_or(1.0) * x)
}

/// A recording asked beside its channels' errors: the study and the trial without them.
fn asked(rec: &Recording) -> (Study, Trial) {
    let prior = specimen::prior("");
    let case = Case::new(rec, &prior.plant.rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
    (study, trial)
}

/// Asserts that each nominal is what is believed, which is the truth, within three of its standard errors.
fn assert_known(study: &Study, trial: &Trial) {
    let beside = study.polished(trial);
    for &k in beside.fit.free.iter().filter(|k| **k < N_NOMINAL) {
        let off = off(study, beside, k);
        assert!(off.abs() < 3.0, "coordinate {k}: {off:.2} standard errors");
    }
}

/// How far a fitted coordinate is from what is believed, in its standard errors.
fn off(study: &Study, trial: &Trial, k: usize) -> f64 {
    let error = coordinate_error(trial, study.covariance(trial), k);
    trial.fit.hypothesis.z[k] / error
}

/// A constant load whose voltage channel a shows 0.3 % too much, as its class allows: without its gain the leakage takes it over;
/// beside it the leakage is known as well as it says.
#[test]
fn the_error_of_a_channel_is_not_turned_into_leakage() {
    let rec = specimen::recording(2.0, |_| 1.0);
    let (study, trial) = asked(&with_gains(&rec, &[(Channel::VOLTAGES[0], 1.003)]));
    let beside = study.polished(&trial);
    let leakage = |t: &Trial| t.fit.hypothesis.z[LEAKAGE];
    assert!(leakage(&trial) > 0.05, "{}", leakage(&trial));
    let at = beside
        .fit
        .free
        .iter()
        .position(|&k| k == LEAKAGE)
        .expect("fitted");
    let error = study.covariance(beside)[(at, at)].sqrt();
    assert!(
        leakage(beside) < 0.6 * leakage(&trial),
        "{}",
        leakage(beside)
    );
    assert!(
        leakage(beside).abs() < 2.0 * error,
        "{} {error}",
        leakage(beside)
    );
    assert_eq!(with_nominals(&trial, beside).effects.len(), 0);
}

/// Voltages and currents off within their class, each channel by itself: the zero sequence of the voltages pins their gains, and
/// what the currents show beside it is no leakage either.
#[test]
fn the_errors_of_current_channels_are_not_turned_into_leakage() {
    let rec = specimen::recording(4.0, |_| 1.0);
    let gains = [1.003, 0.998, 1.001, 0.997, 1.004, 1.0];
    let channels = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
    let (study, trial) = asked(&with_gains(&rec, &channels.zip(gains).collect::<Vec<_>>()));
    assert_known(&study, &trial);
}

/// Offsets within their class, as a transducer or a converter leaves them. A constant voltage drives a constant current through the
/// model, which nobody measures: without offsets the fit answers with a resistance that is further off than its own three standard
/// errors; beside them it is known as well as it says.
#[test]
fn the_offset_of_a_channel_is_not_turned_into_resistance() {
    let rated = specimen::prior("").plant.rated;
    let rec = specimen::recording(2.0, |_| 1.0);
    let shares = [0.002, -0.001, 0.0015, -0.0025, 0.002, 0.0005];
    let channels = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
    let offsets: Vec<(Channel, f64)> = channels.zip(shares).collect();
    let scale = |channel: Channel| match Channel::VOLTAGES.contains(&channel) {
        true => rated.voltage,
        false => rated.current,
    };
    let shifted = mapped(&rec, |channel, x| {
        x + of(&offsets, channel).unwrap_or_default() * scale(channel)
    });
    let (study, trial) = asked(&shifted);
    assert!(off(&study, &trial, 0) > 3.0, "{}", off(&study, &trial, 0));
    assert_known(&study, &trial);
}

#[test]
fn tables_and_models_with_an_unbalance_are_left_as_they_are() {
    let table = specimen::table_study(|_| ());
    assert!(polished(&table, &specimen::trial_with(&table, &[])).is_none());
    let study = specimen::study(0.5, |_| 1.0);
    for (voltages, held_to_class) in [("phase-voltage-gain", true), ("voltage-asymmetry", false)] {
        let one = polished(&study, &specimen::trial_with(&study, &[(voltages, 0.1)]));
        let held = one.expect("beside the currents' gains").fit.hypothesis;
        assert!(held.refits_instrument(Instrument::Currents));
        assert_eq!(held.refits_instrument(Instrument::Voltages), held_to_class);
    }
}
