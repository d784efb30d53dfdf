//! What happened: each alarm with the samples around it, in bounded memory.

use std::collections::VecDeque;

use board::LAMP_NAMES;
use recording::{Channel, LoadTorque, Metadata, Recording, Sensors, StartsFrom};
use serde::Serialize;

use crate::running::message::{LikelyCause, WindowMessage};
use crate::source::Instant;

/// Samples are kept from this long before an alarm, s.
const BEFORE_S: f64 = 1.0;
/// And up to this long after it, s.
const AFTER_S: f64 = 0.5;
/// Samples that are kept around one alarm at most: 1.5 s at 10 kHz, four times over.
const MOST_SAMPLES: usize = 60_000;
/// Events in the list; the oldest is forgotten.
const MOST_EVENTS: usize = 200;
/// Events whose samples are kept; older ones lose theirs.
const MOST_RECORDINGS: usize = 16;

/// One alarm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// Counts events since the panel was started.
    pub id: u64,
    /// When it was lit, on the source's clock, s.
    pub t_s: f64,
    /// When the last of its lamps went dark; `None` while one is lit.
    pub cleared_s: Option<f64>,
    /// Seconds since 1970 on the computer's clock.
    pub unix_s: f64,
    /// Lamps that were lit.
    pub lit: Vec<&'static str>,
    /// The likeliest causes when the samples were complete.
    pub causes: Vec<LikelyCause>,
    /// Findings of those windows, in words.
    pub findings: Vec<String>,
    /// Who acknowledged it; `None` before that.
    pub acknowledged: Option<Acknowledgement>,
    /// Samples that can be fetched.
    pub samples: usize,
}

/// Somebody has seen an alarm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Acknowledgement {
    /// Who, as typed; empty for somebody who did not say.
    pub by: String,
    /// When, seconds since 1970 on the computer's clock.
    pub unix_s: u64,
    /// What was said about it.
    pub comment: String,
}

/// The list and the samples.
#[derive(Debug, Default)]
pub struct Events {
    ring: VecDeque<Instant>,
    list: VecDeque<Event>,
    recordings: VecDeque<(u64, Recording)>,
    open: Option<u64>,
    /// Alarms whose samples are still coming, the oldest first: the next may begin before the last one's are complete.
    collecting: VecDeque<Collecting>,
    next: u64,
}

/// An alarm whose samples are still coming.
#[derive(Debug)]
struct Collecting {
    id: u64,
    until_s: f64,
}

/// What is known of the samples beside themselves.
#[derive(Clone, Debug, Default)]
pub struct Belief {
    /// Name of the motor.
    pub name: String,
    /// What is known about the load.
    pub load: LoadTorque,
    /// Full scales, where they are known.
    pub sensors: Sensors,
}

impl Events {
    /// Keeps a sample; `true` when it was the last that the recording of an alarm needed.
    pub fn sample(&mut self, instant: &Instant, belief: &Belief) -> bool {
        let backwards = self.ring.back().is_some_and(|last| last.t_s >= instant.t_s);
        if backwards {
            self.ring.clear();
        }
        let oldest = instant.t_s - BEFORE_S - AFTER_S;
        while self.ring.len() >= MOST_SAMPLES
            || self.ring.front().is_some_and(|first| first.t_s < oldest)
        {
            self.ring.pop_front();
        }
        self.ring.push_back(*instant);
        let mut any = false;
        while let Some(open) = self.collecting.front()
            && instant.t_s >= open.until_s
        {
            let id = open.id;
            self.collecting.pop_front();
            self.keep(id, belief);
            any = true;
        }
        any
    }

    /// Looks at a window; `true` when the list has changed.
    pub fn window(&mut self, window: &WindowMessage, unix_s: f64) -> bool {
        let lit = alarms(window);
        match (self.open, lit.is_empty()) {
            (None, true) => false,
            (None, false) => self.begin(window, lit, unix_s),
            (Some(id), _) => self.go_on(id, window, &lit),
        }
    }

    fn begin(&mut self, window: &WindowMessage, lit: Vec<&'static str>, unix_s: f64) -> bool {
        let id = self.next;
        self.next += 1;
        self.open = Some(id);
        if !self.ring.is_empty() {
            self.collecting.push_back(Collecting {
                id,
                until_s: window.t_s + AFTER_S,
            });
        }
        if self.list.len() >= MOST_EVENTS {
            self.list.pop_front();
        }
        self.list.push_back(Event {
            id,
            t_s: window.t_s,
            cleared_s: None,
            unix_s,
            lit,
            causes: window.causes.clone(),
            findings: window.findings.clone(),
            acknowledged: None,
            samples: 0,
        });
        true
    }

