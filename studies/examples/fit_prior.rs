//! Prints the constants of `crates/nameplate/src/prior/real_motors.rs`: the prior of the motors in `crates/nameplate/data/motors.csv`.

#[path = "../../crates/nameplate/tests/support/mod.rs"]
mod support;

use std::collections::BTreeSet;

fn main() {
    let motors = support::motors();
    let makers: BTreeSet<&str> = motors.iter().map(|motor| motor.maker.as_str()).collect();
    println!("// {} motors of {makers:?}", motors.len());
    println!("{:#.4?}", support::fitted_prior(&motors));
}
