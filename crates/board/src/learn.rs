//! Learning from a healthy motor: offsets of the channels, statistics of the residuals, and thresholds that follow from them.

use monitor::{CHANNELS, Lamp, MonitorConfig, NotJudged, RESIDUALS, Report};

use crate::calibration::{COVARIANCES, Calibration, ChannelTrim, Healthy};

/// Judged windows that a calibration rests on: ten seconds at 60 Hz.
pub const LEARN_WINDOWS: u32 = 600;
/// Windows, judged or not, after which learning gives up.
const MOST_WINDOWS: u32 = 2 * LEARN_WINDOWS;
/// Standard deviations between the healthy mean and the threshold. The comparators want several windows in a row, so
/// even scatter with tails far heavier than a normal distribution's lights nothing.
const DEVIATIONS: f32 = 6.0;
/// Smallest and largest learnt threshold as shares of the motor file's. Half: ten seconds show less than a year of
/// temperatures does. Four times: beyond that it is the model that is wrong, and a threshold would only hide it.
const SHARES: [f32; 2] = [0.5, 4.0];
/// Drift of the mean from the first half to the second, as a share of the motor file's threshold, of a motor that is not
/// steady. Not of the learnt one: drift is scatter too and would raise its own limit.
const DRIFT_SHARE: f32 = 0.25;
/// Offset as a share of full scale that resistors of 1 % and transducers explain; beyond it a sensor is defective.
const OFFSET_SHARE: f32 = 0.03;

/// Why nothing was learnt. The numbers are those of the Modbus register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// SENSOR is lit.
    Sensor = 1,
    /// LINE is lit.
    Line = 2,
    /// Current, speed or residuals were moving.
    Unsteady = 3,
    /// Too few windows were judged.
    TooFew = 4,
    /// A channel shows more at zero than a sound sensor does.
    Offset = 5,
    /// A residual is so far from zero that the motor is faulty or the motor file is another motor's.
    TooLarge = 6,
    /// The calibration could not be stored.
    Store = 7,
    /// The board doubts something about itself.
    Instrument = 8,
    /// The currents are unbalanced further than the supply makes them: a fault would be learnt.
    Unbalanced = 9,
}

impl Refusal {
    /// All of them.
    pub const ALL: [Refusal; 9] = [
        Refusal::Sensor,
        Refusal::Line,
        Refusal::Unsteady,
        Refusal::TooFew,
        Refusal::Offset,
        Refusal::TooLarge,
        Refusal::Store,
        Refusal::Instrument,
        Refusal::Unbalanced,
    ];

    /// In words, beginning with "refused".
    pub const fn label(self) -> &'static str {
        match self {
            Refusal::Sensor => "refused: SENSOR is lit",
            Refusal::Line => "refused: LINE is lit",
            Refusal::Unsteady => "refused: not steady",
            Refusal::TooFew => "refused: too few windows judged",
            Refusal::Offset => "refused: an offset too large",
            Refusal::TooLarge => "refused: residuals too large",
            Refusal::Store => "refused: flash could not be written",
            Refusal::Instrument => "refused: the board doubts itself",
            Refusal::Unbalanced => "refused: unbalanced currents",
        }
    }
}

/// How learning stands, as a number for Modbus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LearnState {
    /// Not asked for since power-up.
    #[default]
    Idle,
    /// In progress.
    Learning,
    /// Learnt and stored.
    Stored,
    /// Given up.
    Refused(Refusal),
}

impl LearnState {
    /// All of them, in the order of their numbers.
    pub fn all() -> impl Iterator<Item = LearnState> {
        let others = [LearnState::Idle, LearnState::Learning, LearnState::Stored];
        let refused = Refusal::ALL.into_iter().map(LearnState::Refused);
        others.into_iter().chain(refused)
    }

