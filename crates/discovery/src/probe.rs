//! probe
#![allow(missing_docs)]
use crate::{accept, belief::*, case::Case, confirm, fit::Effort, screen, study::Study};
use motor::MotorFile;
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

pub fn dead(recs: &[Recording], file: &MotorFile) {
    let rated = rated(file);
    let belief = Belief::new(file, vec![]);
    let mut cases = recs.iter().map(|r| Case::new(r, &rated).unwrap());
    let a = cases.next().unwrap();
    let study = Study::new(belief, a, cases.collect());
    let e = motor::effects::find("inverter-dead-time", "").unwrap();
    for v in [6.0, 3.0] {
        for i0 in [0.05, 0.1, 0.3] {
            let mut c = motor::effects::EffectConfig::absent(e, &rated);
            c.values = vec![v, i0];
            let h = study.beliefs().with(c, &rated);
            let e0 = study.fold_error(&study.fitted.errors(&study.belief, &h));
            let t0 = Instant::now();
            let t = study.trial(&h, Effort::FULL);
            println!(
                "v {v} i0 {i0}: start {e0:.3} folds {:.3} proof {:.3} z {:.3?} {:?} {:.2}s",
                study.fold_error(&t.folds),
                study.proof_error(&t),
                t.fit.hypothesis.z,
                t.fit.hypothesis.configs(&rated)[0].to_file(),
                t0.elapsed().as_secs_f64()
            );
            let er = study.fitted.errors(&study.belief, &t.fit.hypothesis);
            let fl = &study.fitted.floor.block;
            println!(
                "{:?}",
                er.iter()
                    .zip(fl)
                    .map(|(e, f)| ((e / f).sqrt() * 10.0).round() / 10.0)
                    .collect::<Vec<_>>()
            );
        }
    }
    let t0 = Instant::now();
    for _ in 0..10 {
        let _ = crate::predict::outputs(
            &study.fitted.case,
            &study.belief,
            &study.beliefs(),
            crate::predict::Teacher::Off,
        );
    }
    println!(
        "sim {:.4}s rows {}",
        t0.elapsed().as_secs_f64() / 10.0,
        study.fitted.case.measured.len()
    );
}
