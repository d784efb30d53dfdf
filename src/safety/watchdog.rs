//! The independent watchdog: fed after a while, when all marks are there, and neither sooner nor otherwise.

use embassy_stm32::Peri;
use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::peripherals::IWDG;
use embassy_time::{Duration, Instant};

use super::{marks, retained};

/// Counts of 0.5 ms (32 kHz / 16; the oscillator is within 8 %) until it resets the board: 0.25 s. Ten blocks and three
/// recoveries fit, a person does not notice it.
const TIMEOUT_COUNTS: u16 = 500;
/// Counts during which feeding is fatal: 25 ms. A program that feeds in a tight loop is not alive.
const CLOSED_COUNTS: u16 = 50;
/// Between two feedings at least; the slowest oscillator's closed window is 27 ms.
const INTERVAL: Duration = Duration::from_millis(60);

/// The watchdog, running.
pub struct Watchdog {
    _peripheral: Peri<'static, IWDG>,
    fed: Instant,
}

impl Watchdog {
    /// Starts it; where an option byte had hardware start it, it goes on with these times.
    pub fn start(peripheral: Peri<'static, IWDG>) -> Self {
        let kr = pac::IWDG.kr();
        kr.write(|w| w.set_key(Key::START));
        kr.write(|w| w.set_key(Key::ENABLE));
        pac::IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY16));
        pac::IWDG.rlr().write(|w| w.set_rl(TIMEOUT_COUNTS));
        // Writing the window feeds it as well.
        while pac::IWDG.sr().read().0 != 0 {}
        pac::IWDG
            .winr()
            .write(|w| w.set_win(TIMEOUT_COUNTS - CLOSED_COUNTS));
        note(Instant::now());
        Watchdog {
            _peripheral: peripheral,
            fed: Instant::now(),
        }
    }

    /// Feeds it where all marks are there and it is time.
    pub fn look(&mut self) {
        let now = Instant::now();
        marks::note_time(now);
        if now - self.fed < INTERVAL {
            return;
        }
        let missing = marks::missing();
        if missing == 0 {
            self.feed(now);
        } else {
            note(now);
        }
    }

    /// Does not feed it: there was no good block. Should it end the program, it is told what else was missing.
    pub fn starve(&self) {
        note(Instant::now());
    }

    /// Feeds it while no samples are taken: during the lamp test, and where nothing is computed.
    pub fn feed_while_waiting(&mut self) {
        let now = Instant::now();
        marks::note_time(now);
        if now - self.fed >= INTERVAL {
            self.feed(now);
        }
    }

    fn feed(&mut self, now: Instant) {
        pac::IWDG.kr().write(|w| w.set_key(Key::RESET));
        marks::wipe();
        // Should the program never look again, all of them were missing.
        note(now);
        self.fed = now;
    }
}

/// Notes which marks are missing now, should the watchdog end the program.
fn note(now: Instant) {
    marks::note_time(now);
    retained::note(marks::missing(), marks::uptime_ms());
}
