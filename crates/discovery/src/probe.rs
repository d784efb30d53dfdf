//! probe
#![allow(missing_docs)]
use crate::{accept, belief::*, case::Case, confirm, fit::Effort, study::Study};
use motor::MotorFile;
use motor::effects::rated;
use recording::Recording;
use std::time::Instant;

pub fn probe(recs: &[Recording], file: &MotorFile) {
    let t0 = Instant::now();
    let rated = rated(file);
    let belief = Belief::new(file, vec![]);
    let mut cases = recs.iter().map(|r| Case::new(r, &rated).unwrap());
    let a = cases.next().unwrap();
    println!(
        "  segments {:?} denoised {} harmonics {:?}",
        a.supply.segments.len(),
        a.supply.denoised,
        a.supply
            .harmonics
            .iter()
            .map(|h| h.1.norm())
            .collect::<Vec<_>>()
    );
    let study = Study::new(belief, a, cases.collect());
    println!(
        "  prep {:.2}s floor {:.4} sd {:.5}",
        t0.elapsed().as_secs_f64(),
        study.fitted.floor.mean,
        study.fitted.floor.sd
    );
    let t0 = Instant::now();
    let base = study.trial(&study.beliefs(), Effort::FULL);
    println!(
        "  base {:.2}s folds {:.3} proof {:.3} z {:.4?} beliefs-err {:.3}",
        t0.elapsed().as_secs_f64(),
        study.fold_error(&base.folds),
        study.proof_error(&base),
        base.fit.hypothesis.z,
        study.fold_error(&study.fitted.errors(&study.belief, &study.beliefs()))
    );
    let t0 = Instant::now();
    let r = confirm::round(&study, &base, &study.beliefs(), &[]);
    println!("  round {:.2}s", t0.elapsed().as_secs_f64());
    let c = r.candidates;
    for c in &c {
        println!(
            "     {:26} folds {:.4} proof {:.4} proven {} explained {:.3} beaten-by-best? {:?}",
            c.name,
            study.fold_error(&c.trial.folds),
            study.proof_error(&c.trial),
            accept::proven(&study, &base, &c.trial),
            accept::explained(&study, &base, &c.trial),
            c.trial.fit.hypothesis.configs(&study.belief.plant.rated)[0].to_file()
        );
    }
}

pub fn explain(recs: &[Recording], file: &MotorFile) {
    let t0 = Instant::now();
    let rated = rated(file);
    let belief = Belief::new(file, vec![]);
    let mut cases = recs.iter().map(|r| Case::new(r, &rated).unwrap());
    let a = cases.next().unwrap();
    let study = Study::new(belief, a, cases.collect());
    let e = crate::explain::explain(&study, &[], &mut |_, _| {});
    println!(
        "  base {:.3}/{:.3} final {:.3}/{:.3} nameable {} time {:.1}",
        study.fold_error(&e.baseline.folds),
        study.proof_error(&e.baseline),
        study.fold_error(&e.last().folds),
        study.proof_error(e.last()),
        e.nameable,
        t0.elapsed().as_secs_f64()
    );
    for (k, s) in e.steps.iter().enumerate() {
        println!(
            "   STEP {} tied {:?} {:?}",
            s.trial.fit.hypothesis.effects[k].effect.descriptor().name,
            s.tied,
            crate::present::effect_parameters(&study, e.last(), k)
                .iter()
                .map(|p| format!("{}={:.5}+-{:.5}", p.name, p.value, p.std_error))
                .collect::<Vec<_>>()
        );
    }
    for (k, c) in &e.contests {
        println!(
            "   OFF {} {:+.4}",
            NOMINALS[*k].name,
            e.last().fit.hypothesis.z[*k].exp_m1()
        );
        for c in c {
            println!(
                "      tie {} {:.4}/{:.4}  {:?}",
                c.name,
                study.fold_error(&c.trial.folds),
                study.proof_error(&c.trial),
                c.trial
                    .fit
                    .hypothesis
                    .configs(&rated)
                    .last()
                    .unwrap()
                    .to_file()
            );
        }
    }
}
