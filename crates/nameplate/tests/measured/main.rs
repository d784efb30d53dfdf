//! Standard tests on simulated motors: the intervals hold the truth after each step, shrink, and name what contradicts.
//!
//! The motors are drawn as the prior has them (`drawn`), their circuit is solved with no code of the crate (`machine`), and a
//! bench (`bench`) reads plate and tables with the errors of single motors and instruments. `CASES=1000 cargo test -p nameplate
//! --test measured -- --nocapture` prints the figures of docs/first-steps.md.

mod bench;
mod drawn;
mod machine;
mod steps;
mod told;

use bench::Bench;
use drawn::{Motor, drawn};
use machine::Laws;
use nameplate::Estimate;
use nameplate::measured::table::read_csv;
use nameplate::measured::{Instruments, Tested};
use nameplate::plate::Plate;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// A motor, the plate of its type, and a bench for it.
fn on_a_bench<R>(seed: u64, laws: Laws, with: impl FnOnce(&Motor, &Plate, Bench<'_>) -> R) -> R {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let motor = drawn(&mut rng, laws);
    let plate = bench::plate(&motor, &mut rng, seed.is_multiple_of(2));
    with(&motor, &plate, Bench::new(&motor, rng))
}

/// What a table tells of a plate's motor.
fn told(plate: &Plate, table: &str) -> Tested {
    let rows = read_csv(table, "tests.csv").unwrap();
    let estimate = Estimate::of(plate).unwrap();
    Tested::of(&estimate, &rows, &Instruments::default(), None).unwrap()
}

const VOLTAGES: [f64; 6] = [1.1, 1.0, 0.8, 0.6, 0.4, 0.25];

/// A full set of tests.
fn full_set(bench: &mut Bench<'_>) {
    bench.dc_resistance();
    bench.no_load(&VOLTAGES);
    bench.locked_rotor(&[1.0, 0.25]);
    bench.load(&[0.5, 1.0, 1.2]);
    bench.coast_down();
}
