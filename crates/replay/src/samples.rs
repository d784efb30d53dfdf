//! A recording as the samples that the core takes.

use audit::{Audit, Code};
use monitor::{Abc, ClippedChannels, Sample, SpeedSample};
use recording::{Channel, Recording, VoltageKind};

/// Largest step of the clock, in sampling times, that is not a gap.
const LARGEST_STEP: f64 = 1.5;

/// Level of each channel (voltages a, b, c, currents a, b, c) from which on it counts as clipped.
#[derive(Clone, Copy, Debug)]
struct Rails([f64; 6]);

/// The samples of one recording, or of a piece of one.
#[derive(Clone, Copy)]
pub struct Samples<'r> {
    recording: &'r Recording,
    voltages: Option<[&'r [f64]; 3]>,
    currents: Option<[&'r [f64]; 3]>,
    speed: Option<&'r [f64]>,
    torque: Option<&'r [f64]>,
    held_voltage: bool,
    /// The speed is shown too late to be judged while it changes.
    late_speed: bool,
    rails: Rails,
    t_sample: f64,
    before: Option<Before>,
}

/// The last sample of a piece, which the next one continues.
#[derive(Clone, Copy, Debug)]
pub struct Before {
    t: f64,
    u_s_abc: Option<Abc>,
    /// Sampling time of the first piece, s.
    t_sample: f64,
}

/// One sample with what the clock says about it.
#[derive(Clone, Copy, Debug)]
pub struct Timed {
    /// Time of the recording, s.
    pub t: f64,
    /// Samples are missing before this one.
    pub after_gap: bool,
    /// The sample.
    pub sample: Sample,
}

/// Longest time for which a speed is held that is judged while it changes, s: it is late by half of it, and a counter that counts meanwhile by as much
/// again.
const LONGEST_HOLD_S: f64 = 1.5e-3;

/// Whether the audit found that the speed is held for longer than that.
fn is_late(audit: &Audit, t_sample: f64) -> bool {
    let speed = Channel::SPEED.to_string();
    let held = audit
        .findings
        .iter()
        .filter(|finding| finding.code == Code::Held);
    let mut rows = held.filter(|finding| finding.channel == speed);
    rows.any(|finding| finding.value * t_sample > LONGEST_HOLD_S)
}

impl<'r> Samples<'r> {
    /// The samples of a recording; channels that the audit calls unusable are left out.
    pub fn new(recording: &'r Recording, audit: &Audit) -> Self {
        let usable = |channels: &[Channel]| {
            let name = |channel: &Channel| channel.to_string();
            !channels
                .iter()
                .map(name)
                .any(|name| audit.unusable.contains(&name))
        };
        Samples {
            recording,
            voltages: recording.voltages(),
            currents: recording.currents(),
            speed: recording.speed().filter(|_| usable(&[Channel::SPEED])),
            torque: recording.torque().filter(|_| usable(&[Channel::TORQUE])),
            held_voltage: recording.metadata.voltage == VoltageKind::Hold,
            late_speed: is_late(audit, recording.t_sample()),
            rails: Rails::new(recording, audit),
            t_sample: recording.t_sample(),
            before: None,
        }
    }

    /// Whether the speed is held, so that it is shown too late to be judged while it changes.
    pub fn shows_speed_late(&self) -> bool {
        self.late_speed && self.speed.is_some()
    }

    /// The same as what follows a piece.
    pub fn continuing(self, before: Before) -> Self {
        Samples {
            t_sample: before.t_sample,
            before: Some(before),
            ..self
        }
    }

    /// What the next piece continues.
    pub fn end(&self) -> Option<Before> {
        let last = self.len().checked_sub(1)?;
        Some(Before {
            t: self.recording.t()[last],
            u_s_abc: self.voltages.map(|u| abc(u, last)),
            t_sample: self.t_sample,
        })
    }

    /// Leaves out the speed: of an unknown motor nothing can be judged from it.
    pub fn leave_out_speed(&mut self) {
        self.speed = None;
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.recording.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All samples in order.
    pub fn iter(&self) -> impl Iterator<Item = Timed> + '_ {
        (0..self.len()).map(|k| self.at(k))
    }

    /// Sample `k`.
    ///
    /// # Panics
    /// From [`Samples::len`] on.
    pub fn at(&self, k: usize) -> Timed {
        let t = self.recording.t();
        let before = match k {
            0 => self.before.map(|before| before.t),
            _ => Some(t[k - 1]),
        };
        let step = before.map_or(0.0, |before| t[k] - before);
        Timed {
            t: t[k],
            after_gap: step > LARGEST_STEP * self.t_sample,
            sample: Sample {
                u_s_abc: self.voltages.map(|u| self.voltage_at(u, k)),
                i_s_abc: self.currents.map(|i| abc(i, k)),
                speed: self.speed.map_or(SpeedSample::None, |speed| {
                    SpeedSample::RadPerSecond(speed[k] as f32)
                }),
                tau_load: self.torque.map(|torque| torque[k] as f32),
                clipped: self.clipped_at(k),
            },
        }
    }

    /// A commanded voltage is held until the next sample: around a sample it is the mean of the two values
    /// that meet there, which puts the half sample of delay where the motor sees it.
    fn voltage_at(&self, u: [&[f64]; 3], k: usize) -> Abc {
        let now = abc(u, k);
        let before = match k {
            0 => self.before.and_then(|before| before.u_s_abc),
            _ => Some(abc(u, k - 1)),
        };
        match before.filter(|_| self.held_voltage) {
            Some(before) => now.zip(before, |x, y| 0.5 * (x + y)),
            None => now,
        }
    }

    fn clipped_at(&self, k: usize) -> ClippedChannels {
        let mut clipped = ClippedChannels::NONE;
        let beyond = |values: Option<[&[f64]; 3]>, phase: usize, rail: f64| {
            values.is_some_and(|values| values[phase][k].abs() >= rail)
        };
        for phase in 0..3 {
            if beyond(self.voltages, phase, self.rails.0[phase]) {
                clipped.mark_voltage(phase);
            }
            if beyond(self.currents, phase, self.rails.0[3 + phase]) {
                clipped.mark_current(phase);
            }
        }
        clipped
    }
}

fn abc([a, b, c]: [&[f64]; 3], k: usize) -> Abc {
    Abc::from_array([a[k] as f32, b[k] as f32, c[k] as f32])
}

/// Share of the level that the audit found at which a sample belongs to the flat top.
const FLAT_TOP: f64 = 0.995;

impl Rails {
    fn new(recording: &Recording, audit: &Audit) -> Self {
        let channels = [Channel::VOLTAGES, Channel::CURRENTS].concat();
        let mut rails = Rails([f64::INFINITY; 6]);
        for (rail, channel) in rails.0.iter_mut().zip(channels) {
            let declared = declared_rail(recording, channel);
            let found = found_rail(audit, channel);
            *rail = declared.min(found);
        }
        rails
    }
}

fn declared_rail(recording: &Recording, channel: Channel) -> f64 {
    let sensors = &recording.metadata.sensors;
    let step = sensors.step(channel).unwrap_or(0.0);
    sensors
        .full_scale(channel)
        .map_or(f64::INFINITY, |full_scale| full_scale - 1.5 * step)
}

fn found_rail(audit: &Audit, channel: Channel) -> f64 {
    let name = channel.to_string();
    audit
        .findings
        .iter()
        .filter(|finding| finding.code == Code::Clipping)
        .filter(|finding| finding.channel.split_whitespace().any(|word| word == name))
        .map(|finding| FLAT_TOP * finding.value.abs())
        .fold(f64::INFINITY, f64::min)
}
