//! Seeds, findings and a fixed number of mutations of each target; `tools/fuzz` goes on where this ends.

use std::path::Path;

use fuzz::{Mutator, TARGETS, Target};

/// Change it, and every mutation is another one.
const SEED: u64 = 0x6d6f_7472;

/// Inputs that once broke something.
fn findings(target: &Target) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("findings")
        .join(target.name);
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("readable").path())
        .collect();
    paths.sort();
    paths
        .iter()
        .map(|path| std::fs::read(path).expect("readable"))
        .collect()
}

/// Runs one input and names it when it breaks something.
fn run(target: &Target, what: &str, input: &[u8]) {
    if std::panic::catch_unwind(|| (target.run)(input)).is_err() {
        let path = std::env::temp_dir().join(format!("drive-monitor-{}", target.name));
        std::fs::write(&path, input).expect("written");
        let (name, path) = (target.name, path.display());
        panic!("{name}, {what}: the input is in {path}; keep it in fuzz/findings/{name}");
    }
}

fn short(target: &Target) {
    let seeds = (target.seeds)();
    assert!(!seeds.is_empty(), "{} has no seeds", target.name);
    let found = findings(target);
    for (what, inputs) in [("a seed", &seeds), ("a finding", &found)] {
        inputs.iter().for_each(|input| run(target, what, input));
    }
    let mut mutator = Mutator::new(SEED, [seeds, found].concat());
    for k in 0..target.short {
        run(target, &format!("mutation {k}"), &mutator.next_input());
    }
}

#[test]
fn nothing_breaks_on_seeds_findings_and_mutations() {
    for target in &TARGETS {
        let begun = std::time::Instant::now();
        short(target);
        println!("{}: {:.2} s", target.name, begun.elapsed().as_secs_f64());
    }
}

#[test]
fn every_finding_belongs_to_a_target() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("findings");
    for entry in std::fs::read_dir(folder).expect("part of the source tree") {
        let name = entry.expect("readable").file_name();
        let name = name.to_string_lossy();
        assert!(name == "README.md" || fuzz::find(&name).is_some(), "{name}");
    }
}
