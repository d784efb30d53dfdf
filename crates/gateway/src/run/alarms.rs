//! Alarms follow what is stored.

use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fleet::alarm::{AlarmChange, Change, Watch};
use fleet::{Store, now_ms};
use tokio::sync::watch;

/// How soon behind a batch its alarms are there.
const PAUSE: Duration = Duration::from_millis(50);
/// Delays, shelves and floods end to the second.
const LONGEST: Duration = Duration::from_secs(1);

/// What it works with.
pub(super) struct Alarms {
    pub store: Arc<Store>,
    pub watch: Arc<Watch>,
    pub stored: watch::Receiver<u64>,
    pub say: Arc<dyn Fn(String) + Send + Sync>,
    pub ended: watch::Receiver<bool>,
}

impl Alarms {
    /// Works until the gateway ends. A failure is told once, until it works again: nothing is lost by it.
    pub fn run(mut self) {
        let mut failed = false;
        while self.waits() {
            let outcome = self.watch.work(&self.store, now_ms());
            match (&outcome, failed) {
                (Ok(changes), _) => changes.iter().for_each(|change| self.tell(change)),
                (Err(error), false) => (self.say)(format!("alarms: {error}; they are made up for")),
                (Err(_), true) => {}
            }
            failed = outcome.is_err();
        }
    }

    /// Until something is stored, or for a second; `false` once the gateway ends.
    fn waits(&mut self) -> bool {
        let begin = Instant::now();
        loop {
            sleep(PAUSE);
            // Without a sender the gateway was dropped.
            if *self.ended.borrow() || self.ended.has_changed().is_err() {
                return false;
            }
            let news = self.stored.has_changed().unwrap_or(false);
            if news || begin.elapsed() >= LONGEST {
                self.stored.mark_unchanged();
                return true;
            }
        }
    }

    fn tell(&self, change: &AlarmChange) {
        if matches!(change.change, Change::Raised) {
            let alarm = &change.alarm;
            let motor = alarm.motor.as_ref();
            let whose = motor.map_or("plant".to_owned(), |motor| format!("motor {motor}"));
            let (number, words) = (alarm.number, &alarm.evidence.words);
            (self.say)(format!("alarm {number}: {whose}: {words}"));
        }
    }
}
