//! What a whole recording came to: lamp changes, verdict, sequence components.

mod beyond;
mod sequences;
mod thinned;
mod trace;

use audit::Finding;
use monitor::{
    Beyond, Candidates, Channel, FAULTS, Heating, Known, Lamp, Lamps, LoadKind, MonitorConfig,
    NotJudged, Report, Witness,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::alarm_causes::Causes;
use crate::causes::{self, Candidate};
use crate::judgement::{Direction, NotJudgedShare, Reasons, Unjudged};
use crate::moving::MotionSummary;
use crate::rotor::{RotorHistory, RotorSummary};
pub use beyond::BeyondCalibration;
pub use sequences::SequenceSummary;
use sequences::Sequences;
pub(crate) use thinned::Thinned;
pub use trace::{Trace, WindowOperation, WindowResiduals};

/// The lamps from one moment on.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LampState {
    /// Time of the recording, s.
    pub t: f64,
    /// RUN.
    #[serde(with = "LampWord")]
    pub run: Lamp,
    /// Residual r1.
    #[serde(with = "LampWord")]
    pub r1: Lamp,
    /// Residual r2.
    #[serde(with = "LampWord")]
    pub r2: Lamp,
    /// Residual r3.
    #[serde(with = "LampWord")]
    pub r3: Lamp,
    /// Residual r4.
    #[serde(with = "LampWord")]
    pub r4: Lamp,
    /// SENSOR.
    #[serde(with = "LampWord")]
    pub sensor: Lamp,
    /// LINE.
    #[serde(with = "LampWord")]
    pub line: Lamp,
    /// LOAD.
    #[serde(with = "LampWord")]
    pub load: Lamp,
    /// FAULT.
    #[serde(with = "LampWord")]
    pub fault: Lamp,
    /// Why the window at this moment was not judged.
    #[schemars(with = "Option<String>")]
    pub not_judged: Option<Unjudged>,
}

/// The outcome in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictState {
    /// Judged, and FAULT never lit.
    Healthy,
    /// FAULT lit.
    Fault,
    /// No window could be judged.
    NotJudged,
}

/// Verdict over the whole recording.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Verdict {
    /// The outcome.
    pub state: VerdictState,
    /// Possible causes, likeliest first.
    pub candidates: Vec<Candidate>,
    /// How many of them, from the first, this recording cannot tell apart ([`monitor::TIE_RATIO`]); 1 where the first stands alone.
    pub tied: usize,
    /// What would tell them apart; empty without a tie.
    pub separating_tests: Vec<&'static str>,
}

impl Verdict {
    /// Whether the likeliest cause has a size, which follows from the motor's parameters.
    pub(crate) fn rests_on_parameters(&self) -> bool {
        let first = self.candidates.first();
        first.is_some_and(|first| first.size_percent.is_some())
    }

    fn new(state: VerdictState, candidates: Vec<Candidate>) -> Self {
        let tied = causes::tied(&candidates);
        let separating_tests = match tied {
            0 | 1 => Vec::new(),
            _ => causes::tests(&candidates[..tied]),
        };
        Verdict {
            state,
            candidates,
            tied,
            separating_tests,
        }
    }
}

/// Residuals over the judged windows, percent of their scales.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    windows: u64,
    sum: [f64; 4],
    square: [f64; 4],
}

/// A motor of which less than the fifth part of its running was judged is not called healthy.
const LEAST_SHARE: u64 = 5;
/// No window tells the rise of a resistance more surely, a share: its weight stays finite.
const LEAST_DEVIATION: f64 = 1e-3;

/// Changes of the lamps that are kept.
pub const MOST_CHANGES: usize = 10_000;

