//! Standard tests on simulated motors: the intervals hold the truth after each step, and shrink.

mod bench;
mod drawn;
mod machine;

use bench::Bench;
use drawn::{Motor, drawn, truths};
use machine::Laws;
use nameplate::Estimate;
use nameplate::measured::table::read_csv;
use nameplate::measured::{ALL, Instruments, NAMES, Tested};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

const STEPS: [&str; 6] = ["plate", "dc-resistance", "no-load", "locked-rotor", "load", "coast-down"];

/// A motor after the full set of tests.
fn tested(seed: u64, laws: Laws) -> (Motor, Tested) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let motor = drawn(&mut rng, laws);
    let plate = bench::plate(&motor, &mut rng, seed.is_multiple_of(2));
    let t0 = std::time::Instant::now();
    let estimate = Estimate::of(&plate).unwrap();
    let mut bench = Bench::new(&motor, rng);
    bench.dc_resistance();
    bench.no_load(&[1.1, 1.0, 0.8, 0.6, 0.4, 0.25]);
    bench.locked_rotor(&[1.0, 0.25]);
    bench.load(&[0.5, 1.0, 1.2]);
    bench.coast_down();
    let rows = read_csv(&bench.table, "tests.csv").unwrap();
    let t1 = std::time::Instant::now();
    let tested = Tested::of(&estimate, &rows, &Instruments::default(), None).unwrap();
    if seed < 8 { println!("oracle+estimate {:?} tested {:?}", t1 - t0, t1.elapsed()); }
    (motor, tested)
}

fn machines(count: u64, laws: Laws) -> Vec<(Motor, Tested)> {
    let only = std::env::var("ONLY").ok().and_then(|n| n.parse::<u64>().ok());
    (0..count).into_par_iter().filter(|s| only.is_none_or(|o| o == *s)).map(|seed| tested(seed, laws)).collect()
}

fn count(default: u64) -> u64 {
    std::env::var("CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

fn print(all: &[(Motor, Tested)]) {
    println!("{:30} {}", "", STEPS.map(|s| format!("{s:>17}")).join(""));
    for k in 0..ALL {
        let cells: Vec<String> = (0..STEPS.len())
            .map(|s| {
                let held = all.iter().filter(|(m, t)| t.steps[s].parameters[k].holds(truths(m)[k])).count();
                let mut widths: Vec<f64> = all.iter().map(|(_, t)| t.steps[s].parameters[k]).map(|i| i.high / i.value).collect();
                widths.sort_by(f64::total_cmp);
                format!("  {:5.1} % x{:<7.3}", 100.0 * held as f64 / all.len() as f64, widths[widths.len() / 2])
            })
            .collect();
        println!("{:30} {}", NAMES[k], cells.join(""));
    }
    for (k, name) in NAMES.iter().enumerate() {
        let mut cells = Vec::new();
        for s in 0..STEPS.len() {
            let z: Vec<f64> = all.iter().map(|(m, t)| { let i = t.steps[s].parameters[k]; (i.value / truths(m)[k]).ln() / ((i.high / i.low).ln() / 3.92) }).collect();
            let mean = z.iter().sum::<f64>() / z.len() as f64;
            let sd = (z.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / z.len() as f64).sqrt();
            let big = z.iter().filter(|x| x.abs() > 4.0).count();
            cells.push(format!(" {mean:5.2} +-{sd:5.2} {big:3}"));
        }
        println!("{:30} {}", name, cells.join(""));
    }
    for (n, (_, t)) in all.iter().enumerate() {
        if !t.doubts.is_empty() { println!("{n}: {:?}", t.doubts.iter().map(|d| format!("{:?} {:.0}/{:.0}", d.what, d.chi_square, d.limit)).collect::<Vec<_>>()); }
    }
    let doubted = all.iter().filter(|(_, t)| !t.doubts.is_empty()).count();
    println!("contradictions named in {doubted} of {}", all.len());
}

#[test]
fn intervals_hold_the_truth_after_each_step() {
    let begun = std::time::Instant::now();
    let all = machines(count(240), Laws::Fitted);
    println!("{:?}", begun.elapsed());
    print(&all);
}

#[test]
fn other_laws() {
    let all = machines(count(100), Laws::Others);
    print(&all);
    for s in 0..6 { println!("worst: {:?}", NAMES.iter().enumerate().map(|(k, n)| { let mut e: Vec<f64> = all.iter().map(|(m, t)| (t.steps[s].parameters[k].value / truths(m)[k]).ln().abs()).collect(); e.sort_by(f64::total_cmp); format!("{n} {:.3}", e[e.len()/2]) }).collect::<Vec<_>>()); }
}