    /// In words.
    pub const fn label(self) -> &'static str {
        match self {
            LearnState::Idle => "idle",
            LearnState::Learning => "learning",
            LearnState::Stored => "stored",
            LearnState::Refused(refusal) => refusal.label(),
        }
    }

    /// 0 idle, 1 learning, 2 stored, 16 and the refusal's number where it was refused.
    pub fn code(self) -> u16 {
        match self {
            LearnState::Idle => 0,
            LearnState::Learning => 1,
            LearnState::Stored => 2,
            LearnState::Refused(refusal) => 16 + refusal as u16,
        }
    }
}

/// How far learning has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// More windows are needed.
    Learning,
    /// Done.
    Learnt(Calibration),
    /// Given up.
    Refused(Refusal),
}

/// What is learnt, window by window. Sums after Welford, which lose nothing in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learner {
    motor: u32,
    seen: u32,
    moving: u32,
    judged: u32,
    mean: [f32; RESIDUALS],
    products: [f32; COVARIANCES],
    halfway: [f32; RESIDUALS],
    offsets: [f32; CHANNELS],
    /// Mean of what the monitor adds to each threshold of a motor whose parameters are in doubt.
    added: [f32; RESIDUALS],
    /// Residuals that are compared at all; of a free load only r1 is.
    compared: [bool; RESIDUALS],
}

impl Learner {
    /// For the motor constants that go by `motor`.
    pub fn new(motor: u32) -> Self {
        Learner {
            motor,
            seen: 0,
            moving: 0,
            judged: 0,
            mean: [0.0; RESIDUALS],
            products: [0.0; COVARIANCES],
            halfway: [0.0; RESIDUALS],
            offsets: [0.0; CHANNELS],
            added: [0.0; RESIDUALS],
            compared: [true; RESIDUALS],
        }
    }

    /// Judged windows so far.
    pub fn windows(&self) -> u32 {
        self.judged
    }

    /// Takes one report of a monitor that runs with `present`; `factory` holds the motor file's thresholds.
    #[inline(never)]
    pub fn observe(
        &mut self,
        report: &Report,
        present: &MonitorConfig,
        factory: &[f32; RESIDUALS],
    ) -> Progress {
        if let Some(refusal) = lit(report) {
            return Progress::Refused(refusal);
        }
        self.seen += 1;
        self.moving += u32::from(report.not_judged == Some(NotJudged::Transient));
        self.count(report, present);
        if self.judged >= LEARN_WINDOWS {
            return match self.calibration(present, factory) {
                Ok(calibration) => Progress::Learnt(calibration),
                Err(refusal) => Progress::Refused(refusal),
            };
        }
        if self.seen < MOST_WINDOWS {
            return Progress::Learning;
        }
        let mostly_moving = self.moving > (self.seen - self.judged) / 2;
        Progress::Refused(if mostly_moving {
            Refusal::Unsteady
        } else {
            Refusal::TooFew
        })
    }

    fn count(&mut self, report: &Report, present: &MonitorConfig) {
        let judged = report.is_judged();
        let (Some(window), Some(residuals), Some(normalised), true) =
            (report.window, report.residuals, report.normalised, judged)
        else {
            return;
        };
        self.judged += 1;
        self.compared = normalised.map(|x| !x.is_nan());
        let share = 1.0 / self.judged as f32;
        for (mean, channel) in self.offsets.iter_mut().zip(&window.channels) {
            *mean += (channel.offset - *mean) * share;
        }
        for (mean, added) in self.added.iter_mut().zip(added(report, present)) {
            *mean += (added - *mean) * share;
        }
        self.accumulate(&residuals.r, share);
        if self.judged == LEARN_WINDOWS / 2 {
            self.halfway = self.mean;
        }
    }

    fn accumulate(&mut self, r: &[f32; RESIDUALS], share: f32) {
        let mut before = [0.0; RESIDUALS];
        for ((delta, mean), x) in before.iter_mut().zip(&mut self.mean).zip(r) {
            *delta = x - *mean;
            *mean += *delta * share;
        }
        let mut products = self.products.iter_mut();
        for (row, delta) in before.iter().enumerate() {
            for (x, mean) in r.iter().zip(&self.mean).skip(row) {
                if let Some(product) = products.next() {
                    *product += delta * (x - mean);
                }
            }
        }
    }

