//! Asks `explain` about folders of recordings with known truth, both directions, and prints what it says.
//!
//! `cargo run --release -p studies --example sets -- FOLDER...`: each folder holds `motor.toml`,
//! `recording.csv.gz`, `recording_b.csv.gz` with their sidecars, and is named after what is hidden. `--one-way` as the
//! first argument fits the first recording only; `--steps` prints what each step takes; `--without=EFFECT` does not ask
//! about an effect.

use discovery::{explain_without, simulations};
use formats::read_recording;
use motor::MotorFile;
use rayon::prelude::*;
use recording::Source;
use std::path::{Path, PathBuf};
use std::time::Instant;

fn read(path: PathBuf) -> Source {
    Source::Recording(read_recording(&path, &Default::default(), &mut |_| {}).expect("a recording"))
}

/// Prints each step when the next one begins: seconds, simulations, what.
fn told(steps: bool) -> impl FnMut(&str, f64) {
    let mut now = (String::new(), Instant::now(), simulations());
    move |what: &str, _| {
        if !steps || now.0 == what {
            return;
        }
        let (seconds, count) = (now.1.elapsed().as_secs_f64(), simulations() - now.2);
        eprintln!("{seconds:8.2} s {count:6} simulations  {}", now.0);
        now = (what.to_owned(), Instant::now(), simulations());
    }
}

fn asked(folder: &Path, [first, second]: [&str; 2], excluded: &[&str], steps: bool) -> String {
    let motor = MotorFile::read(folder.join("motor.toml")).expect("a motor file");
    let sources = [first, second].map(|name| read(folder.join(name)));
    let start = Instant::now();
    let report = explain_without(&sources, &motor, excluded, &mut told(steps)).expect("a report");
    let error = |f: &Option<discovery::FitReport>| {
        f.as_ref().map_or(f64::NAN, |f| f.held_out_error_over_noise)
    };
    let sizes = report.steps.iter().flat_map(|s| &s.parameters);
    let sizes: Vec<String> = sizes
        .map(|p| format!("{} {:.4}", p.name, p.value))
        .collect();
    format!(
        "{:36} {:?} {:.3} -> {:.3} ({:.1} s): {} [{}]",
        folder.file_name().unwrap_or_default().to_string_lossy(),
        report.verdict,
        error(&report.baseline),
        error(&report.final_),
        start.elapsed().as_secs_f64(),
        report.summary,
        sizes.join(", "),
    )
}

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut flag = |flag: &str| {
        let before = arguments.len();
        arguments.retain(|argument| argument != flag);
        arguments.len() < before
    };
    let (one_way, steps) = (flag("--one-way"), flag("--steps"));
    let (excluded, folders): (Vec<&str>, Vec<&str>) = arguments
        .iter()
        .map(String::as_str)
        .partition(|argument| argument.starts_with("--without="));
    let excluded: Vec<&str> = excluded
        .iter()
        .filter_map(|e| e.split('=').nth(1))
        .collect();
    let folders: Vec<PathBuf> = folders.into_iter().map(PathBuf::from).collect();
    let (a, b) = ("recording.csv.gz", "recording_b.csv.gz");
    folders.par_iter().for_each(|folder| {
        println!("a {}", asked(folder, [a, b], &excluded, steps));
        if !one_way {
            println!("b {}", asked(folder, [b, a], &excluded, steps));
        }
    });
}
