//! One configuration and one sequence of samples, the same on every machine: samples are made by integers only.
#![no_std]

use monitor::{
    ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind, Monitor, MonitorConfig,
    MonitorState, RawSample, Report,
};
use motor::{Mechanics, TParams};

/// Numbers from all of single precision, subnormal ones, infinities and NaN among them.
pub fn roots(mut tell: impl FnMut(u32, f32)) {
    for bits in (0..=u32::MAX).step_by(0x10_003F) {
        tell(bits, processor::sqrtf(f32::from_bits(bits)));
    }
}

/// An assumed 300 W motor.
pub const CONFIG: MonitorConfig = MonitorConfig {
    t_sample: 1e-4,
    converter: Converter {
        voltage: CHANNEL,
        current: CHANNEL,
        max_code: 4095,
        chain: monitor::AnalogueChain::NONE,
        ratiometric: [false; 2],
    },
    encoder_counts_per_revolution: 4096.0,
    params: TParams {
        r_s: 8.0,
        r_r: 7.0,
        l_ls: 0.028,
        l_lr: 0.028,
        l_m: 0.42,
    },
    effects: [None; monitor::MAX_EFFECTS],
    laws: [None; monitor::MAX_LAWS],
    channel_gain: [1.0; monitor::CHANNELS],
    mechanics: Mechanics {
        n_p: 2.0,
        inertia: 0.002,
        friction: 0.0008,
        load_friction: 0.0035,
    },
    rated_voltage: 179.6,
    rated_current: 1.9,
    rated_omega: 377.0,
    rated_torque: 1.7,
    frame: Frame::RotorFlux,
    field: FieldCurrent::Live,
    load: LoadKind::Friction,
    thresholds: [0.006, 0.03, 0.04, 0.003],
    window_cycles: 5,
    comparator: ComparatorConfig {
        persistence: 3,
        hysteresis: 0.8,
    },
healthy: None,
    cage: monitor::Cage::UNKNOWN,
    doubt: monitor::ParameterDoubt {
        circuit: [0.0; monitor::CIRCUIT],
        effects: [[0.0; monitor::MAX_EFFECT_PARAMETERS]; monitor::MAX_EFFECTS],
    },
};

const CHANNEL: monitor::ChannelScale = monitor::ChannelScale {
    unit_per_code: 0.1,
    zero_code: 2048.0,
    gain: monitor::Abc::splat(1.0),
    offset: monitor::Abc::splat(0.0),
};

/// Instants of the sequence: 2 s.
pub const INSTANTS: u32 = 20_000;
/// 60 Hz at 10 kHz as a share of 2^32.
const STEP: u32 = (60 * (1_u64 << 32) / 10_000) as u32;
/// The current lags the voltage by some 40 degrees, as a share of 2^32.
const LAG: u32 = 477_218_588;
const THIRD: u32 = 1_431_655_765;

/// Runs the core over the sequence and hands out every report.
pub fn run(mut take: impl FnMut(&Report)) {
    let Ok(monitor) = Monitor::new(CONFIG) else {
        return;
    };
    let mut state = MonitorState::default();
    for k in 0..INSTANTS {
        if let Some(report) = monitor.update_raw(&mut state, &instant(k)) {
            take(&report);
        }
    }
}

/// Instant `k`: balanced voltages, lagging currents, noise of one code, a shaft at 11.7 counts per instant;
/// from the middle on, phase b's current shows nothing.
pub fn instant(k: u32) -> RawSample {
    let phase = k.wrapping_mul(STEP);
    let channel = |phase: u32, amplitude: i64, seed: u32| {
        let noise = i64::from(k.wrapping_mul(747_796_405).wrapping_add(seed) >> 30) - 1;
        (2048 + noise + (amplitude * sine(phase) >> 30)) as u16
    };
    let voltage = |n: u32| channel(phase.wrapping_sub(n * THIRD), 1_796, n * 1_000_003);
    let current = |n: u32| channel(phase.wrapping_sub(n * THIRD + LAG), 40, n * 7_000_003);
    let dead = k > INSTANTS / 2;
    RawSample {
        voltage_codes: [voltage(0), voltage(1), voltage(2)],
        current_codes: [current(0), if dead { 2048 } else { current(1) }, current(2)],
        encoder_count: (u64::from(k) * 117 / 10) as u16,
        ..RawSample::default()
    }
}

/// Sine of a share of a turn, times 2^30; odd polynomial of fifth order, error below 2e-4.
fn sine(phase: u32) -> i64 {
    // z in -1..1 (times 2^30) on the rising half, mirrored on the falling one.
    let quarter = i64::from(phase.wrapping_add(1 << 30) as i32);
    let z = (1_i64 << 30) - quarter.abs();
    let square = z * z >> 30;
    let inner = 690_661_000 - (square * 78_072_000 >> 30);
    let outer = 1_686_448_000 - (square * inner >> 30);
    z * outer >> 30
}
