//! The board beside the host: its frames, in order, against what the host says of the samples that the board took.

use monitor::MonitorConfig;
use virtual_board::{Port, TICK_HZ, VirtualBoard};

use super::common::motor;
use super::outside::{FAULTY_S, HEALTHY_S, ROUND_S};
use super::session::Session;

pub const SAMPLES_PER_SECOND: f64 = 1e4;
/// Longest time without a sample that a start or an exchange of programs takes, s.
const PATIENCE_S: f64 = 40.0;

/// What was counted of frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub frames: u32,
    /// Frames in which FAULT had to be lit and was, had to be dark and was.
    pub faulty: u32,
    pub healthy: u32,
}

/// A board and everything that was seen of it.
pub struct Watch {
    pub board: VirtualBoard,
    config: MonitorConfig,
    session: Option<Session>,
    /// Emulated time of the first sample, s: the motor's clock begins there.
    origin_s: Option<f64>,
    /// Emulated time of the latest sample, s, and samples so far.
    sampled_s: f64,
    conversions: u64,
    resets: u64,
    /// Triggers that came while the board judged and its converter was not ready; of all, at the beginning of this session.
    missed: u64,
    missed_before: u64,
    counts: Counts,
}

impl Watch {
    pub fn new(board: VirtualBoard) -> Self {
        Watch {
            board,
            config: MonitorConfig::of_board(&motor()).expect("effects of the library"),
            session: None,
            origin_s: None,
            sampled_s: 0.0,
            conversions: 0,
            resets: 0,
            missed: 0,
            missed_before: 0,
            counts: Counts::default(),
        }
    }

    pub fn run(&mut self, seconds: f64) {
        self.board.run(seconds).expect("a run");
    }

    /// Emulated time since power-up, s.
    pub fn seconds(&mut self) -> f64 {
        self.board.tally().ticks as f64 / TICK_HZ as f64
    }

    /// Deepest use of the stack since the last start, bytes.
    pub fn stack(&mut self) -> u32 {
        self.board.stack_used().expect("a stack")
    }

    /// From the next start on the board judges with this.
    pub fn judge_with(&mut self, config: MonitorConfig) {
        self.config = config;
    }

    /// Waits for the first samples of a start.
    pub fn start(&mut self) {
        self.session = Some(Session::new(&self.config, self.conversions));
        self.missed_before = self.board.tally().missed_triggers;
        let (before, begun_s) = (self.conversions, self.seconds());
        while self.conversions == before {
            self.run(0.01);
            self.look();
            assert!(self.sampled_s.max(begun_s) + PATIENCE_S > self.seconds());
        }
        if self.origin_s.is_none() {
            let since = (self.conversions - before) as f64 / SAMPLES_PER_SECOND;
            self.origin_s = Some(self.sampled_s - since);
        }
    }

    /// Looks for the last time before a reset that is part of the story, or just behind it.
    pub fn end(&mut self) {
        self.look();
        self.ignore();
        self.resets += 1;
    }

    /// Samples and frames do not count until the next start.
    pub fn ignore(&mut self) {
        if let Some(session) = self.session.take() {
            session.assert_whole();
            self.missed += self.board.tally().missed_triggers - self.missed_before;
        }
    }

    /// Takes samples and frames, and compares them.
    pub fn look(&mut self) {
        let taken = self.board.drain_taken();
        let sent = self.board.take_sent(Port::Frames);
        self.conversions = self.board.tally().conversions;
        if !taken.is_empty() {
            self.sampled_s = self.seconds();
        }
        let origin_s = self.origin_s.unwrap_or(self.sampled_s);
        let Some(session) = &mut self.session else {
            return;
        };
        session.judge(&taken, self.sampled_s);
        let now = (self.conversions, self.sampled_s - origin_s);
        let bytes = sent.iter().map(|sent| sent.byte);
        session.take(bytes, now, &mut self.counts);
    }

    /// Everything that was promised, at the end.
    pub fn assert_whole(&mut self) {
        self.ignore();
        let tally = self.board.tally();
        let troubles = (self.missed, tally.resets);
        assert_eq!(troubles, (0, self.resets), "{tally:?}");
        let Counts {
            frames,
            faulty,
            healthy,
        } = self.counts;
        let share = |count: u32| f64::from(count) / f64::from(frames);
        assert!(
            share(faulty) > 0.9 * FAULTY_S / ROUND_S,
            "{faulty} {frames}"
        );
        assert!(share(healthy) > 0.9 * HEALTHY_S / ROUND_S, "{healthy}");
    }

    pub fn summary(&mut self) -> String {
        let (seconds, counts) = (self.seconds(), self.counts);
        format!(
            "{seconds:.0} s: {} frames, each as on the host, FAULT lit in {} and dark in {}; {} samples; {} starts",
            counts.frames,
            counts.faulty,
            counts.healthy,
            self.conversions,
            self.resets + 1
        )
    }
}
