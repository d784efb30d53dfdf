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
    let mut ratios: Vec<(f64, u64, usize, usize)> = Vec::new();
    for (n, (_, t)) in all.iter().enumerate() { for s in 1..STEPS.len() { for k in 0..ALL {
        ratios.push((t.steps[s].parameters[k].log_spread() / t.steps[s - 1].parameters[k].log_spread(), n as u64, s, k)); } } }
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |q: f64| ratios[((ratios.len() - 1) as f64 * q) as usize];
    println!("growth: 50 % {:?} 90 {:?} 95 {:?} 98 {:?} 99 {:?} 99.5 {:?} max {:?}", at(0.5), at(0.9), at(0.95), at(0.98), at(0.99), at(0.995), at(1.0));
    for k in 0..ALL { let mut e: Vec<f64> = all.iter().map(|(m, t)| (t.steps[5].parameters[k].value / truths(m)[k]).ln().abs()).collect(); e.sort_by(f64::total_cmp); println!("error {} median {:.4} 95 % {:.4}", NAMES[k], e[e.len()/2], e[e.len()*95/100]); }
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

#[test]
fn gen_template() {
    let plate = "power_kw = 2.2\nvoltage_volt = 400\nfrequency_hz = 50\nspeed_rpm = 1438\ncurrent_amp = 4.78\npower_factor = 0.77\nefficiency_percent = 86.3";
    let file = nameplate::plate::PlateFile::parse(plate, "p").unwrap();
    let e = Estimate::of(&file.plate).unwrap();
    let c = e.fit.circuit;
    let t = e.completed.targets;
    let mut machine = machine::Machine { laws: Laws::Fitted, stator_resistance: c.stator_resistance * 1.1, leakage: c.leakage * 1.15, magnetizing: c.magnetizing * 0.97, inner_resistance: c.inner_resistance * 1.03, outer_resistance: 4.0 * c.inner_resistance, inner_leakage: c.leakage * 1.0, core_conductance: c.core_conductance * 0.8, windage: c.windage * 1.1, stray: c.stray * 0.85, saturated_leakage: 0.8, saturation: [0.0, 6.5], rated_air_gap: 1.0, bearings: 0.35, warm_degc: 92.0, slip: t.slip, rated_torque: t.rating().torque() };
    machine.rated_air_gap = machine.at(1.0, t.slip, 1.0, 92.0).air_gap;
    machine.saturation[0] = 0.28;
    let rated = machine.at(1.0, t.slip, 1.0, 92.0);
    println!("rated: I {} P2 {} eff {} pf {}", rated.current, rated.torque * (1.0 - t.slip) / t.rating().power, rated.torque * (1.0 - t.slip) / rated.active, rated.active / rated.current);
    let motor = Motor { machine, power_kw: 2.2, volt: 400.0, amp: e.completed.base_current_amp(), pole_pairs: 2, inertia: 0.0095 / 0.7627639917864495, values: [0.0; 6] };
    println!("{:?}", NAMES.iter().zip(truths(&motor)).collect::<Vec<_>>());
    let mut bench = Bench::new(&motor, Pcg64Mcg::seed_from_u64(7));
    bench.dc_resistance();
    bench.no_load(&[1.1, 1.0, 0.8, 0.6, 0.4, 0.25]);
    bench.locked_rotor(&[1.0, 0.25]);
    bench.load(&[0.25, 0.5, 0.75, 1.0, 1.25]);
    bench.coast_down();
    println!("{}", bench.table);
}
