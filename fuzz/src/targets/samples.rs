//! The monitor under any sequence of samples.

use std::sync::OnceLock;

use monitor::{
    Abc, Lamp, Monitor, MonitorConfig, MonitorState, NotJudged, Report, Sample, SpeedSample,
};
use motor::MotorFile;

/// 2 kHz: 40 samples in a period of 50 Hz.
const T_SAMPLE: f64 = 5e-4;
/// Samples that one step of the input may last.
const LONGEST: u32 = 8;

fn monitors() -> &'static [Monitor; 2] {
    static MONITORS: OnceLock<[Monitor; 2]> = OnceLock::new();
    MONITORS.get_or_init(|| {
        let texts = [
            include_str!("../../../motors/assumed-300w.toml"),
            include_str!("../../../motors/assumed-300w-calibrated.toml"),
        ];
        texts.map(|text| {
            let motor = MotorFile::parse(text, "m.toml").expect("it ships");
            let config = MonitorConfig::from_motor_file(&motor, T_SAMPLE).expect("it ships");
            Monitor::new(config).expect("it ships")
        })
    })
}

/// Steps of four bytes: what, how long, and two values. Whatever comes: no panic; a window that is judged holds finite
/// numbers; FAULT comes on in judged windows or with SENSOR, and never in a window with a sample that is no number.
pub(crate) fn monitor(bytes: &[u8]) {
    for monitor in monitors() {
        let mut state = MonitorState::default();
        let mut watch = Watch::default();
        let mut angle = 0.0f32;
        for step in bytes.chunks_exact(4).take(64) {
            let [what, length, x, y] = [step[0], step[1], step[2], step[3]];
            if what & 0x80 != 0 {
                state.resume_after_gap();
            }
            for k in 0..u32::from(length) * LONGEST {
                let sample = sample(monitor.config(), what & 7, [x, y], k, &mut angle);
                watch.sample(&sample);
                if let Some(report) = monitor.update(&mut state, &sample) {
                    watch.report(&report);
                }
            }
        }
    }
}

fn sample(config: &MonitorConfig, what: u8, [x, y]: [u8; 2], k: u32, angle: &mut f32) -> Sample {
    let (share, load) = (f32::from(x) / 100.0, f32::from(y) / 100.0);
    let omega = config.rated_omega;
    *angle = (*angle + omega * config.t_sample) % std::f32::consts::TAU;
    let mut sample = sine(config, *angle, 1.0, load);
    let bits = f32::from_bits(u32::from_be_bytes([x, y, x ^ y, k as u8]));
    let channel = usize::from(x % 7);
    match what {
        0 => sample = sine(config, *angle, share, load),
        1 => put(&mut sample, channel, f32::NAN),
        2 => put(
            &mut sample,
            channel,
            if y & 1 == 0 {
                f32::INFINITY
            } else {
                f32::NEG_INFINITY
            },
        ),
        3 => (0..7).for_each(|channel| put(&mut sample, channel, bits)),
        4 => put(&mut sample, channel, bits),
        5 => put(
            &mut sample,
            channel,
            config.rated_current * (share - 1.28) * 100.0,
        ),
        6 => hide(&mut sample, x, y),
        _ => sample = sine(config, *angle * share, load, share),
    }
    sample
}

/// A motor that is supplied: voltage, a lagging current, a speed with slip.
fn sine(config: &MonitorConfig, angle: f32, voltage: f32, load: f32) -> Sample {
    let three = |amplitude: f32, lag: f32| {
        let phase = |k: f32| amplitude * (angle - lag - k * std::f32::consts::TAU / 3.0).cos();
        Some(Abc {
            a: phase(0.0),
            b: phase(1.0),
            c: phase(2.0),
        })
    };
    let speed = config.rated_omega / config.mechanics.n_p * (1.0 - 0.05 * load);
    Sample {
        u_s_abc: three(config.rated_voltage * voltage, 0.0),
        i_s_abc: three(config.rated_current * (0.4 + 0.6 * load), 0.8),
        speed: SpeedSample::RadPerSecond(speed),
        ..Sample::default()
    }
}

fn put(sample: &mut Sample, channel: usize, value: f32) {
    let place = match channel {
        0..3 => sample.u_s_abc.as_mut(),
        3..6 => sample.i_s_abc.as_mut(),
        _ => {
            sample.speed = SpeedSample::RadPerSecond(value);
            return;
        }
    };
    if let Some(abc) = place {
        *[&mut abc.a, &mut abc.b, &mut abc.c][channel % 3] = value;
    }
}

fn hide(sample: &mut Sample, x: u8, y: u8) {
    if x & 1 != 0 {
        sample.u_s_abc = None;
    }
    if x & 2 != 0 {
        sample.i_s_abc = None;
    }
    if x & 4 != 0 {
        sample.speed = SpeedSample::Count(u16::from(y) << 8 | u16::from(x));
    }
    if x & 8 != 0 {
        sample.clipped.mark_current(usize::from(y));
    }
    if x & 16 != 0 {
        sample.tau_load = Some(f32::from_bits(u32::from(y) << 24));
    }
}

/// What was seen, and what must hold.
#[derive(Default)]
struct Watch {
    fault: bool,
    sound_seen: bool,
}

impl Watch {
    fn sample(&mut self, sample: &Sample) {
        let finite = |abc: Option<Abc>| {
            abc.is_some_and(|abc| abc.a.is_finite() && abc.b.is_finite() && abc.c.is_finite())
        };
        self.sound_seen |= finite(sample.u_s_abc) || finite(sample.i_s_abc);
    }

    fn report(&mut self, report: &Report) {
        let fault = report.lamps.fault == Lamp::On;
        let comes = fault && !self.fault;
        // docs/lamps.md: r1..r4 or SENSOR, and r1..r4 move in judged windows only.
        let reason = report.is_judged() || report.lamps.sensor == Lamp::On;
        assert!(!comes || reason, "FAULT came on in {report:?}");
        let numbers = report
            .window
            .is_none_or(|window| window.invalid_samples == 0);
        assert!(
            !comes || numbers,
            "FAULT came on without numbers: {report:?}"
        );
        assert!(
            !fault || self.sound_seen,
            "FAULT without a number: {report:?}"
        );
        self.fault = fault;
        if report.is_judged() {
            let text = format!("{report:?}");
            assert!(
                !text.contains("NaN") && !text.contains("inf"),
                "judged: {text}"
            );
        }
        if report.not_judged == Some(NotJudged::Invalid) {
            assert!(report.candidates.is_none(), "causes of nothing: {report:?}");
        }
    }
}
