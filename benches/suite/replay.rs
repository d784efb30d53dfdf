//! What `drivemon monitor` costs: samples per second of reading, audit and replay of one recording, and how many times real time.

use audit::{Audit, Expectation, audit};
use benches::interleaved::shortest_on_processor;
use criterion::{Criterion, Throughput};
use formats::{PIECE_ROWS, read_in_pieces, read_recording, write_recording};
use monitor::Monitor;
use motor::MotorFile;
use recording::{Mapping, Recording};
use replay::{Samples, config_for, replay};
use report::study::Monitoring;
use scenario::Scenario;
use scenario::simulate;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Duration;

const RUNS: usize = 15;

fn root() -> PathBuf {
    Path::new(benches::FOLDER).join("..")
}

/// What reading and audit did before recordings were read in pieces, samples/s: the figures that docs/benchmarks.md had then.
const READ_BEFORE: f64 = 766_106.0;
const AUDIT_BEFORE: f64 = 461_352.0;

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

fn show(name: &str, rate: f64, beside: String) {
    println!("  {name:<26} {rate:>10.0} samples/s  {beside}");
}

/// Reads, audits and replays a file piece by piece, as `drivemon monitor` does.
fn monitored(path: &Path, motor: &MotorFile) {
    let mut monitoring = Monitoring::new(Some(motor));
    read_in_pieces(
        path,
        &Mapping::default(),
        PIECE_ROWS,
        &mut |_| (),
        &mut |piece, _| {
            monitoring.take(piece, &mut |_| ()).expect("shipped");
            Ok::<(), recording::Error>(())
        },
    )
    .expect("just written");
    let monitored = monitoring.finish();
    assert!(monitored.timeline.judged > 0, "nothing was judged");
    black_box(monitored);
}

/// The recording in every format that a recorder of ours writes.
fn written(recording: &Recording) -> [PathBuf; 3] {
    ["csv.gz", "csv", "parquet"].map(|extension| {
        let name = format!("replay-{}-{extension}.{extension}", std::process::id());
        let path = std::env::temp_dir().join(name);
        write_recording(&path, recording).expect("a folder for temporary files");
        path
    })
}

fn bench(criterion: &mut Criterion) {
    let motor = MotorFile::read(root().join("motors/peer-2k2.toml")).expect("shipped");
    let paths = written(&recorded());
    let [packed, plain, columnar] = &paths;
    let recording = read(packed);
    let expectation = Expectation::from(&motor);
    let findings = audit(&recording, &expectation);
    assert!(findings.supported);
    let monitor = Monitor::new(config_for(&motor, &recording).expect("shipped")).expect("shipped");

    let mut group = criterion.benchmark_group("replay_of_4_s");
    group.throughput(Throughput::Elements(recording.len() as u64));
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(5));
    group.bench_function("read_csv_gz", |b| b.iter(|| read(packed)));
    group.bench_function("audit", |b| b.iter(|| audit(&recording, &expectation)));
    group.bench_function("replay", |b| {
        b.iter(|| run(&monitor, &recording, &findings))
    });
    group.bench_function("monitor_parquet", |b| {
        b.iter(|| monitored(columnar, &motor))
    });
    group.finish();

    let samples = recording.len() as f64;
    println!("replay of 4 s at 10 kHz, eight channels, processor time: fastest of {RUNS}");
    let before =
        |rate: f64, before: f64| format!("{:.1} x the {before:.0} of before", rate / before);
    for (name, path) in [("read .csv.gz", packed), ("read .csv", plain)] {
        let rate = samples / shortest_on_processor(RUNS, || read(path));
        show(name, rate, before(rate, READ_BEFORE));
    }
    let rate = samples / shortest_on_processor(RUNS, || read(columnar));
    show("read .parquet", rate, String::new());
    let rate = samples / shortest_on_processor(RUNS, || audit(&recording, &expectation));
    show("audit", rate, before(rate, AUDIT_BEFORE));
    let rate = samples / shortest_on_processor(RUNS, || run(&monitor, &recording, &findings));
    show("core", rate, String::new());
    for (name, path) in [("monitor .csv.gz", packed), ("monitor .parquet", columnar)] {
        let rate = samples / shortest_on_processor(RUNS, || monitored(path, &motor));
        let times = rate * recording.t_sample();
        show(name, rate, format!("{times:.0} x real time"));
    }
    for path in paths {
        for leftover in [recording::sidecar_path(&path), path] {
            // A temporary file that cannot be removed does no harm.
            let _ = std::fs::remove_file(leftover);
        }
    }
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    bench(&mut criterion);
    criterion.final_summary();
}
