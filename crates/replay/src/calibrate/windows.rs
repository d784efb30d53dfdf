//! The windows of healthy recordings that a calibration learns from.

use std::collections::BTreeMap;

use audit::{Audit, Expectation, Merger, audit};
use monitor::{Healthy, Monitor, MonitorConfig, MonitorState, Report, Window};
use motor::MotorFile;
use recording::Recording;

use super::pieces::Pieces;
use super::{Refusal, configured};
use crate::samples::{Before, Samples};
use crate::timeline::Thinned;
use crate::{Replay, Timeline, words};

/// One steady window.
#[derive(Clone, Copy, Debug)]
pub struct Observed {
    /// Which recording, in the order given.
    pub recording: usize,
    /// End of the window, s.
    pub t: f64,
    /// What it measured.
    pub window: Window,
    /// Votes: windows of the same load and voltage share a few, as they share their systematic errors.
    pub weight: f64,
}

/// A recording with its audit.
pub struct Healthily<'r> {
    pieces: &'r dyn Pieces,
    /// What the audit found.
    pub audit: Audit,
    /// Those of the pieces, where they may be used.
    of_pieces: Vec<Option<Audit>>,
    /// The first samples, with the sampling time of the first piece.
    head: Recording,
}

/// Fewest steady windows: one second at 50 Hz.
const FEWEST: usize = 50;

/// Audits recordings; refuses those that cannot be used.
///
/// # Errors
/// A recording that the audit refuses.
pub fn audited<'r>(
    recordings: &[&'r dyn Pieces],
    motor: &MotorFile,
) -> Result<Vec<Healthily<'r>>, Refusal> {
    let expectation = Expectation::from(motor);
    let recordings = recordings.iter();
    recordings
        .map(|one| Healthily::new(*one, &expectation))
        .collect()
}

