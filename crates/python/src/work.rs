//! Work without Python's lock, on a thread of its own: other Python threads go on, Ctrl-C is heard, progress is told.

use crate::errors::usage;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often signals are looked at and progress is told.
const TURN: Duration = Duration::from_millis(50);
/// Frames of the simulation and of matrices are deep in a build without optimisation.
const STACK_BYTES: usize = 16 << 20;

/// What the work says of itself, and whether it is still wanted.
#[derive(Debug, Default)]
pub struct Told {
    now: Mutex<(String, f64)>,
    unwanted: AtomicBool,
}

/// What unwinds work that nobody wants any more.
struct Unwanted;

impl Told {
    /// Says what is being done, and how far it is, 0 to 1. Work that is not wanted any more ends here.
    pub fn say(&self, what: &str, share: f64) {
        if self.unwanted.load(Ordering::Relaxed) {
            // No panic: no message is printed. The work holds nothing that another call uses.
            resume_unwind(Box::new(Unwanted));
        }
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        what.clone_into(&mut now.0);
        now.1 = share;
    }

    fn now(&self) -> (String, f64) {
        let now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        now.clone()
    }
}

/// Does `work`; `progress`, where there is one, is called with what is being done and how far it is.
///
/// Ctrl-C and an exception of `progress` end the call at once; the work itself ends when it next says how far it is.
///
/// # Errors
/// `KeyboardInterrupt`, what `progress` raised, or work that broke off.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Told) -> T + Send + 'static,
) -> PyResult<T> {
    let told = Arc::new(Told::default());
    let (sender, receiver) = channel();
    let inside = Arc::clone(&told);
    let thread = std::thread::Builder::new()
        .name("drivemon".into())
        .stack_size(STACK_BYTES);
    let begun = thread.spawn(move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| work(&inside)));
        // Nobody listens after Ctrl-C.
        let _ = sender.send(outcome);
    });
    begun.map_err(|error| usage(format!("no thread for the work: {error}")))?;
    let outcome = wait(py, progress, &told, receiver);
    if outcome.is_err() {
        told.unwanted.store(true, Ordering::Relaxed);
    }
    outcome?.map_err(|_| usage("the question broke off; please report it"))
}

type Outcome<T> = Result<T, Box<dyn Any + Send>>;

fn wait<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    told: &Told,
    receiver: Receiver<Outcome<T>>,
) -> PyResult<Outcome<T>> {
    let mut last = (String::new(), -1.0);
    let mut receiver = receiver;
    loop {
        // The receiver is no one's but this thread's; it goes in and comes out again.
        let (back, answer) = py.detach(move || {
            let answer = receiver.recv_timeout(TURN);
            (receiver, answer)
        });
        receiver = back;
        py.check_signals()?;
        let ended = match answer {
            Ok(outcome) => Some(outcome),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Err(Box::new(Unwanted) as _)),
        };
        if let Some(progress) = progress {
            let mut now = told.now();
            if ended.as_ref().is_some_and(Result::is_ok) {
                now.1 = 1.0;
            }
            if now != last {
                progress.call1((now.0.as_str(), now.1))?;
                last = now;
            }
        }
        if let Some(outcome) = ended {
            return Ok(outcome);
        }
    }
}
