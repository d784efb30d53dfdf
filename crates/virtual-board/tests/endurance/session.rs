//! From a start of the board to the next.

use std::collections::VecDeque;

use board::{Frame, LAMP_NAMES, Message, Shown};
use monitor::{Lamp, Monitor, MonitorConfig, MonitorState, RawSample, Report};
use motion::Companion;

use super::common::INHIBITED;
use super::outside::{LAG_S, is_faulty};
use super::watch::{Counts, SAMPLES_PER_SECOND};

/// The sampling clock against the supply's: a window is a cycle of 60 Hz.
const SAMPLES_PER_FRAME: f64 = SAMPLES_PER_SECOND / 60.0;
/// Two windows and a block: what a frame may be behind the converter.
const FRAME_LAG: u64 = 2 * 167 + 32;
/// Two blocks, in one of which the first sample of a start comes: what samples may differ from the time that passed.
const CLOCK_LAG: f64 = 200.0;

/// The host's core on the samples of one start, and the frames that have come since.
pub struct Session {
    monitor: Monitor,
    state: MonitorState,
    companion: Companion,
    /// Samples before this start.
    before: u64,
    samples: u64,
    /// Emulated time of the first look that found samples, and how many those were.
    began: Option<(f64, u64)>,
    latest_s: f64,
    /// What the board's frames are still to say.
    reports: VecDeque<Report>,
    /// Bytes of a frame that is under way.
    rest: Vec<u8>,
    frames: u32,
    sample_index: u64,
}

impl Session {
    pub fn new(config: &MonitorConfig, before: u64) -> Self {
        let monitor = Monitor::new(*config).expect("a valid configuration");
        let companion = Companion::new(monitor.config());
        Session {
            monitor,
            state: MonitorState::default(),
            companion,
            before,
            samples: 0,
            began: None,
            latest_s: 0.0,
            reports: VecDeque::new(),
            rest: Vec::new(),
            frames: 0,
            sample_index: 0,
        }
    }

    /// What the host says of samples that had come at `now_s`.
    pub fn judge(&mut self, taken: &[RawSample], now_s: f64) {
        if !taken.is_empty() {
            self.began = self.began.or(Some((now_s, taken.len() as u64)));
            self.latest_s = now_s;
        }
        for raw in taken {
            self.samples += 1;
            if self.samples > INHIBITED as u64 {
                let beside = &mut self.companion;
                let report = self.monitor.update_raw_beside(&mut self.state, raw, beside);
                self.reports.extend(report);
            }
        }
    }

    /// Bytes from the line; `now`: samples so far, and the motor's time at the last of them, s.
    pub fn take(&mut self, bytes: impl Iterator<Item = u8>, now: (u64, f64), counts: &mut Counts) {
        self.rest.extend(bytes);
        while let Some(end) = self.rest.iter().position(|byte| *byte == 0) {
            let bytes: Vec<u8> = self.rest.drain(..=end).collect();
            if let Message::Window(frame) = Message::decode(&bytes).expect("an undamaged frame") {
                self.frame(&frame);
                self.judge_lamp(&frame, now, counts);
            }
        }
        let behind = now.0.checked_sub(self.told());
        assert!(
            self.frames == 0 || behind.is_some_and(|behind| behind <= FRAME_LAG),
            "stamped {} when {} instants were taken",
            self.told(),
            now.0
        );
    }

    /// The sample, of all, at the end of the latest frame's window.
    fn told(&self) -> u64 {
        self.before + self.sample_index + INHIBITED as u64
    }

    /// The next one, the host's bit for bit, a cycle behind the last.
    fn frame(&mut self, frame: &Frame) {
        let report = self.reports.pop_front().expect("a report of the host");
        let shown = Shown::only(report.shown_lamps());
        let expected = Frame::new(&report, &shown, self.frames, frame.vdda_millivolt);
        assert_eq!(frame, &expected, "board and host");
        self.frames += 1;
        let samples = frame.sample_index - self.sample_index;
        // The first frames come before the supply is found.
        let searching = self.frames <= 10;
        assert!(
            searching || (160..=174).contains(&samples),
            "{samples} samples in a window: {frame:?}"
        );
        self.sample_index = frame.sample_index;
    }

    fn judge_lamp(&self, frame: &Frame, now: (u64, f64), counts: &mut Counts) {
        counts.frames += 1;
        let since_start_s = frame.sample_index as f64 / SAMPLES_PER_SECOND;
        let t = now.1 - (now.0 as f64 - self.told() as f64) / SAMPLES_PER_SECOND;
        let lamp = LAMP_NAMES.iter().position(|name| *name == "fault");
        let lit = frame.lamp(lamp.expect("a lamp")) == Lamp::On;
        if let Some(faulty) = is_faulty(t).filter(|_| since_start_s > LAG_S) {
            assert_eq!(lit, faulty, "FAULT at {t} s: {frame:?}");
            counts.faulty += u32::from(faulty);
            counts.healthy += u32::from(!faulty);
        }
    }

    /// A frame for every cycle; what is under way at the end does not count.
    pub fn assert_whole(&self) {
        let (began_s, first) = self.began.expect("samples");
        let passed = (self.latest_s - began_s) * SAMPLES_PER_SECOND;
        let taken = (self.samples - first) as f64;
        assert!((taken - passed).abs() < CLOCK_LAG, "{taken} of {passed}");
        let judged = self.samples.saturating_sub(INHIBITED as u64) as f64;
        let expected = judged / SAMPLES_PER_FRAME;
        let frames = f64::from(self.frames);
        assert!(
            (frames - expected).abs() < 20.0,
            "{frames} frames of {expected}"
        );
        assert!(self.reports.len() <= 3, "{} were lost", self.reports.len());
    }
}