/// The collected result of a replay.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    /// Windows reported.
    pub windows: u64,
    /// Windows judged.
    pub judged: u64,
    /// Lamps at every change, up to a bound that keeps memory constant (`further_changes` counts the rest).
    pub lamps: Vec<LampState>,
    /// Changes of the lamps beyond those.
    pub further_changes: u64,
    /// Time of the first FAULT, s.
    pub first_alarm_s: Option<f64>,
    /// Why windows were not judged, most frequent first.
    pub not_judged: Vec<NotJudgedShare>,
    /// The windows in the order of time, thinned out where they are many.
    pub trace: Trace,
    /// What was judged while something changed.
    pub motion: MotionSummary,
    /// Judged windows beyond what the calibration saw.
    pub beyond: BeyondCalibration,
    reasons: Reasons,
    shown: Option<(Lamps, Option<NotJudged>)>,
    moments: Moments,
    /// Residuals that would have lit their lamps, percent of scale, summed up over the windows that had any.
    visible_sum: [f64; 4],
    visible_windows: u64,
    candidate_sum: [f64; FAULTS],
    unknown_sum: f64,
    candidate_windows: u64,
    /// Channels that windows since the alarm found wrong, and how many windows did.
    found: Vec<(Channel, u64)>,
    /// Whether one of them was dead.
    names_a_dead_sensor: bool,
    since_alarm: u64,
    /// Of these such with currents that are unbalanced further than the supply makes them.
    unbalanced: u64,
    sequences: Sequences,
    /// Windows in which the field turned forwards and backwards.
    turned: [u64; 2],
    causes: Causes,
    rotor: RotorHistory,
    rated_current: f32,
    load_friction: bool,
    /// Resistance rise of the judged windows of a calibrated motor, weighed by how surely each tells it, and the weights.
    heating_sum: f64,
    heating_weight: f64,
}

impl Timeline {
    /// For a monitor of this configuration.
    pub fn new(config: &MonitorConfig) -> Self {
        Timeline {
            rated_current: config.rated_current,
            load_friction: config.load == LoadKind::Friction,
            causes: Causes::new(config.load != LoadKind::Free),
            ..Timeline::default()
        }
    }

    /// Adds one report; `t` is the time of the window's end, s.
    pub fn add(&mut self, t: f64, report: &Report) {
        self.windows += 1;
        if let Some(window) = &report.window {
            self.turned[usize::from(window.backwards)] += 1;
        }
        self.note_visible(report);
        self.note_judgement(report);
        self.note_lamps(t, report);
        self.rotor.add(&report.rotor);
        self.note_causes(t, report);
        self.sequences.add(t, report);
        self.trace.add(t, report);
    }

    /// Adds how far a judged window lies beyond the calibration.
    pub fn add_beyond(&mut self, beyond: &Beyond) {
        self.beyond.add(beyond);
    }

    /// Sorts what has been collected.
    pub fn finish(&mut self) {
        self.not_judged = std::mem::take(&mut self.reasons).ranked();
    }

    /// Says that the residuals lack the motor's parameters rather than its speed.
    pub fn blame_missing_motor_file(&mut self) {
        self.motion.not_possible = Some(Unjudged::NoMotorFile.to_string());
        let no_speed = Unjudged::ByCore(NotJudged::NoSpeed);
        let in_shares = self.not_judged.iter_mut().map(|share| &mut share.reason);
        let in_lamps = self.lamps.iter_mut();
        let in_lamps = in_lamps.filter_map(|lamps| lamps.not_judged.as_mut());
        for reason in in_shares.chain(in_lamps).filter(|why| **why == no_speed) {
            *reason = Unjudged::NoMotorFile;
        }
    }

    fn note_visible(&mut self, report: &Report) {
        let steady = matches!(report.not_judged, None | Some(NotJudged::Noise));
        let Some(visible) = report.visible.filter(|_| steady) else {
            return;
        };
        self.visible_windows += 1;
        for (sum, visible) in self.visible_sum.iter_mut().zip(visible) {
            *sum += 100.0 * f64::from(visible);
        }
    }

    /// Residuals that light their lamps, percent of scale: thresholds with what noise and changes do, the mean over the
    /// steady windows.
    pub fn visible_percent(&self) -> Option<[f64; 4]> {
        let n = self.visible_windows as f64;
        (self.visible_windows > 0).then(|| self.visible_sum.map(|sum| sum / n))
    }