    fn healthy(&self) -> Healthy {
        let degrees = self.judged.saturating_sub(1).max(1) as f32;
        Healthy {
            windows: self.judged,
            mean: self.mean,
            covariance: self.products.map(|product| product / degrees),
        }
    }

    fn calibration(
        &self,
        present: &MonitorConfig,
        factory: &[f32; RESIDUALS],
    ) -> Result<Calibration, Refusal> {
        let healthy = self.healthy();
        let [u_a, u_b, u_c, i_a, i_b, i_c] = self.offsets;
        let converter = &present.converter;
        Ok(Calibration {
            motor: self.motor,
            thresholds: self.thresholds(&healthy, factory)?,
            voltage: trim(&converter.voltage, [u_a, u_b, u_c])?,
            current: trim(&converter.current, [i_a, i_b, i_c])?,
            healthy,
        })
    }

    fn thresholds(
        &self,
        healthy: &Healthy,
        factory: &[f32; RESIDUALS],
    ) -> Result<[f32; RESIDUALS], Refusal> {
        let mut thresholds = *factory;
        let statistics = healthy.mean.iter().zip(healthy.deviation());
        let compared = self.compared.iter().zip(&self.added).zip(&self.halfway);
        for ((threshold, (mean, deviation)), ((compared, added), halfway)) in
            thresholds.iter_mut().zip(statistics).zip(compared)
        {
            if *compared {
                // The second half's mean is 2 mean - halfway.
                let drift = 2.0 * (mean - halfway).abs();
                if drift > DRIFT_SHARE * *threshold {
                    return Err(Refusal::Unsteady);
                }
                let shown = mean.abs() + DEVIATIONS * deviation;
                *threshold = propose(*threshold, shown - added)?;
            }
        }
        Ok(thresholds)
    }
}

/// A lamp that says that the measurement itself cannot be trusted, or that the motor is not in good order.
fn lit(report: &Report) -> Option<Refusal> {
    match report.shown_lamps() {
        lamps if lamps.sensor == Lamp::On => Some(Refusal::Sensor),
        lamps if lamps.line == Lamp::On => Some(Refusal::Line),
        _ if report.is_unbalanced => Some(Refusal::Unbalanced),
        _ => None,
    }
}

/// What the monitor adds to the thresholds of a motor known by its plate, in this window: what the plate leaves open, above all. It goes on
/// adding it, so a threshold need not hold that part of what the motor shows.
fn added(report: &Report, present: &MonitorConfig) -> [f32; RESIDUALS] {
    let mut added = [0.0; RESIDUALS];
    let visible = report.visible.filter(|_| present.doubt.is_any());
    let visible = visible.iter().flatten().zip(&present.thresholds);
    for (added, (visible, threshold)) in added.iter_mut().zip(visible) {
        *added = visible - threshold;
    }
    added
}

/// A threshold of at least `wanted`, within bounds.
fn propose(factory: f32, wanted: f32) -> Result<f32, Refusal> {
    let [least, most] = SHARES.map(|share| share * factory);
    // Written so that NaN is refused too.
    if wanted <= most {
        Ok(wanted.max(least))
    } else {
        Err(Refusal::TooLarge)
    }
}

/// What the channels showed on average, which is zero in truth, taken into their offsets.
fn trim(scale: &monitor::ChannelScale, shown: [f32; 3]) -> Result<ChannelTrim, Refusal> {
    let mut trim = ChannelTrim::from(scale);
    let most = OFFSET_SHARE * scale.unit_per_code * scale.zero_code;
    for ((offset, gain), shown) in trim.offset.iter_mut().zip(&trim.gain).zip(shown) {
        *offset += shown / gain;
        // NaN is not sound either.
        let sound = offset.abs() <= most;
        if !sound {
            return Err(Refusal::Offset);
        }
    }
    Ok(trim)
}

#[cfg(test)]
mod tests;
