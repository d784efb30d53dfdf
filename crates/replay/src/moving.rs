//! What of a recording was judged while current, speed or supply changed, beside the windows at rest.

use monitor::{Channel, FaultId, Monitor, MonitorState, Moving, MovingCause, Report, Sample};
use motion::{Companion, MotionAlarm, MotionSample, Named, NotInMotion};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};
use std::collections::VecDeque;

use crate::{VerdictState, words};

/// Windows that are not at rest, and what motion says of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct MotionSummary {
    /// Why the motor is not judged in motion at all.
    pub not_possible: Option<String>,
    /// Windows that were not judged at rest because something was changing.
    pub windows: u64,
    /// How many of them were judged in motion.
    pub judged: u64,
    /// Why the others were not, most frequent first.
    pub not_judged: Vec<MotionShare>,
    /// Alarms that came while something was changing, in the order of time.
    pub alarms: Vec<MotionFault>,
    /// What does not fit the model: a fault of no size that occurs, a speed channel that lags, an effect that the motor file lacks; of a
    /// motor that was never seen in motion in good order, every alarm but a dead sensor's. No FAULT, and nothing is called healthy.
    pub unexplained: Vec<MotionFault>,
}

/// How many windows one reason kept from being judged in motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MotionShare {
    /// The reason in words.
    pub reason: &'static str,
    /// Windows.
    pub windows: u64,
}

/// An alarm in motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MotionFault {
    /// When the statistic left the noise, s: about when the fault showed first.
    pub onset_s: f64,
    /// When FAULT was raised, s.
    pub raised_s: f64,
    /// Statistic of the likeliest cause; a healthy motor's stays below the limit.
    pub statistic: f64,
    /// The cause in words; `null` where the motion ended before it could be told, and where no fault of a size that occurs is one.
    #[serde(serialize_with = "in_words")]
    #[schemars(with = "Option<String>")]
    pub cause: Option<MovingCause>,
}

impl MotionFault {
    /// Of what does not fit: what is known of it, and what it may be.
    pub fn doubt(&self) -> String {
        match self.words() {
            Some(cause) => format!("it looks like {cause}, but {}", words::NEVER_SEEN_IN_MOTION),
            None => format!(
                "no fault of a size that occurs explains it. It may be {}",
                words::UNEXPLAINED
            ),
        }
    }

    /// The cause in words; `None` where it could not be told, or no fault of a size that occurs is one.
    pub fn words(&self) -> Option<String> {
        self.cause.map(motion_cause)
    }

    /// The fault that is the cause; `None` as in [`MotionFault::words`].
    pub fn fault(&self) -> Option<FaultId> {
        match self.cause? {
            MovingCause::Dead(finding) => Some(Channel::of(finding).row),
            MovingCause::Departure(cause) => Some(cause.fault()),
        }
    }
}

fn in_words<S: Serializer>(cause: &Option<MovingCause>, serializer: S) -> Result<S::Ok, S::Error> {
    cause.map(motion_cause).serialize(serializer)
}

/// Judges in motion beside the windows at rest.
pub struct Follower {
    companion: Companion,
    times: RecentTimes,
    /// Number and time of the sample with which the statistic left the noise, s.
    restless: Option<(u64, f64)>,
    summary: MotionSummary,
}

/// The times of the latest samples, s.
#[derive(Clone, Debug, Default)]
struct RecentTimes {
    times: VecDeque<f64>,
    most: usize,
    /// Samples that came before the ones that are kept.
    before: u64,
}

impl RecentTimes {
    fn push(&mut self, t: f64) {
        if self.times.len() == self.most {
            self.times.pop_front();
            self.before += 1;
        }
        self.times.push_back(t);
    }

    /// Of a sample counted from 1; the oldest one that is kept stands for those before it.
    fn of(&self, sample: u64) -> f64 {
        let k = sample.saturating_sub(1).saturating_sub(self.before);
        let k = usize::try_from(k).unwrap_or(usize::MAX);
        self.times.get(k).copied().unwrap_or_default()
    }
}

impl MotionSummary {
    /// Nothing was judged in motion, for this reason.
    pub(crate) fn impossible(why: &str) -> Self {
        MotionSummary {
            not_possible: Some(why.to_owned()),
            ..MotionSummary::default()
        }
    }

    /// Takes alarms as what does not fit, in the order of time.
    fn doubt(&mut self, alarms: Vec<MotionFault>) {
        self.unexplained.extend(alarms);
        self.unexplained
            .sort_by(|a, b| a.raised_s.total_cmp(&b.raised_s));
    }

    /// What a recording comes to whose windows at rest come to `at_rest`: FAULT at rest or in motion; healthy where either was judged and
    /// neither lit; not judged where something came in motion that no fault explains, or where FAULT was raised at rest of which no
    /// window could be judged.
    pub(crate) fn state_with(&self, at_rest: VerdictState, raised_at_rest: bool) -> VerdictState {
        match at_rest {
            VerdictState::Fault => VerdictState::Fault,
            _ if self.is_fault() => VerdictState::Fault,
            _ if !self.unexplained.is_empty() => VerdictState::NotJudged,
            VerdictState::NotJudged if self.is_healthy() && !raised_at_rest => {
                VerdictState::Healthy
            }
            state => state,
        }
    }