    fn note_judgement(&mut self, report: &Report) {
        if let Some(reason) = report.not_judged {
            self.reasons.add(reason);
            return;
        }
        self.judged += 1;
        if let Some(isolation) = &report.isolation {
            let Heating { rise, deviation } = isolation.heating;
            let weight = f64::from(deviation).max(LEAST_DEVIATION).powi(-2);
            self.heating_sum += weight * f64::from(rise);
            self.heating_weight += weight;
        }
        let Some(residuals) = report.residuals else {
            return;
        };
        self.moments.windows += 1;
        for (k, r) in residuals.r.iter().enumerate() {
            let percent = 100.0 * f64::from(*r);
            self.moments.sum[k] += percent;
            self.moments.square[k] += percent * percent;
        }
    }

    fn note_lamps(&mut self, t: f64, report: &Report) {
        let now = (report.shown_lamps(), report.not_judged);
        if self.shown != Some(now) {
            self.shown = Some(now);
            match self.lamps.len() < MOST_CHANGES {
                true => self.lamps.push(lamp_state(t, report)),
                false => self.further_changes += 1,
            }
        }
    }

    fn note_causes(&mut self, t: f64, report: &Report) {
        let alarm = report.lamps.fault == Lamp::On;
        if alarm && self.first_alarm_s.is_none() {
            self.first_alarm_s = Some(t);
        }
        if self.first_alarm_s.is_none() {
            return;
        }
        self.since_alarm += 1;
        self.unbalanced += u64::from(report.is_unbalanced);
        if let Some(candidates) = &report.candidates {
            self.add_candidates(candidates);
        }
        // Bars shake every window: what a window says of other causes is then not asked.
        if alarm && report.is_judged() && !report.rotor.is_broken {
            self.causes.add(report, self.rated_current);
        }
        if let Some(finding) = report.sensor {
            self.names_a_dead_sensor |= finding.is_dead();
            self.add_found(Channel::of(finding));
        }
    }

    fn add_candidates(&mut self, candidates: &Candidates) {
        self.candidate_windows += 1;
        self.unknown_sum += f64::from(candidates.unknown);
        for (sum, p) in self.candidate_sum.iter_mut().zip(candidates.faults) {
            *sum += f64::from(p);
        }
    }

    fn add_found(&mut self, channel: Channel) {
        match self.found.iter_mut().find(|(known, _)| *known == channel) {
            Some((_, windows)) => *windows += 1,
            None => self.found.push((channel, 1)),
        }
    }

    /// Whether windows were not judged because current, speed or supply were changing.
    pub fn something_moved(&self) -> bool {
        let transient = Unjudged::ByCore(NotJudged::Transient);
        let mut reasons = self.not_judged.iter().map(|share| share.reason);
        reasons.any(|reason| reason == transient)
    }

    /// The verdict over everything added so far; `audit` is what is known of the recording's channels beforehand.
    pub fn verdict(&self, audit: &[Finding]) -> Verdict {
        let state = match (self.first_alarm_s, self.judged) {
            // A dead sensor and broken bars, which shake every window, are findings of their own; signals that merely contradict each
            // other, of which no window could be judged, are none.
            (Some(_), 0) if !self.names_a_dead_sensor && !self.rotor.is_broken() => {
                VerdictState::NotJudged
            }
            (Some(_), _) => VerdictState::Fault,
            (None, 0) => VerdictState::NotJudged,
            (None, _) => VerdictState::Healthy,
        };
        let candidates = self.first_alarm_s.map_or_else(Vec::new, |alarm_s| {
            self.candidates(&causes::wrong_channels(audit, [alarm_s, f64::INFINITY]))
        });
        Verdict::new(state, candidates)
    }

    /// What the recording comes to, at rest and in motion; healthy only where enough of the running motor was judged.
    pub fn state(&self, at_rest: VerdictState, motion: &MotionSummary) -> VerdictState {
        let raised_at_rest = self.first_alarm_s.is_some();
        match motion.state_with(at_rest, raised_at_rest) {
            VerdictState::Healthy if self.too_few(motion).is_some() => VerdictState::NotJudged,
            state => state,
        }
    }

    /// Windows judged, at rest and in motion, and windows of the running motor, where the former are too few for a dark answer.
    pub fn too_few(&self, motion: &MotionSummary) -> Option<[u64; 2]> {
        let judged = self.judged + motion.judged;
        let idle = self.not_judged.iter().filter(|share| share.is_idle());
        let running = self.windows - idle.map(|share| share.windows).sum::<u64>();
        (LEAST_SHARE * judged < running).then_some([judged, running])
    }

