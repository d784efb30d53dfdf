//! What the source's thread does: samples through the core, windows to all listeners.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::Duration;

use monitor::Monitor;
use motor::MotorFile;

use crate::running::bench::{Bench, MotorError};
use crate::running::pace::Pace;
use crate::running::shared::{Command, Refusal, Request, Shared, locked};
use crate::source::Source;

/// Between two looks at the clock: a quarter of a window at 50 Hz.
const TICK: Duration = Duration::from_millis(5);
/// Source time that is worked on between two looks for commands, s.
const SLICE_S: f64 = 0.02;

/// The page shows how far a slow computer is behind in these steps, s; a message for every slice would slow it further.
const BEHIND_SHOWN_S: f64 = 0.1;

/// Before an instant that is sought, s: finding the supply, filling a window and the persistence of the lamps at 5 Hz and more.
const RUN_UP_S: f64 = 2.0;

/// Everything that the thread owns.
pub(crate) struct Worker {
    source: Box<dyn Source>,
    bench: Bench,
    /// Whether the source follows the clock here: a board has its own.
    paced: bool,
    pace: Pace,
    shared: Arc<Shared>,
}

impl Worker {
    /// # Errors
    /// A motor whose values do not fit the core.
    pub fn new(
        source: Box<dyn Source>,
        motor: Option<MotorFile>,
        shared: Arc<Shared>,
    ) -> Result<Worker, MotorError> {
        let bench = Bench::new(source.as_ref(), motor.as_ref(), shared.clone())?;
        let pace = Pace::new(source.now_s(), locked(&shared.status).speed);
        Ok(Worker {
            bench,
            paced: source.info().can.pace,
            source,
            pace,
            shared,
        })
    }

    /// Runs until it is told to end.
    pub fn run(mut self, inbox: &Receiver<Command>) {
        while self.obey(inbox).is_continue() {
            self.work();
        }
    }

    /// Waits for the next look at the clock, or for a command.
    fn obey(&mut self, inbox: &Receiver<Command>) -> ControlFlow<()> {
        let behind =
            !self.paced || !self.rests() && self.pace.due_s() > self.source.now_s() + SLICE_S;
        let command = match behind {
            true => inbox
                .try_recv()
                .map_err(|error| error == TryRecvError::Disconnected),
            false => inbox
                .recv_timeout(TICK)
                .map_err(|error| error == RecvTimeoutError::Disconnected),
        };
        match command {
            Ok(Some((request, reply))) => {
                let done = self.grant(request);
                // Who asked may have gone.
                let _ = reply.send(done);
                self.tell_status();
                ControlFlow::Continue(())
            }
            Ok(None) | Err(true) => ControlFlow::Break(()),
            Err(false) => ControlFlow::Continue(()),
        }
    }

    fn rests(&self) -> bool {
        locked(&self.shared.status).rests()
    }

    fn work(&mut self) {
        if !self.rests() {
            self.advance(self.pace.due_s().min(self.source.now_s() + SLICE_S));
        }
    }

    fn advance(&mut self, until: f64) {
        let bench = &mut self.bench;
        bench.rehearse(self.source.rehearsal());
        let outcome = self.source.advance(until, &mut |item| bench.take(item));
        let (goes_on, failure) = match outcome {
            Ok(goes_on) => (goes_on, None),
            Err(failure) => (true, Some(failure.to_string())),
        };
        let forgiven = match self.paced {
            true => self.pace.forgive(self.source.now_s()),
            false => 0.0,
        };
        self.note(goes_on, failure, forgiven);
    }

    fn note(&mut self, goes_on: bool, failure: Option<String>, forgiven: f64) {
        let mut status = locked(&self.shared.status);
        let shown = |behind_s: f64| (behind_s / BEHIND_SHOWN_S) as u64;
        let further_behind = shown(status.behind_s) != shown(status.behind_s + forgiven);
        let changed = goes_on == status.ended || status.failure != failure || further_behind;
        status.ended = !goes_on;
        status.failure = failure;
        status.behind_s += forgiven;
        drop(status);
        if changed {
            self.tell_status();
        }
    }

    fn tell_status(&self) {
        let status = locked(&self.shared.status).clone();
        self.shared.tell("status", &status);
    }

    fn grant(&mut self, request: Request) -> Result<(), Refusal> {
        match request {
            Request::Faults(faults) => {
                let done = self.source.switch_faults(&faults);
                done.map_err(|error| Refusal::of(error.to_string()))?;
                locked(&self.shared.status).faults = faults;
            }
            Request::Speed(speed) => {
                self.pace.restart(self.source.now_s());
                self.pace.speed = speed;
                locked(&self.shared.status).speed = speed;
            }
            Request::Pause(paused) => {
                self.pace.restart(self.source.now_s());
                locked(&self.shared.status).paused = paused;
            }
            Request::Seek(t_s) => self.seek(t_s)?,
            Request::Motor(motor) => self.judge_with(*motor)?,
            Request::Acknowledge(seen) => {
                locked(&self.shared.events).acknowledge(&seen);
                self.bench.tell_events();
            }
        }
        Ok(())
    }

    /// Goes there by way of what is needed to judge: a source that is paused, or sought at its end, shows that instant.
    fn seek(&mut self, t_s: f64) -> Result<(), Refusal> {
        let done = self.source.seek(t_s - RUN_UP_S);
        done.map_err(|error| Refusal::of(error.to_string()))?;
        self.bench.restart();
        locked(&self.shared.events).interrupt();
        self.advance(t_s);
        self.pace.restart(self.source.now_s());
        Ok(())
    }

    fn judge_with(&mut self, motor: MotorFile) -> Result<(), Refusal> {
        let config = self.source.config(Some(&motor));
        let Some(config) = config.map_err(|error| Refusal::of(error.to_string()))? else {
            return Err(Refusal::of(
                "this board judges with the motor file that it was flashed with: flash it with the new one",
            ));
        };
        let monitor = Monitor::new(config).map_err(|error| Refusal::of(error.to_string()))?;
        locked(&self.shared.status).judge_with(&motor);
        *locked(&self.shared.motor) = Some(motor.clone());
        self.bench.judge_with(self.source.as_ref(), &motor, monitor);
        Ok(())
    }
}