    /// Whether an alarm came in motion.
    pub fn is_fault(&self) -> bool {
        !self.alarms.is_empty()
    }

    /// Whether something was judged in motion, and all of it fits.
    pub fn is_healthy(&self) -> bool {
        self.judged > 0 && self.alarms.is_empty() && self.unexplained.is_empty()
    }
}

impl Follower {
    /// For a monitor of this configuration.
    pub fn new(monitor: &Monitor) -> Self {
        let companion = Companion::of_samples(monitor.config());
        let why = companion.not_possible();
        Follower {
            times: RecentTimes {
                // What is asked for lies a cycle back.
                most: companion.cycle_samples() + 1,
                ..RecentTimes::default()
            },
            restless: None,
            summary: why.map_or_else(MotionSummary::default, |why| {
                MotionSummary::impossible(&why.to_string())
            }),
            companion,
        }
    }

    /// Judges nothing in motion from here on, for this reason.
    pub fn stop(&mut self, why: &str) {
        if !self.is_stopped() {
            self.summary = MotionSummary::impossible(why);
        }
    }

    fn is_stopped(&self) -> bool {
        self.summary.not_possible.is_some()
    }

    /// Samples are missing before the next one.
    pub fn resume_after_gap(&mut self) {
        self.companion.resume_after_gap();
    }

    /// Takes a sample that `monitor` has just taken.
    pub fn update(&mut self, t: f64, sample: &Sample, monitor: &MonitorState) {
        if self.is_stopped() {
            return;
        }
        self.times.push(t);
        let supply = monitor.supply();
        let sample = *sample;
        let Some(cycle) = self.companion.take_sample(&MotionSample { sample, supply }) else {
            return;
        };
        let since = self.companion.restless_since();
        if since != self.restless.map(|(sample, _)| sample) {
            self.restless = since.map(|sample| (sample, self.times.of(sample)));
        }
        if let Some(alarm) = cycle.alarm.filter(|_| self.companion.counts()) {
            self.note(&alarm);
        }
    }

    /// Takes the window that the sample ended. Of one that is not at rest: whether it was judged in motion.
    pub fn window(&mut self, report: &Report) -> Option<bool> {
        if self.is_stopped() {
            return None;
        }
        let judged = self.companion.judged(report)?;
        self.summary.windows += 1;
        match judged {
            Ok(()) => self.summary.judged += 1,
            Err(reason) => self.count(reason),
        }
        Some(judged.is_ok())
    }

    /// What is said in motion with the latest window; `None` where nothing is judged in motion.
    pub fn moving(&self) -> Option<Moving> {
        self.companion.moving().filter(|_| !self.is_stopped())
    }

    fn count(&mut self, reason: NotInMotion) {
        let reason = words::not_in_motion(reason);
        let shares = &mut self.summary.not_judged;
        match shares.iter_mut().find(|share| share.reason == reason) {
            Some(share) => share.windows += 1,
            None => shares.push(MotionShare { reason, windows: 1 }),
        }
    }

    fn note(&mut self, alarm: &MotionAlarm) {
        let time = |sample: u64| match self.restless {
            Some((since, t)) if since == sample => t,
            _ => self.times.of(sample),
        };
        let Some(named) = alarm.named else {
            self.summary.alarms.push(MotionFault {
                onset_s: time(alarm.onset_sample),
                raised_s: time(alarm.raised_sample),
                statistic: f64::from(alarm.statistic),
                cause: None,
            });
            return;
        };
        let Some(mut fault) = self.summary.alarms.pop() else {
            return;
        };
        fault.statistic = f64::from(alarm.statistic);
        match named {
            Named::Untold => self.summary.unexplained.push(fault),
            Named::Fault(found) => {
                fault.cause = Some(found.cause);
                self.summary.alarms.push(fault);
            }
        }
    }

    /// What the whole recording came to.
    pub fn finish(mut self) -> MotionSummary {
        let shares = &mut self.summary.not_judged;
        shares.sort_by_key(|share| (std::cmp::Reverse(share.windows), share.reason));
        if self.summary.not_possible.is_some() {
            shares.clear();
        }
        if self.companion.is_doubted() {
            let is_dead = |alarm: &MotionFault| matches!(alarm.cause, Some(MovingCause::Dead(_)));
            let alarms = std::mem::take(&mut self.summary.alarms);
            let (sure, doubts) = alarms.into_iter().partition(is_dead);
            self.summary.alarms = sure;
            self.summary.doubt(doubts);
        }
        self.summary
    }
}

fn motion_cause(cause: MovingCause) -> String {
    match cause {
        MovingCause::Dead(finding) => words::sensor(finding),
        MovingCause::Departure(cause) => {
            let phase = cause
                .phase()
                .map_or(String::new(), |phase| format!(", phase {}", phase.letter()));
            format!("{}{phase}", cause.fault().words())
        }
    }
}

#[cfg(test)]
mod tests {
    use audit::{Expectation, audit};
    use formats::read_recording;
    use monitor::Monitor;
    use motor::MotorFile;
    use recording::{Channel, Mapping};

