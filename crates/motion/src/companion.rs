//! Motion beside the windows: in ADC codes, as it runs on the board, or in SI units.

mod standing;

use monitor::{
    Abc, AnalogueChain, Beside, CHANNELS, ClippedChannels, CodeUnits, MonitorConfig, Moving,
    Report, SpeedSample, Stretch,
};
use num_complex::Complex32;

use crate::gate::NotInMotion;
use crate::observer::Instant;
use crate::{KnownLoad, Motion, MotionCycle, MotionSample, MotionState, NoMotion};
use standing::Standing;

/// Judges in motion whatever a [`monitor::Monitor`] takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Companion {
    motion: Result<Motion, NoMotion>,
    state: MotionState,
    standing: Standing,
    alignment: Alignment,
}

/// Brings channels that are late by different times to one instant, between two samples along a straight line: at 100 Hz and 10 kHz
/// off by less than 0.05 % of the amplitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Alignment {
    /// By how much each channel is earlier than the latest one, samples.
    early: [f32; CHANNELS],
    /// Whether they differ at all.
    is_apart: bool,
    before: Option<[f32; CHANNELS]>,
}

impl Default for Companion {
    /// Knows no motor.
    #[inline]
    fn default() -> Self {
        Companion {
            motion: Err(NoMotion::NotCalibrated),
            state: MotionState::default(),
            standing: Standing::new(true),
            alignment: Alignment::default(),
        }
    }
}

/// Largest part of a sample by which channels may be apart.
const MOST_EARLY: f32 = 1.0;

impl Companion {
    /// For a monitor of this configuration.
    #[inline]
    pub fn new(config: &MonitorConfig) -> Self {
        let mut companion = Companion::default();
        companion.set_motor(config);
        companion
    }

    /// Begins anew with another configuration.
    #[inline(never)]
    pub fn set_motor(&mut self, config: &MonitorConfig) {
        let alignment = Alignment::of(&config.converter.chain, config.t_sample);
        self.motion = match alignment {
            Some(_) => Motion::new(config).map(Motion::without_torque),
            None => Err(NoMotion::ChannelsApart),
        };
        self.alignment = alignment.unwrap_or_default();
        self.standing = Standing::new(self.motion.as_ref().is_ok_and(Motion::is_doubted));
        self.state.begin_anew();
    }

    /// For samples in SI units, which may hold a torque.
    pub fn of_samples(config: &MonitorConfig) -> Self {
        let motion = Motion::new(config);
        Companion {
            standing: Standing::new(motion.as_ref().is_ok_and(Motion::is_doubted)),
            motion,
            ..Companion::default()
        }
    }

    /// Takes a sample in SI units, with the supply's oscillator behind it; gives the cycle that ends with it.
    pub fn take_sample(&mut self, sample: &MotionSample) -> Option<MotionCycle> {
        let motion = self.motion.as_ref().ok()?;
        let cycle = motion.update(&mut self.state, sample)?;
        self.standing.cycle(&cycle);
        Some(cycle)
    }

    /// Takes the window that ends. Of one that is left to motion: why it was not judged there either.
    pub fn judged(&mut self, report: &Report) -> Option<Result<(), NotInMotion>> {
        self.standing.window(report)
    }

    /// What is said with the latest window; `None` where nothing is judged in motion.
    pub fn moving(&self) -> Option<Moving> {
        self.motion.as_ref().ok().map(|_| self.standing.moving())
    }

    /// Whether the alarm that is on came in motion: one that came while the windows were at rest is theirs.
    pub fn counts(&self) -> bool {
        self.standing.counts()
    }

    /// See [`MotionState::restless_since`].
    pub fn restless_since(&self) -> Option<u64> {
        self.state.restless_since()
    }

    /// Samples of a cycle, rounded up; 0 where nothing is judged.
    pub fn cycle_samples(&self) -> usize {
        self.motion.as_ref().map_or(0, Motion::cycle_samples)
    }

