//! Samples through the core, at once or piece by piece.

use monitor::{Monitor, MonitorState, Report};

use crate::moving::Follower;
use crate::samples::{Before, Samples};
use crate::timeline::Timeline;

/// Why a recording with such a speed is not judged in motion.
const SPEED_IS_HELD: &str =
    "the speed is held until the next value, so while it changes it is shown too late";

/// A replay of a recording that comes in pieces: all that the core remembers goes on from one to the next, so that the
/// answer is that of the recording as a whole, bit for bit.
pub struct Replay {
    monitor: Monitor,
    state: MonitorState,
    follower: Follower,
    timeline: Timeline,
    before: Option<Before>,
}

impl Replay {
    /// Before the first sample. The motor is judged in motion as far as it was seen to move as its file says.
    pub fn new(monitor: Monitor) -> Replay {
        Replay {
            state: MonitorState::default(),
            follower: Follower::new(&monitor),
            timeline: Timeline::new(monitor.config()),
            before: None,
            monitor,
        }
    }

    /// Takes the samples that follow; where time has passed since the last ones, as after a gap. `progress` gets the number
    /// of samples done.
    pub fn take(&mut self, samples: Samples<'_>, progress: &mut dyn FnMut(usize)) {
        self.follow(samples, &mut |done, _, _| progress(done));
    }

    /// The same; `look` gets the number of samples done, the time, s, and the report of each window.
    pub fn follow(&mut self, samples: Samples<'_>, look: &mut dyn FnMut(usize, f64, &Report)) {
        let samples = match self.before {
            Some(before) => samples.continuing(before),
            None => samples,
        };
        if samples.shows_speed_late() {
            self.follower.stop(SPEED_IS_HELD);
        }
        for (k, timed) in samples.iter().enumerate() {
            if timed.after_gap {
                self.state.resume_after_gap();
                self.follower.resume_after_gap();
            }
            let report = self.monitor.update(&mut self.state, &timed.sample);
            self.follower.update(timed.t, &timed.sample, &self.state);
            if let Some(mut report) = report {
                self.follower.window(&report);
                report.moving = self.follower.moving();
                self.timeline.add(timed.t, &report);
                self.note_beyond(&report);
                look(k + 1, timed.t, &report);
            }
        }
        self.before = samples.end();
    }

    fn note_beyond(&mut self, report: &Report) {
        let judged = report.window.filter(|_| report.is_judged());
        let beyond = judged.and_then(|window| self.monitor.beyond(&window));
        if let Some(beyond) = beyond {
            self.timeline.add_beyond(&beyond);
        }
    }

    /// What all samples came to.
    pub fn finish(self) -> Timeline {
        let mut timeline = self.timeline;
        timeline.finish();
        timeline.motion = self.follower.finish();
        timeline
    }
}

/// Runs every sample through the core; `progress` gets the number of samples done.
pub fn replay(
    monitor: &Monitor,
    samples: &Samples<'_>,
    progress: &mut dyn FnMut(usize),
) -> Timeline {
    let mut replay = Replay::new(*monitor);
    replay.take(*samples, progress);
    replay.finish()
}
