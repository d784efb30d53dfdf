//! What `drivemon monitor` costs: samples per second of reading, audit and replay of one recording.

use audit::{Audit, Expectation, audit};
use benches::interleaved::shortest;
use criterion::{Criterion, Throughput};
use formats::{read_recording, write_recording};
use monitor::Monitor;
use motor::MotorFile;
use recording::{Mapping, Recording};
use replay::{Samples, config_for, replay};
use scenario::Scenario;
use scenario::simulate;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Duration;

const RUNS: usize = 15;

fn root() -> PathBuf {
    Path::new(benches::FOLDER).join("..")
}

/// The shipped start with load steps: 4 s at 10 kHz, eight channels.
fn recorded() -> Recording {
    let path = root().join("sim-host/scenarios/direct-on-line-start.toml");
    let scenario = Scenario::read(&path).expect("shipped");
    simulate::record(&scenario, |_| ()).expect("a valid scenario")
}

fn read(path: &Path) -> Recording {
    read_recording(path, &Mapping::default(), &mut |_| ()).expect("just written")
}

fn run(monitor: &Monitor, recording: &Recording, audit: &Audit) {
    let timeline = replay(monitor, &Samples::new(recording, audit), &mut |_| ());
    assert!(timeline.judged > 0, "nothing was judged");
    black_box(timeline);
}

fn show(name: &str, samples: usize, seconds: f64) {
    println!("  {name:<12} {:>10.0} samples/s", samples as f64 / seconds);
}

fn bench(criterion: &mut Criterion) {
    let motor = MotorFile::read(root().join("motors/peer-2k2.toml")).expect("shipped");
    let path = std::env::temp_dir().join(format!("replay-{}.csv.gz", std::process::id()));
    write_recording(&path, &recorded()).expect("a folder for temporary files");
    let recording = read(&path);
    let expectation = Expectation::from(&motor);
    let findings = audit(&recording, &expectation);
    assert!(findings.supported);
    let monitor = Monitor::new(config_for(&motor, &recording).expect("shipped")).expect("shipped");

    let mut group = criterion.benchmark_group("replay_of_4_s");
    group.throughput(Throughput::Elements(recording.len() as u64));
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(5));
    group.bench_function("read_csv_gz", |b| b.iter(|| read(&path)));
    group.bench_function("audit", |b| b.iter(|| audit(&recording, &expectation)));
    group.bench_function("replay", |b| {
        b.iter(|| run(&monitor, &recording, &findings))
    });
    group.finish();
    let samples = recording.len();
    println!("replay of 4 s at 10 kHz, eight channels, .csv.gz: fastest of {RUNS}");
    show("read", samples, shortest(RUNS, || read(&path)));
    show(
        "audit",
        samples,
        shortest(RUNS, || audit(&recording, &expectation)),
    );
    show(
        "core",
        samples,
        shortest(RUNS, || run(&monitor, &recording, &findings)),
    );
    let whole = || {
        let recording = read(&path);
        run(&monitor, &recording, &audit(&recording, &expectation));
    };
    show("all three", samples, shortest(RUNS, whole));
    for leftover in [path.clone(), path.with_extension("").with_extension("toml")] {
        // A temporary file that cannot be removed does no harm.
        let _ = std::fs::remove_file(leftover);
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    bench(&mut criterion);
    criterion.final_summary();
}
