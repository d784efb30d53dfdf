//! Simulated seconds per second of the plant, beside the same loop in C in the same run.

use benches::c_worker::{CWorker, FLAGS};
use benches::direct_on_line::{Case, largest_difference};
use benches::interleaved::Pairs;
use criterion::{Criterion, Throughput};
use motor::dynamic::Dynamic;
use std::cell::RefCell;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Both do the same IEEE operations, a compiler may only reorder what keeps their results; 20 000 steps that
/// each differed in the last digit would stay below 1e-11, another formula would not stay below this.
const AGREEMENT: f64 = 1e-9;
/// Odd, so that the median is one of them.
const PAIRS: usize = 201;

fn rust_passes(case: &Case, motor: &Dynamic, passes: u64) -> Duration {
    let from = Instant::now();
    for _ in 0..passes {
        black_box(case.run(black_box(motor)));
    }
    from.elapsed()
}

fn show_ratio(case: &Case, motor: &Dynamic, worker: &RefCell<CWorker>) {
    let pairs = Pairs::measure(
        PAIRS,
        || rust_passes(case, motor, 1),
        || worker.borrow_mut().run(1).expect("C program runs"),
    );
    let per_second = |seconds: [f64; 2]| seconds.map(|s| case.duration() / s);
    let ([rust, c], [rust_mid, c_mid]) =
        (per_second(pairs.shortest()), per_second(pairs.medians()));
    let [fastest, paired] = pairs.speed_ratios();
    println!(
        "plant, RK4 at 100 us, {PAIRS} interleaved pairs of {:.1} simulated s",
        case.duration()
    );
    println!("  C: {} {}", worker.borrow().compiler, FLAGS.join(" "));
    println!("                              fastest       median");
    println!("  Rust, simulated s per s  {rust:>10.0}   {rust_mid:>10.0}");
    println!("  C,    simulated s per s  {c:>10.0}   {c_mid:>10.0}");
    println!(
        "  ratio Rust/C             {fastest:>10.3}   {paired:>10.3}   (target: at least 0.9)\n"
    );
}

fn bench(criterion: &mut Criterion) {
    let case = Case::read();
    let motor = Dynamic::new(&case.params, &case.mechanics);
    let worker = CWorker::start(&case).map(RefCell::new);
    let mut group = criterion.benchmark_group("plant_100us");
    group.throughput(Throughput::Elements(case.rows.len() as u64));
    group.bench_function("rust", |b| {
        b.iter_custom(|passes| rust_passes(&case, &motor, passes))
    });
    match &worker {
        Ok(worker) => {
            let theirs = worker.borrow_mut().trajectory().expect("C program runs");
            let difference = largest_difference(&case.trajectory(&motor), &theirs);
            assert!(
                difference < AGREEMENT,
                "Rust and C differ by {difference:e}"
            );
            group.bench_function("c", |b| {
                b.iter_custom(|passes| worker.borrow_mut().run(passes).expect("C program runs"))
            });
            println!("plant: Rust and C agree to {difference:.1e} over the whole start");
            show_ratio(&case, &motor, worker);
        }
        Err(error) => println!("plant: no C program beside it ({error}): set CC to a C compiler"),
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    bench(&mut criterion);
    criterion.final_summary();
}
