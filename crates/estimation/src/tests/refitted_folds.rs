//! Linearised folds against folds that were really left out and refitted.

use std::path::Path;

use formats::read_recording;
use motor::MotorFile;
use recording::{Mapping, Source};

use crate::data::question::Question;
use crate::data::study::{Study, Trial};
use crate::fit::normal_equations::FOLDS;
use crate::fit::output_error::{Effort, fit};
use crate::model::prior::Hypothesis;
use crate::specimen;

fn question(set: &str) -> Question {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/peer")
        .join(set);
    let motor = MotorFile::read(folder.join("motor.toml")).expect("a peer set has a motor file");
    let file = folder.join("recording.csv.gz");
    let recording = read_recording(&file, &Mapping::default(), &mut |_| {}).expect("readable");
    let sources = [Source::Recording(recording)];
    Question::new(&sources, &motor, &mut |_: &str, _| {}).expect("supported")
}

/// Held-out error over noise when each fold is left out, everything refitted, and the fold then judged.
fn refitted(study: &Study, trial: &Trial) -> f64 {
    let subject = &study.fitted;
    let rows = subject.case.blocks();
    let of_fold = |fold: usize| {
        let mut rest = subject.case.clone();
        for rows in rows.iter().skip(fold).step_by(FOLDS) {
            specimen::weight_of(&mut rest)[rows.clone()].fill([0.0; 5]);
        }
        let left_out = fit(&rest, &study.prior, &trial.fit.hypothesis, Effort::FULL);
        let errors = subject.errors(&study.prior, &left_out.hypothesis);
        errors.into_iter().skip(fold).step_by(FOLDS).sum::<f64>()
    };
    study.fold_error(&(0..FOLDS).map(of_fold).collect::<Vec<_>>())
}

fn compare(study: &Study, start: &Hypothesis) {
    let trial = study.trial(start, Effort::FULL);
    let linear = study.fold_error(&trial.folds);
    let refitted = refitted(study, &trial);
    println!("linearised {linear:.5}, refitted {refitted:.5}");
    // What the method promises: the ranking rests on differences of a per cent and more.
    assert!(
        (linear / refitted - 1.0).abs() < 1e-3,
        "{linear} {refitted}"
    );
}

#[test]
fn linearised_folds_agree_with_refitted_ones_where_the_model_fits() {
    let study = question("none").study;
    compare(&study, &study.at_prior());
}

#[test]
fn and_where_an_effect_is_missing() {
    let study = question("windage").study;
    compare(&study, &study.at_prior());
}