/// The steady windows of all recordings under `motor`.
///
/// # Errors
/// A finding about a sensor, too few steady windows, or values that the core does not take.
pub fn observe(sources: &[Healthily<'_>], motor: &MotorFile) -> Result<Vec<Observed>, Refusal> {
    let mut all = Vec::new();
    let mut reasons = Reasons::new();
    for (k, source) in sources.iter().enumerate() {
        observe_one(k, source, motor, &mut all, &mut reasons)?;
    }
    if all.len() < FEWEST {
        return Err(too_few(sources, all.len(), &reasons));
    }
    share_votes(&mut all);
    Ok(all)
}

/// Why windows were passed over, and how many for each reason.
type Reasons = BTreeMap<String, usize>;

fn too_few(sources: &[Healthily<'_>], windows: usize, reasons: &Reasons) -> Refusal {
    let names: Vec<&str> = sources.iter().map(|s| s.name()).collect();
    let most = reasons.iter().max_by_key(|(_, count)| **count);
    let passed_over = most.map_or_else(String::new, |(reason, count)| {
        format!(" ({count} are not: {reason})")
    });
    let reason = format!(
        "only {windows} steady windows{passed_over}, {FEWEST} are needed: record voltages, currents and speed for at least one \
         second of constant load"
    );
    Refusal::new(&names.join(", "), reason)
}

fn observe_one(
    k: usize,
    source: &Healthily<'_>,
    motor: &MotorFile,
    all: &mut Vec<Observed>,
    reasons: &mut Reasons,
) -> Result<(), Refusal> {
    let mut config = configured(motor, source.head())?;
    config.healthy = Some(Healthy::unknown());
    let name = source.name();
    let mut observed = Thinned::default();
    source.monitored(config, &mut |t, report| {
        refuse_sensor(name, t, report)?;
        if let Some(reason) = report.not_judged {
            *reasons.entry(words::not_judged(reason)).or_default() += 1;
        }
        if let (None, Some(window)) = (report.not_judged, report.window) {
            observed.push(Observed {
                recording: k,
                t,
                window,
                weight: 1.0,
            });
        }
        Ok(())
    })?;
    all.extend_from_slice(&observed);
    Ok(())
}

impl<'r> Healthily<'r> {
    fn new(pieces: &'r dyn Pieces, expectation: &Expectation) -> Result<Healthily<'r>, Refusal> {
        let (mut merger, mut of_pieces, mut head) = (Merger::default(), Vec::new(), None);
        pieces.each(&mut |piece| {
            let audit = audit(piece, expectation);
            let is_usable = merger.add(piece, &audit);
            of_pieces.push(Some(audit).filter(|_| is_usable));
            head = head.take().or_else(|| {
                let head = piece.slice(0..2).ok()?;
                Some(head.with_t_sample(piece.t_sample()))
            });
            Ok(())
        })?;
        let audit = merger.finish();
        match head.filter(|_| audit.supported) {
            Some(head) => Ok(Healthily {
                pieces,
                audit,
                of_pieces,
                head,
            }),
            None => {
                let detail = audit.findings.iter().map(|f| f.detail.clone());
                let detail = detail.collect::<Vec<_>>().join("; ");
                Err(Refusal::new(pieces.name(), detail))
            }
        }
    }

    /// The recording's name.
    pub fn name(&self) -> &str {
        self.pieces.name()
    }

    /// The first samples, with what is known of the whole.
    pub fn head(&self) -> &Recording {
        &self.head
    }

    /// What the recording comes to.
    ///
    /// # Errors
    /// Values that the core does not take, and a file that can be read no more.
    pub fn replayed(&self, config: MonitorConfig) -> Result<Timeline, Refusal> {
        let refused = |error: monitor::ConfigError| Refusal::new(self.name(), error.to_string());
        let mut replay = Replay::new(Monitor::new(config).map_err(refused)?);
        let mut audits = self.of_pieces.iter();
        self.pieces.each(&mut |piece| {
            if let Some(Some(audit)) = audits.next() {
                replay.take(Samples::new(piece, audit), &mut |_| {});
            }
            Ok(())
        })?;
        Ok(replay.finish())
    }

    /// Sends the recording through the core; `look` takes the time, s, and each report.
    ///
    /// # Errors
    /// What `look` refuses, and values that the core does not take.
    pub fn monitored(
        &self,
        config: MonitorConfig,
        look: &mut dyn FnMut(f64, &Report) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let refused = |error: monitor::ConfigError| Refusal::new(self.name(), error.to_string());
        let monitor = Monitor::new(config).map_err(refused)?;
        let mut state = MonitorState::default();
        let mut audits = self.of_pieces.iter();
        let mut before: Option<Before> = None;
        self.pieces.each(&mut |piece| {
            let Some(Some(audit)) = audits.next() else {
                return Ok(());
            };
            let samples = Samples::new(piece, audit);
            let samples = before.map_or(samples, |before| samples.continuing(before));
            before = samples.end();
            for timed in samples.iter() {
                if timed.after_gap {
                    state.resume_after_gap();
                }
                if let Some(report) = monitor.update(&mut state, &timed.sample) {
                    look(timed.t, &report)?;
                }
            }
            Ok(())
        })
    }
}

fn refuse_sensor(name: &str, t: f64, report: &Report) -> Result<(), Refusal> {
    match report.sensor {
        Some(finding) => Err(Refusal::new(
            name,
            format!(
                "at {t:.3} s: {}; a motor is calibrated with sound sensors",
                words::sensor(finding)
            ),
        )),
        None => Ok(()),
    }
}

/// Steps of current and voltage within which windows share one vote.
const BAND: f64 = 0.1;

/// Windows overlap: so many of them hold the noise of one.
const OVERLAP: f64 = 5.0;
/// Votes of a band at most: noise averages out, what is wrong with a model at this load does not.
const MOST_VOTES: f64 = 6.0;

fn share_votes(all: &mut [Observed]) {
    let largest = |of: &dyn Fn(&Window) -> f32| {
        all.iter()
            .map(|o| f64::from(of(&o.window)))
            .fold(f64::MIN_POSITIVE, f64::max)
    };
    let current = |w: &Window| monitor::magnitude(w.i_s.positive);
    let voltage = |w: &Window| monitor::magnitude(w.u_s.positive);
    let (i, u) = (largest(&current), largest(&voltage));
    let band = |o: &Observed| {
        let step = |x: f32, scale: f64| (f64::from(x) / scale / BAND).round() as i64;
        (step(current(&o.window), i), step(voltage(&o.window), u))
    };
    let mut votes = BTreeMap::<_, f64>::new();
    for observed in all.iter() {
        *votes.entry(band(observed)).or_default() += 1.0;
    }
    for observed in all.iter_mut() {
        let windows = votes[&band(observed)];
        observed.weight = (windows / OVERLAP).clamp(1.0, MOST_VOTES) / windows;
    }
}
