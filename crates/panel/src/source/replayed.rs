//! A recording, played at the speed that the page chooses.

use audit::Audit;
use document::FileError;
use monitor::MonitorConfig;
use motor::MotorFile;
use recording::Recording;

use super::{Can, Instant, Item, Reading, Source, SourceFailure, SourceInfo};
use replay::{Samples, config_for, stand_in_config};

/// A recording with its audit and the place that was reached.
#[derive(Debug)]
pub struct ReplayedSource {
    recording: Recording,
    audit: Audit,
    motor_known: bool,
    next: usize,
    sought: bool,
}

impl ReplayedSource {
    /// From the beginning. Without a motor file the speed is left out: nothing can be judged from it.
    pub fn new(recording: Recording, audit: Audit, motor_known: bool) -> ReplayedSource {
        ReplayedSource {
            recording,
            audit,
            motor_known,
            next: 0,
            sought: false,
        }
    }
}

impl Source for ReplayedSource {
    fn info(&self) -> SourceInfo {
        let t = self.recording.t();
        SourceInfo {
            kind: "recording",
            name: self.recording.name().to_owned(),
            sample_rate_hz: 1.0 / self.recording.t_sample(),
            span_s: Some([t[0], t[t.len() - 1]]),
            can: Can {
                faults: false,
                pace: true,
                seek: true,
                parameters: self.motor_known,
            },
            audit: self.audit.findings.clone(),
        }
    }

    fn now_s(&self) -> f64 {
        let t = self.recording.t();
        t[self.next.min(t.len() - 1)]
    }

    fn advance(&mut self, until_s: f64, take: &mut dyn FnMut(Item)) -> Result<bool, SourceFailure> {
        let mut samples = Samples::new(&self.recording, &self.audit);
        if !self.motor_known {
            samples.leave_out_speed();
        }
        while self.next < samples.len() && self.recording.t()[self.next] < until_s {
            let timed = samples.at(self.next);
            let gap = timed.after_gap || std::mem::take(&mut self.sought);
            let instant = instant(&self.recording, self.next);
            take(Item::Sample(instant, Reading::Si(timed.sample, gap)));
            self.next += 1;
        }
        Ok(self.next < samples.len())
    }

    fn config(&self, motor: Option<&MotorFile>) -> Result<Option<MonitorConfig>, FileError> {
        let recording = &self.recording;
        let config = motor.map_or_else(
            || Ok(stand_in_config(recording)),
            |motor| config_for(motor, recording),
        );
        config.map(Some)
    }

    fn seek(&mut self, t_s: f64) -> Result<(), SourceFailure> {
        self.next = self.recording.t().partition_point(|t| *t < t_s);
        self.sought = true;
        Ok(())
    }
}

fn instant(recording: &Recording, k: usize) -> Instant {
    let three = |channels: Option<[&[f64]; 3]>| {
        channels.map_or([f32::NAN; 3], |channels| channels.map(|x| x[k] as f32))
    };
    Instant {
        t_s: recording.t()[k],
        u_volt: three(recording.voltages()),
        i_amp: three(recording.currents()),
        omega_mech: recording.speed().map_or(f32::NAN, |speed| speed[k] as f32),
    }
}
