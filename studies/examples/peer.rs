//! One table over folders of recordings with a known hidden effect: fit a and prove b, fit b and prove a.
//!
//! `cargo run --release -p studies --example peer -- FOLDER...`; each folder holds `motor.toml`,
//! `recording.csv.gz` and `recording_b.csv.gz`.

use discovery::{ExplainReport, explain};
use formats::read_recording;
use motor::MotorFile;
use recording::Source;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for folder in std::env::args().skip(1) {
        let dir = Path::new(&folder);
        let motor = MotorFile::read(dir.join("motor.toml"))?;
        let read = |name: &str| {
            read_recording(&dir.join(name), &Default::default(), &mut |_| {}).map(Source::Recording)
        };
        let mut sources = vec![read("recording.csv.gz")?, read("recording_b.csv.gz")?];
        for direction in ["fit a, prove b", "fit b, prove a"] {
            let start = Instant::now();
            let report = explain(&sources, &motor, &mut |_, _| {})?;
            println!(
                "{folder} ({direction}), {:.1} s",
                start.elapsed().as_secs_f64()
            );
            print(&report);
            sources.reverse();
        }
    }
    Ok(())
}

fn print(report: &ExplainReport) {
    let error = |f: &Option<discovery::FitReport>| {
        f.as_ref().map_or(f64::NAN, |f| f.held_out_error_over_noise)
    };
    let (before, after) = (error(&report.baseline), error(&report.final_));
    println!(
        "  {:?}: {before:.3} -> {after:.3}. {}",
        report.verdict, report.summary
    );
    for step in &report.steps {
        for p in &step.parameters {
            println!(
                "    {} = {:.6} +- {:.6} {}",
                p.name, p.value, p.std_error, p.unit
            );
        }
    }
    println!("    not testable here: {}", report.not_testable.join(", "));
    for f in report.audit.findings.iter() {
        println!(
            "    audit: {:?} {} {:.3} {}",
            f.code, f.channel, f.value, f.unit
        );
    }
}
