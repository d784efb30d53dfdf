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
    let s = screen::screen(&study.fitted.case, &study.belief, &base.fit, &[]);
    let groups = screen::ranked(&s, 3);
    println!(
        "  screen {:.2}s {} points {} sims",
        t0.elapsed().as_secs_f64(),
        s.len(),
        s.iter().map(|s| s.simulations).sum::<usize>()
    );
    for g in groups.iter().take(8) {
        println!(
            "     {:26} {:.4} {:?}",
            g[0].config.effect.descriptor().name,
            study.fold_error(&g[0].held_out),
            g[0].config.values
        );
    }
    let t0 = Instant::now();
    let c = confirm::confirm(&study, &base, &groups[..6]);
    println!("  confirm {:.2}s", t0.elapsed().as_secs_f64());
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
