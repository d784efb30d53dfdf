//! Nanoseconds per sample of the core on the host, beside plain phasor peers in the same run.

use benches::interleaved::Pairs;
use benches::peers::{NalgebraLeastSquares, SlidingDft, channels};
use benches::signals::{CYCLE_SAMPLES, SAMPLES, Signals};
use criterion::{Criterion, Throughput};
use monitor::{Monitor, MonitorState, Report, Sample};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Odd, so that the median is one of them.
const PAIRS: usize = 201;
/// 12-bit codes scatter the phasor of one cycle by less than a tenth of this.
const PHASOR_AGREEMENT: f32 = 1e-3;

// The loops are compiled once each: inlined into their callers they would be other code in every figure.

/// Runs the core over the whole second from a fresh state; every report reaches `see`.
#[inline(never)]
fn core<T>(
    monitor: &Monitor,
    samples: &[T],
    update: impl Fn(&Monitor, &mut MonitorState, &T) -> Option<Report>,
    mut see: impl FnMut(Report),
) {
    let mut state = MonitorState::default();
    for sample in samples {
        if let Some(report) = update(monitor, &mut state, black_box(sample)) {
            see(report);
        }
    }
    black_box(state);
}

#[inline(never)]
fn sliding(samples: &[Sample]) -> SlidingDft {
    let mut peer = SlidingDft::default();
    samples
        .iter()
        .for_each(|sample| peer.update(&channels(black_box(sample))));
    peer
}

#[inline(never)]
fn least_squares(samples: &[Sample]) -> NalgebraLeastSquares {
    let mut peer = NalgebraLeastSquares::default();
    samples
        .iter()
        .for_each(|sample| peer.update(&channels(black_box(sample))));
    peer
}

/// What is timed must be the real work: nearly every cycle judged, no lamp lit, the peers' phasor the motor's own.
fn check(monitor: &Monitor, signals: &Signals) {
    let (mut reports, mut judged) = (0, 0);
    core(monitor, &signals.samples, Monitor::update, |report| {
        reports += 1;
        judged += usize::from(report.is_judged());
    });
    assert!(reports > SAMPLES / CYCLE_SAMPLES - 5, "{reports} reports");
    assert!(judged > SAMPLES / CYCLE_SAMPLES / 2, "{judged} judged");
    let truth = signals.point.i_s.norm() as f32;
    let of_peers = [
        sliding(&signals.samples).phasors(),
        least_squares(&signals.samples).phasors(),
    ];
    for phasors in of_peers {
        let error = (phasors[3].norm() - truth).abs() / truth;
        assert!(
            error < PHASOR_AGREEMENT,
            "a peer's current is off by {error:e}"
        );
    }
    println!(
        "monitor: {reports} reports in {SAMPLES} samples, {judged} judged; peers within {PHASOR_AGREEMENT} of the motor's current"
    );
}

fn keep<T>(result: T) {
    black_box(result);
}

fn timed(run: impl FnOnce()) -> Duration {
    let from = Instant::now();
    run();
    from.elapsed()
}

fn show(name: &str, pairs: &Pairs) {
    let per_sample = |seconds: [f64; 2]| seconds.map(|s| 1e9 * s / SAMPLES as f64);
    let ([ours, theirs], [ours_mid, theirs_mid]) =
        (per_sample(pairs.shortest()), per_sample(pairs.medians()));
    let [speed, _] = pairs.speed_ratios();
    println!(
        "  {name:<32} core {ours:>6.1} ({ours_mid:.1})   peer {theirs:>6.1} ({theirs_mid:.1})   core/peer {:.2}",
        1.0 / speed
    );
}

fn show_beside_peers(monitor: &Monitor, signals: &Signals) {
    let update = || timed(|| core(monitor, &signals.samples, Monitor::update, keep));
    let raw = || timed(|| core(monitor, &signals.raw, Monitor::update_raw, keep));
    let dft = || timed(|| keep(sliding(&signals.samples)));
    let normal = || timed(|| keep(least_squares(&signals.samples)));
    println!("monitor: ns per sample, fastest (median) of {PAIRS} interleaved pairs");
    show("update / sliding DFT", &Pairs::measure(PAIRS, update, dft));
    show(
        "update / least squares, nalgebra",
        &Pairs::measure(PAIRS, update, normal),
    );
    show("update_raw / sliding DFT", &Pairs::measure(PAIRS, raw, dft));
    println!();
}

fn bench(criterion: &mut Criterion) {
    let signals = Signals::rated();
    let monitor = Monitor::new(signals.config).expect("a valid configuration");
    check(&monitor, &signals);
    let mut group = criterion.benchmark_group("per_10000_samples");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    group.bench_function("monitor_update", |b| {
        b.iter(|| core(&monitor, &signals.samples, Monitor::update, keep))
    });
    group.bench_function("monitor_update_raw", |b| {
        b.iter(|| core(&monitor, &signals.raw, Monitor::update_raw, keep))
    });
    group.bench_function("peer_sliding_dft", |b| b.iter(|| sliding(&signals.samples)));
    group.bench_function("peer_least_squares_nalgebra", |b| {
        b.iter(|| least_squares(&signals.samples))
    });
    group.finish();
    show_beside_peers(&monitor, &signals);
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    bench(&mut criterion);
    criterion.final_summary();
}
