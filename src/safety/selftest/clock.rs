//! The crystal against the low-speed oscillator, which the calendar counts, and the rate of the blocks against both.

use embassy_stm32::pac;
use embassy_time::Instant;

/// Sub-seconds per second of the calendar with its prescalers as they come out of reset: 32 kHz / 128.
const SUBSECONDS_HZ: u32 = 250;
/// Sub-seconds per second of the calendar, and until its seconds begin anew.
const SUBSECONDS: u32 = 256;
const ROUND: u32 = 60 * SUBSECONDS;
/// Per cent by which the two clocks may differ: the low-speed oscillator is within 8 % at all temperatures. It finds a wrong
/// crystal or one on an overtone, not 0.1 %.
const CLOCK_TOLERANCE: u32 = 12;
/// What a block takes.
const BLOCK_MICROS: u32 = 3_200;
/// Per cent of it by which blocks may come too soon or too late, on average from look to look.
const BLOCK_TOLERANCE: u32 = 2;

/// What a look found.
pub struct Found {
    /// The two clocks agree.
    pub clock_is_sound: bool,
    /// The blocks came at their rate.
    pub blocks_are_sound: bool,
}

/// The last look.
#[derive(Default)]
pub struct Calendar {
    last: Option<(Instant, u32, u32)>,
}

impl Calendar {
    /// Looks after block number `block`, about once a second; `None` the first time.
    pub fn look(&mut self, block: u32) -> Option<Found> {
        let now = (Instant::now(), subseconds(), block);
        let (then, before, first) = self.last.replace(now)?;
        let passed = (now.0 - then).as_micros().min(10_000_000) as u32;
        let counted = (now.1 + ROUND - before) % ROUND;
        let expected = passed / (1_000_000 / SUBSECONDS_HZ);
        Some(Found {
            clock_is_sound: is_near(counted, expected, CLOCK_TOLERANCE),
            blocks_are_sound: is_near(
                passed,
                block.wrapping_sub(first) * BLOCK_MICROS,
                BLOCK_TOLERANCE,
            ),
        })
    }
}

fn is_near(value: u32, expected: u32, percent: u32) -> bool {
    100 * value.abs_diff(expected) <= percent * expected
}

/// Sub-seconds of the calendar since its last full minute. Reading them first holds the others until the date is read.
fn subseconds() -> u32 {
    let left = u32::from(pac::RTC.ssr().read().ss());
    let time = pac::RTC.tr().read();
    let _ = pac::RTC.dr().read();
    let seconds = 10 * u32::from(time.st()) + u32::from(time.su());
    (seconds * SUBSECONDS + SUBSECONDS - 1).saturating_sub(left) % ROUND
}