    use crate::{MotionSummary, Samples, config_for, replay};

    fn moved(recording: &str, motor: &str) -> MotionSummary {
        moved_late(recording, motor, 0)
    }

    /// The speed is the mean of so many samples, as a counter or a filter shows it: late by half of them.
    fn moved_late(recording: &str, motor: &str, samples: usize) -> MotionSummary {
        let mean = |speed: &[f64], k: usize| {
            let seen = &speed[k.saturating_sub(samples)..=k];
            seen.iter().sum::<f64>() / seen.len() as f64
        };
        moved_as(recording, motor, |speed| {
            (0..speed.len()).map(|k| mean(speed, k)).collect()
        })
    }

    /// The speed as an instrument shows it.
    fn moved_as(recording: &str, motor: &str, shown: impl Fn(&[f64]) -> Vec<f64>) -> MotionSummary {
        let motor = MotorFile::read(format!("../../motors/{motor}.toml")).expect("it ships");
        let file = format!("../../tests/data/peer/{recording}.csv.gz");
        let recording = read_recording(file.as_ref(), &Mapping::default(), &mut |_| {});
        let mut recording = recording.expect("readable");
        let late = shown(recording.speed().expect("measured"));
        recording = recording
            .with_channel(Channel::SPEED, late)
            .expect("as long");
        let config = config_for(&motor, &recording).expect("effects of the library");
        let monitor = Monitor::new(config).expect("a valid configuration");
        let audit = audit(&recording, &Expectation::from(&motor));
        replay(&monitor, &Samples::new(&recording, &audit), &mut |_| {}).motion
    }

    /// Recordings of another simulator, with its converter and its load steps: a healthy motor whose file is right is
    /// judged in motion, and nothing is called a fault; one whose iron saturates neither, where the file knows it.
    #[test]
    fn healthy_recordings_of_another_simulator_are_judged_in_motion_without_an_alarm() {
        let linear = "peer-2k2-calibrated";
        let cases = [
            ("none/recording", linear),
            ("none/recording_b", linear),
            ("supply-unbalance/recording", linear),
            (
                "magnetizing-saturation/recording",
                "peer-2k2-saturating-calibrated",
            ),
        ];
        for (recording, motor) in cases {
            let motion = moved(recording, motor);
            assert!(motion.alarms.is_empty(), "{recording}: {motion:?}");
            assert!(5 * motion.judged > 4 * motion.windows, "{motion:?}");
        }
    }

    /// In a start and in load steps a speed that lags by 5 to 25 ms contradicts the currents. No fault is named for it.
    #[test]
    fn a_speed_that_lags_is_no_fault() {
        for samples in [100, 200, 500] {
            for recording in ["none/recording", "none/recording_b"] {
                let motion = moved_late(recording, "peer-2k2-calibrated", samples);
                assert!(!motion.is_fault(), "{samples} {recording}: {motion:?}");
            }
        }
    }

    /// A counter shows the edges of each window of 5 ms until the next one is over: such a speed jumps when it changes, late. Nothing is judged in motion
    /// then; one that is refreshed every half millisecond is as good as one that is not.
    #[test]
    fn a_speed_that_is_held_is_not_judged_in_motion() {
        let held = |rows: usize| {
            moved_as("none/recording", "peer-2k2-calibrated", |speed| {
                let window = |k: usize| (k / rows).saturating_sub(1) * rows;
                let mean = |k: usize| {
                    let seen = &speed[window(k)..window(k) + rows];
                    seen.iter().sum::<f64>() / seen.len() as f64
                };
                (0..speed.len()).map(mean).collect()
            })
        };
        let motion = held(100);
        let why = motion.not_possible.expect("a reason");
        assert!(why.contains("held"), "{why}");
        assert_eq!((motion.judged, motion.alarms.len()), (0, 0));
        let motion = held(10);
        assert!(motion.not_possible.is_none() && motion.judged > 0 && !motion.is_fault());
    }

    /// A motor file that knows nothing of the saturation, or of one that is not there, is another motor.
    #[test]
    fn a_wrong_motor_file_is_seen_in_motion_too() {
        for (recording, motor) in [
            ("magnetizing-saturation/recording_b", "peer-2k2-calibrated"),
            ("none/recording", "peer-2k2-saturating-calibrated"),
        ] {
            let motion = moved(recording, motor);
            let all = motion.alarms.iter().chain(&motion.unexplained);
            let fault = all.min_by(|a, b| a.raised_s.total_cmp(&b.raised_s));
            let fault = fault.expect("an alarm");
            assert!(fault.onset_s <= fault.raised_s && fault.statistic > 6.5);
            assert!(!motion.is_healthy());
        }
    }

    #[test]
    fn without_a_calibration_nothing_is_judged_in_motion_and_it_says_why() {
        let motion = moved("none/recording", "peer-2k2");
        let why = motion.not_possible.expect("a reason");
        assert!(why.contains("not calibrated"), "{why}");
        assert_eq!((motion.judged, motion.alarms.len()), (0, 0));
    }
}
