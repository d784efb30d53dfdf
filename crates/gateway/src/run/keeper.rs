//! Keeps the store within its limits, beside the writer.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use fleet::{Store, now_ms};
use tokio::sync::watch;

/// Between two looks at the store, in looks at the end: a gateway that ends does not wait for it.
const PAUSE: Duration = Duration::from_millis(250);
const LOOKS: u32 = 20;

/// What it works with.
pub(super) struct Keeper {
    pub store: Arc<Store>,
    pub say: Arc<dyn Fn(String) + Send + Sync>,
    pub ended: watch::Receiver<bool>,
}

impl Keeper {
    /// Works until the gateway ends. A failure is told once, until it works again.
    pub fn run(self) {
        let mut failed = false;
        while self.waits() {
            let outcome = self.store.maintain(now_ms());
            if let (Err(error), false) = (&outcome, failed) {
                (self.say)(format!(
                    "store: it cannot be kept within its limits: {error}"
                ));
            }
            failed = outcome.is_err();
        }
    }

    /// `false` once the gateway ends.
    fn waits(&self) -> bool {
        (0..LOOKS).all(|_| {
            sleep(PAUSE);
            // Without a sender the gateway was dropped.
            !*self.ended.borrow() && self.ended.has_changed().is_ok()
        })
    }
}