    /// More lamps, later causes, or the end of an alarm.
    fn go_on(&mut self, id: u64, window: &WindowMessage, lit: &[&'static str]) -> bool {
        let collecting = self.collecting.iter().any(|open| open.id == id);
        let Some(event) = self.list.iter_mut().find(|event| event.id == id) else {
            self.open = None;
            return false;
        };
        let known = event.lit.len();
        let more = lit.iter().filter(|lamp| !event.lit.contains(lamp));
        let more: Vec<&str> = more.copied().collect();
        event.lit.extend(more);
        event
            .lit
            .sort_by_key(|lamp| LAMP_NAMES.iter().position(|name| name == lamp));
        if lit.is_empty() {
            event.cleared_s = Some(window.t_s);
            self.open = None;
            return true;
        }
        if collecting && !window.causes.is_empty() {
            event.causes.clone_from(&window.causes);
            event.findings.clone_from(&window.findings);
        }
        event.lit.len() != known
    }

    fn keep(&mut self, id: u64, belief: &Belief) {
        if let Ok(recording) = to_recording(&self.ring, belief) {
            self.keep_recording(id, recording);
        }
    }

    /// The samples that a board has kept around its latest alarm.
    pub fn keep_captured(&mut self, recording: Recording) {
        if let Some(event) = self.list.back() {
            let id = event.id;
            self.keep_recording(id, recording);
        }
    }

    fn keep_recording(&mut self, id: u64, recording: Recording) {
        if self.recordings.len() >= MOST_RECORDINGS
            && let Some((lost, _)) = self.recordings.pop_front()
        {
            self.mark(lost, 0);
        }
        self.mark(id, recording.len());
        self.recordings.push_back((id, recording));
    }

    fn mark(&mut self, id: u64, samples: usize) {
        if let Some(event) = self.list.iter_mut().find(|event| event.id == id) {
            event.samples = samples;
        }
    }

    /// The list, the oldest first.
    pub fn list(&self) -> Vec<Event> {
        self.list.iter().cloned().collect()
    }

    /// The samples around an alarm.
    pub fn recording(&self, id: u64) -> Option<&Recording> {
        let found = self.recordings.iter().find(|(known, _)| *known == id);
        found.map(|(_, recording)| recording)
    }

    /// Acknowledges all open events.
    pub fn acknowledge(&mut self, seen: &Acknowledgement) {
        for event in &mut self.list {
            event.acknowledged.get_or_insert_with(|| seen.clone());
        }
    }

    /// The source's clock has jumped: what was open ends without an end.
    pub fn interrupt(&mut self) {
        self.open = None;
        self.collecting.clear();
        self.ring.clear();
    }
}

/// Lamps that make an event; r1..r4 alone do not.
fn alarms(window: &WindowMessage) -> Vec<&'static str> {
    let lit = window.lamps.lit();
    let alarm = lit
        .iter()
        .any(|lamp| matches!(*lamp, "fault" | "sensor" | "line" | "load"));
    if alarm { lit } else { Vec::new() }
}

fn to_recording(ring: &VecDeque<Instant>, belief: &Belief) -> Result<Recording, recording::Error> {
    let column = |of: &dyn Fn(&Instant) -> f32| -> Vec<f64> {
        ring.iter().map(|instant| f64::from(of(instant))).collect()
    };
    let t = ring.iter().map(|instant| instant.t_s).collect();
    let metadata = Metadata {
        supply_belief: "not known: samples around an alarm, kept by the panel".into(),
        load_torque: belief.load,
        starts_from: StartsFrom::Running,
        sensors: belief.sensors.clone(),
        ..Metadata::default()
    };
    let mut recording = Recording::new(&belief.name, t, metadata)?;
    let mut columns = vec![(Channel::SPEED, column(&|instant| instant.omega_mech))];
    for k in 0..3 {
        columns.push((Channel::VOLTAGES[k], column(&|instant| instant.u_volt[k])));
        columns.push((Channel::CURRENTS[k], column(&|instant| instant.i_amp[k])));
    }
    // What a source does not measure stands as NaN in its samples.
    columns.retain(|(_, values)| values.iter().all(|x| x.is_finite()));
    for (channel, values) in columns {
        recording = recording.with_channel(channel, values)?;
    }
    Ok(recording)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::running::message::LampsMessage;
    use monitor::Lamp;

    /// A window in which FAULT is lit or dark.
    fn window(t_s: f64, fault: bool) -> WindowMessage {
        WindowMessage {
            t_s,
            lamps: LampsMessage {
                fault: if fault { Lamp::On } else { Lamp::Off },
                ..LampsMessage::default()
            },
            ..WindowMessage::default()
        }
    }

    #[test]
    fn an_alarm_that_begins_while_the_samples_of_another_still_come_takes_none_of_them() {
        let (mut events, belief) = (Events::default(), Belief::default());
        let lit = [1.5..1.6, 1.8..1.9, 2.05..2.5];
        for k in 0..4_000 {
            let t_s = f64::from(k) * 1e-3;
            let instant = Instant {
                t_s,
                ..Instant::default()
            };
            events.sample(&instant, &belief);
            if k % 20 == 0 {
                let fault = lit.iter().any(|lit| lit.contains(&t_s));
                events.window(&window(t_s, fault), 0.0);
            }
        }
        let list = events.list();
        assert_eq!(list.len(), 3);
        for event in &list {
            let samples = events.recording(event.id).expect("samples");
            // A second before and half a second after.
            assert!((1_499..=1_501).contains(&samples.len()), "{event:?}");
            assert_eq!(event.samples, samples.len());
        }
    }
}
