//! How fast a source goes, against the clock on the wall.

use std::time::{Duration, Instant as WallTime};

/// The pace of a source.
#[derive(Debug)]
pub struct Pace {
    /// Source seconds per second on the wall.
    pub speed: f64,
    wall: WallTime,
    source_s: f64,
}

/// A source that has fallen behind by more than this does not catch up, s on the wall.
const FORGIVEN: Duration = Duration::from_millis(500);

impl Pace {
    /// From `source_s` on.
    pub fn new(source_s: f64, speed: f64) -> Pace {
        Pace {
            speed,
            wall: WallTime::now(),
            source_s,
        }
    }

    /// The same pace from another place on.
    pub fn restart(&mut self, source_s: f64) {
        (self.wall, self.source_s) = (WallTime::now(), source_s);
    }

    /// How far the source should be by now, s on its clock.
    pub fn due_s(&self) -> f64 {
        self.source_s + self.speed * self.wall.elapsed().as_secs_f64()
    }

    /// Gives up what the source at `now_s` cannot catch up any more; that time on the wall, s.
    pub fn forgive(&mut self, now_s: f64) -> f64 {
        let behind = (self.due_s() - now_s) / self.speed;
        if behind < FORGIVEN.as_secs_f64() {
            return 0.0;
        }
        self.restart(now_s);
        behind
    }
}