    /// Each window since the alarm that says something has one voice.
    fn candidates(&self, wrong: &[Channel]) -> Vec<Candidate> {
        let (witness, voices) = self.witness();
        let voices = voices + self.found.iter().map(|(_, windows)| windows).sum::<u64>();
        let share = |windows: u64| windows as f32 / voices.max(1) as f32;
        let found: Vec<_> = self
            .found
            .iter()
            .map(|(channel, windows)| (*channel, share(*windows)))
            .collect();
        let known = Known {
            found: &found,
            witness,
            wrong,
        };
        let mut candidates = causes::candidates(&known, self.load_friction);
        if self.rotor().is_suspected() {
            causes::suspect_bars(&mut candidates);
        }
        causes::listed(candidates)
    }

    /// What the windows without a finding say, and how many they are.
    fn witness(&self) -> (Witness, u64) {
        if self.rotor.is_broken() {
            let found: u64 = self.found.iter().map(|(_, windows)| windows).sum();
            (Witness::Bars, self.since_alarm.saturating_sub(found))
        } else if self.causes.windows() > 0 {
            (self.causes.witness(), self.causes.windows())
        } else if self.candidate_windows > 0 {
            (Witness::Table(self.table()), self.candidate_windows)
        } else if self.unbalanced > 0 {
            (Witness::Unbalance, self.unbalanced)
        } else {
            (Witness::None, 0)
        }
    }

    /// Mean over the windows.
    fn table(&self) -> Candidates {
        let mean = |sum: f64| (sum / self.candidate_windows.max(1) as f64) as f32;
        Candidates {
            faults: self.candidate_sum.map(mean),
            unknown: mean(self.unknown_sum),
        }
    }

    /// Relative rise of the resistances since the calibration, the mean over the judged windows, each weighed by how surely it tells it; `None`
    /// without one.
    pub fn resistance_rise(&self) -> Option<f64> {
        (self.heating_weight > 0.0).then(|| self.heating_sum / self.heating_weight)
    }

    /// What the sidebands of the current say about the rotor's bars.
    pub fn rotor(&self) -> RotorSummary {
        self.rotor.summary()
    }

    /// How the field turned; `None` without a complete window.
    pub fn direction(&self) -> Option<Direction> {
        match self.turned {
            [0, 0] => None,
            [_, 0] => Some(Direction::Forwards),
            [0, _] => Some(Direction::Backwards),
            _ => Some(Direction::Both),
        }
    }

    /// Mean sequence components.
    pub fn sequence(&self) -> SequenceSummary {
        self.sequences.summary()
    }

    /// Mean and standard deviation of r1..r4 over the judged windows, percent of scale; `None` where none could be computed.
    pub fn residual_percent(&self) -> Option<([f64; 4], [f64; 4])> {
        if self.moments.windows == 0 {
            return None;
        }
        let n = self.moments.windows as f64;
        let mean = self.moments.sum.map(|sum| sum / n);
        let mut deviation = self.moments.square.map(|square| square / n);
        for (square, mean) in deviation.iter_mut().zip(mean) {
            *square = (*square - mean * mean).max(0.0).sqrt();
        }
        Some((mean, deviation))
    }
}

/// A lamp.
#[derive(Serialize, JsonSchema)]
#[serde(remote = "Lamp", rename_all = "lowercase")]
enum LampWord {
    /// Dark.
    Off,
    /// Steady light.
    On,
    /// Slow blinking: waiting or not judged.
    Blink,
}

fn lamp_state(t: f64, report: &Report) -> LampState {
    let lamps = report.shown_lamps();
    let [r1, r2, r3, r4] = lamps.r;
    LampState {
        t,
        run: lamps.run,
        r1,
        r2,
        r3,
        r4,
        sensor: lamps.sensor,
        line: lamps.line,
        load: lamps.load,
        fault: lamps.fault,
        not_judged: report.not_judged.map(Unjudged::ByCore),
    }
}

#[cfg(test)]
mod tests;