    /// See [`Motion::is_doubted`].
    pub fn is_doubted(&self) -> bool {
        self.motion.as_ref().is_ok_and(Motion::is_doubted)
    }

    /// Why nothing is judged in motion.
    pub fn not_possible(&self) -> Option<NoMotion> {
        self.motion.err()
    }

    /// Samples are missing before the next one.
    pub fn resume_after_gap(&mut self) {
        self.state.resume_after_gap();
        self.alignment.before = None;
    }
}

impl Beside for Companion {
    #[inline]
    fn take(&mut self, stretch: &Stretch<'_>) {
        let Ok(motion) = &self.motion else {
            return;
        };
        let clipped = stretch.clipped != ClippedChannels::NONE;
        let omega = (!stretch.axes.is_empty()).then_some(stretch.omega);
        let mut axes = stretch.axes.iter();
        for (codes, count) in stretch.codes.iter().zip(stretch.counts) {
            let x = self.alignment.aligned(in_units(codes, stretch.units));
            let axis = axes.next().copied();
            let instant = motion.instant_of_count(&mut self.state, *count, x, axis);
            let omega = omega.filter(|_| axis.is_some());
            if let Some(cycle) = motion.take(&mut self.state, instant, clipped, omega) {
                self.standing.cycle(&cycle);
            }
        }
    }

    fn window(&mut self, report: &Report) -> Option<Moving> {
        self.judged(report);
        self.moving()
    }
}

/// Voltages a, b, c, then currents a, b, c at the terminals.
#[inline(always)]
fn in_units(codes: &[u16; CHANNELS], units: &[CodeUnits; CHANNELS]) -> [f32; CHANNELS] {
    let [v_a, i_a, v_b, i_b, v_c, i_c] = codes.map(f32::from);
    let mut x = [v_a, v_b, v_c, i_a, i_b, i_c];
    for (x, unit) in x.iter_mut().zip(units) {
        *x = *x * unit.scale - unit.offset;
    }
    x
}

impl Alignment {
    /// `None` where channels are further apart than a sample.
    fn of(chain: &AnalogueChain, t_sample: f32) -> Option<Self> {
        let latest = chain.delay.iter().copied().fold(f32::MIN, f32::max);
        let early = chain.delay.map(|delay| (latest - delay) / t_sample);
        let near = early.iter().all(|early| *early <= MOST_EARLY);
        near.then_some(Alignment {
            is_apart: early.iter().any(|early| *early > 0.0),
            early,
            before: None,
        })
    }

    /// A channel that is early is taken as much before its sample.
    #[inline(always)]
    fn aligned(&mut self, x: [f32; CHANNELS]) -> [f32; CHANNELS] {
        if !self.is_apart {
            return x;
        }
        let mut aligned = x;
        let before = self.before.replace(x).unwrap_or(x);
        for ((place, before), early) in aligned.iter_mut().zip(before).zip(self.early) {
            *place -= early * (*place - before);
        }
        aligned
    }
}

impl Motion {
    /// In codes there is no torque channel: a load that is measured is not known.
    fn without_torque(self) -> Self {
        let load = match self.load {
            KnownLoad::Measured => KnownLoad::Nothing,
            load => load,
        };
        Motion { load, ..self }
    }

    /// The instant of an encoder's count; `x` are voltages and currents at the terminals.
    #[inline(always)]
    fn instant_of_count(
        &self,
        state: &mut MotionState,
        count: u16,
        [u_a, u_b, u_c, i_a, i_b, i_c]: [f32; CHANNELS],
        axis: Option<Complex32>,
    ) -> Option<Instant> {
        let speed = SpeedSample::Count(count);
        let turned = self.turned(state.last_speed.replace(speed), speed)?;
        Some(Instant {
            u: Abc {
                a: u_a,
                b: u_b,
                c: u_c,
            },
            i: Abc {
                a: i_a,
                b: i_b,
                c: i_c,
            },
            turned,
            tau_load: 0.0,
            axis: axis.unwrap_or(state.observer.supply() * self.step),
        })
    }
}
