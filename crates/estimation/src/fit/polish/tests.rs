use super::*;
use crate::data::case::Case;
use crate::model::prior::LEAKAGE;
use crate::specimen;
use recording::{Channel, Recording};

/// The recording with these channels so many times what they are.
fn with_gains(rec: &Recording, gains: &[(Channel, f64)]) -> Recording {
    let empty = Recording::new("gains", rec.t().to_vec(), rec.metadata.clone()).expect("a clock");
    rec.channels().fold(empty, |to, (channel, x)| {
        let known = gains.iter().find(|(scaled, _)| *scaled == channel);
        let gain = known.map_or(1.0, |(_, gain)| *gain);
        to.with_channel(channel, x.iter().map(|x| gain * x).collect())
            .expect("a channel")
    })
}

/// A constant load whose voltage channel a shows 0.3 % too much, as its class allows: without its gain the leakage takes it over;
/// beside it the leakage is known as well as it says.
#[test]
fn the_error_of_a_channel_is_not_turned_into_leakage() {
    let prior = specimen::prior("");
    let rec = specimen::recording(2.0, |_| 1.0);
    let rec = with_gains(&rec, &[(Channel::VOLTAGES[0], 1.003)]);
    let case = Case::new(&rec, &prior.plant.rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
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
    let prior = specimen::prior("");
    let rec = specimen::recording(4.0, |_| 1.0);
    let gains = [1.003, 0.998, 1.001, 0.997, 1.004, 1.0];
    let channels = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
    let rec = with_gains(&rec, &channels.zip(gains).collect::<Vec<_>>());
    let case = Case::new(&rec, &prior.plant.rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
    let beside = study.polished(&trial);
    let covariance = study.covariance(beside);
    for (at, &k) in beside.fit.free.iter().enumerate() {
        if k < N_NOMINAL {
            let off = beside.fit.hypothesis.z[k] / covariance[(at, at)].sqrt();
            assert!(off.abs() < 3.0, "coordinate {k}: {off:.2} standard errors");
        }
    }
}

/// Offsets within their class, as a transducer or a converter leaves them: a constant 0.8 V over the stator's resistance would be a
/// fifth of the rated current, which nobody measures, and without offsets the fit answers with several times the resistance.
#[test]
fn the_offset_of_a_channel_is_not_turned_into_resistance() {
    let prior = specimen::prior("");
    let rated = prior.plant.rated;
    let rec = specimen::recording(2.0, |_| 1.0);
    let shares = [0.002, -0.001, 0.0015, -0.0025, 0.002, 0.0005];
    let channels = Channel::VOLTAGES.into_iter().chain(Channel::CURRENTS);
    let offsets: Vec<(Channel, f64)> = channels.zip(shares).collect();
    let empty = Recording::new("offsets", rec.t().to_vec(), rec.metadata.clone()).expect("a clock");
    let rec = rec.channels().fold(empty, |to, (channel, x)| {
        let known = offsets.iter().find(|(shifted, _)| *shifted == channel);
        let scale = match Channel::VOLTAGES.contains(&channel) {
            true => rated.voltage,
            false => rated.current,
        };
        let offset = known.map_or(0.0, |(_, share)| share * scale);
        to.with_channel(channel, x.iter().map(|x| x + offset).collect())
            .expect("a channel")
    });
    let case = Case::new(&rec, &rated).expect("judged");
    let study = Study::new(prior, case, Vec::new(), None);
    let trial = study.trial(&study.at_prior(), Effort::FULL);
    let beside = study.polished(&trial);
    let covariance = study.covariance(beside);
    for (at, &k) in beside.fit.free.iter().enumerate() {
        if k < N_NOMINAL {
            let off = beside.fit.hypothesis.z[k] / covariance[(at, at)].sqrt();
            assert!(off.abs() < 3.0, "coordinate {k}: {off:.2} standard errors");
        }
    }
    let resistance = |t: &Trial| t.fit.hypothesis.z[0];
    assert!(resistance(&trial) > 0.3, "{}", resistance(&trial));
    assert!(resistance(beside).abs() < 0.1, "{}", resistance(beside));
}

#[test]
fn tables_and_models_with_an_unbalance_are_left_as_they_are() {
    let table = specimen::table_study(|_| ());
    assert!(polished(&table, &specimen::trial_with(&table, &[])).is_none());
    let study = specimen::study(0.5, |_| 1.0);
    for (voltages, held_to_class) in [("phase-voltage-gain", true), ("voltage-asymmetry", false)] {
        let one = polished(&study, &specimen::trial_with(&study, &[(voltages, 0.1)]));
        let held = one.expect("beside the currents' gains").fit.hypothesis;
        assert!(held.holds_instrument(Instrument::Currents));
        assert_eq!(held.holds_instrument(Instrument::Voltages), held_to_class);
    }
}
