//! The monitor's sample path alone on a Cortex-M4F, so that its symbols and size can be inspected.
//!
//! Samples come from memory that the compiler cannot see through and lamps go to such memory, so
//! that nothing is optimised away. It is inspected, not run.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;

use core_on_target::CONFIG;
use cortex_m_rt::entry;
use monitor::{ActiveEffect, Monitor, MonitorConfig, MonitorState, RawSample};
use motor::effects::STEADY;

#[entry]
fn main() -> ! {
    let mut state = MonitorState::default();
    if let Ok(monitor) = Monitor::new(with_any_effect()) {
        loop {
            let raw = black_box(RawSample::default());
            black_box(sample_path(&monitor, &mut state, &raw));
        }
    }
    loop {}
}

/// The effect is chosen at run time: all of them are part of the program.
fn with_any_effect() -> MonitorConfig {
    let active = |effect: &&'static _| ActiveEffect {
        effect: *effect,
        parameters: black_box([0.1; monitor::MAX_EFFECT_PARAMETERS]),
    };
    let mut config = black_box(CONFIG);
    config.effects[0] = STEADY.get(black_box(0)).map(active);
    config
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
