//! The monitor's sample path alone on a Cortex-M4F, so that its symbols and size can be inspected.
//!
//! Samples come from memory that the compiler cannot see through and lamps go to such memory, so
//! that nothing is optimised away. It is inspected, not run.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use monitor::{
    ComparatorConfig, Converter, FieldCurrent, Frame, LoadKind, Monitor, MonitorConfig,
    MonitorState, RawSample,
};
use motor::{Mechanics, TParams};

const CONFIG: MonitorConfig = MonitorConfig {
    t_sample: 1e-4,
    converter: Converter {
        voltage: CHANNEL,
        current: CHANNEL,
        max_code: 4095,
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
};

const CHANNEL: monitor::ChannelScale = monitor::ChannelScale {
    unit_per_code: 0.1,
    zero_code: 2048.0,
    gain: monitor::Abc::splat(1.0),
    offset: monitor::Abc::splat(0.0),
};

#[entry]
fn main() -> ! {
    let mut state = MonitorState::default();
    if let Ok(monitor) = Monitor::new(black_box(CONFIG)) {
        loop {
            let raw = black_box(RawSample::default());
            black_box(sample_path(&monitor, &mut state, &raw));
        }
    }
    loop {}
}

/// The whole way of one sample, kept as a symbol of its own.
#[inline(never)]
fn sample_path(monitor: &Monitor, state: &mut MonitorState, raw: &RawSample) -> u8 {
    monitor
        .update_raw(state, raw)
        .map_or(0, |report| u8::from(report.lamps.is_quiet()))
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}
