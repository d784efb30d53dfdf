//! Signs of life: each of the tasks leaves its mark, and the watchdog is fed when all are there.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_time::Instant;

/// Who leaves a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Mark {
    /// A good block of samples was computed.
    Block = 1,
    /// The Modbus task came round.
    Serial = 2,
    /// A step of the self-test passed.
    SelfTest = 4,
}

const ALL: u32 = Mark::Block as u32 | Mark::Serial as u32 | Mark::SelfTest as u32;

static LEFT: AtomicU32 = AtomicU32::new(0);
static UPTIME_MS: AtomicU32 = AtomicU32::new(0);

/// Leaves a mark.
pub fn leave(mark: Mark) {
    // No other core and no interrupt writes: a load and a store suffice.
    LEFT.store(
        LEFT.load(Ordering::Relaxed) | mark as u32,
        Ordering::Relaxed,
    );
}

/// Marks that are missing.
pub fn missing() -> u32 {
    ALL & !LEFT.load(Ordering::Relaxed)
}

/// Wipes all marks.
pub fn wipe() {
    LEFT.store(0, Ordering::Relaxed);
}

/// Notes the time for handlers that cannot ask the clock any more.
pub fn note_time(now: Instant) {
    UPTIME_MS.store(now.as_millis() as u32, Ordering::Relaxed);
}

/// Time since the start as last noted, ms.
pub fn uptime_ms() -> u32 {
    UPTIME_MS.load(Ordering::Relaxed)
}
