#![cfg_attr(not(test), no_std)]
//! Judging while current, speed or supply change: the dynamic residuals (36) in integral form.
//!
//! (36) as printed takes the rotor flux for constant, and in a start shows a healthy motor as grossly faulty. Here the flux
//! follows the current through its own equation (`observer`), the stator's equation is integrated over a cycle under the
//! weight `e^{-j theta}` (`rows`), departures of a healthy motor's parameters are run through the flux equation
//! (`influence`), and a likelihood ratio decides what no healthy departure explains (`decision`). No derivative of a
//! measurement is taken. Windows at rest are judged as before, by [`monitor::Monitor`].

mod build;
mod circuit;
mod companion;
mod decision;
mod departures;
mod gate;
mod influence;
mod information;
mod observer;
mod rows;
mod scatter;
#[cfg(test)]
mod tests;

use num_complex::Complex32;

pub use build::NoMotion;
pub use companion::Companion;
pub use decision::Limits;
pub use decision::alarm::{MotionAlarm, Named};
pub use departures::Priors;
pub use gate::NotInMotion;

use circuit::{Circuit, Coefficients};
use decision::{Decision, Outcome};
use departures::ALL;
use gate::{Gate, Seen};
use influence::Influences;
use monitor::{
    Abc, CHANNELS, Cause, ClippedChannels, Sample, SensorFinding, SpeedSample, Supply,
    dead_channel, magnitude, small_rotation,
};
use observer::{Instant, Interval, Observer};
use rows::{Past, Sums};
use scatter::{Circumstances, Scatter};

pub use information::ROWS as MOTION_ROWS;

/// What judging in motion needs to know. Shared, never changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    circuit: Circuit,
    priors: Priors,
    limits: Limits,
    channel_gain: [f32; CHANNELS],
    /// Electrical rad per count of the encoder.
    per_count: f32,
    /// Samples of a cycle, and of the parts in which sensitivities are carried on.
    samples: f32,
    part: f32,
    /// Step of the oscillator while no supply is followed.
    step: Complex32,
    /// The load's torque is known: declared as friction, or measured.
    load: KnownLoad,
    is_doubted: bool,
}

/// What is known of the load's torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum KnownLoad {
    Friction,
    Measured,
    Nothing,
}

/// All that changes from sample to sample; no allocation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionState {
    coefficients: Option<Coefficients>,
    observer: Observer,
    influences: Influences,
    sums: Sums,
    past: Past,
    scatter: Scatter,
    decision: Decision,
    gate: Gate,
    seen: Seen,
    last_speed: Option<SpeedSample>,
    /// Direction of the field in the cycle before: 1 or -1.
    direction: f32,
    omega_supply: f32,
    /// Relative rise of both resistances at which the rows are taken.
    rise: f32,
    /// How far the true one may be from it: mean and standard deviation; 0 before the first judged cycle.
    rise_open: [f32; 2],
    /// How far it was revised lately: the flux forgets it.
    revised: f32,
    /// Samples since the start, and when the statistic left the noise.
    count: u64,
    restless_since: Option<u64>,
    raised: Option<(u64, u64)>,
    /// Electrical speeds of the latest two cycles, rad/s.
    turned: [f32; 2],
    /// Whether the speed went from turning to nothing at once.
    speed_died: bool,
}

/// One instant for [`Motion::update`], in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionSample {
    /// Phase voltages and currents; see [`monitor::Sample`].
    pub sample: Sample,
    /// The supply's oscillator; see [`monitor::MonitorState::supply`].
    pub supply: Option<Supply>,
}

/// What one cycle of rated length came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionCycle {
    /// Samples seen up to and with the cycle's last.
    pub sample_index: u64,
    /// Why the cycle was not judged; `None` for one that was.
    pub not_judged: Option<NotInMotion>,
    /// E+ (two), E- (two), Q, I_0 (two), V_0 (two): shares of rated voltage, torque, current, voltage.
    pub rows: [f32; MOTION_ROWS],
    /// Largest `|T|` of all causes; 0 where the cycle was not judged.
    pub statistic: f32,
    /// The cause that has it.
    pub leading: Option<Cause>,
    /// Squared length of the rows with nine degrees of freedom; 0 where the cycle was not judged.
    pub square: f32,
    /// An alarm that this cycle raised or named.
    pub alarm: Option<MotionAlarm>,
    /// Whether an alarm is on.
    pub is_alarmed: bool,
}

/// A revision of the heating below this is not worth while, relative rise.
const LEAST_REVISION: f32 = 0.005;
/// Largest rise that is believed, and smallest.
const RISES: [f32; 2] = [-0.4, 1.0];
/// Standard deviation below which heating may be revised, share of its prior.
const KNOWN_HEATING: f32 = 0.25;
/// Share of rated speed from which a shaft does not come to rest within two cycles.
const TURNING: f32 = 0.2;
/// A rotor that turns further from one sample to the next is no rotor, electrical rad.
const FASTEST: f32 = 0.7;

impl Motion {
    /// Whether the motor in good order was never seen in motion: what departs may be what its file lacks.
    pub fn is_doubted(&self) -> bool {
        self.is_doubted
    }

    /// Samples of a cycle, rounded up.
    pub fn cycle_samples(&self) -> usize {
        self.samples as usize + 1
    }

    /// Takes one instant; something comes back at the end of each cycle of rated length.
    #[inline]
    pub fn update(&self, state: &mut MotionState, sample: &MotionSample) -> Option<MotionCycle> {
        let instant = self.instant(state, sample);
        let clipped = sample.sample.clipped != ClippedChannels::NONE;
        let omega = sample.supply.map(|supply| supply.omega);
        self.take(state, instant, clipped, omega)
    }

    /// The same of an instant that is `None` where something is missing; the oscillator's frequency is `None` while no supply is followed.
    #[inline]
    fn take(
        &self,
        state: &mut MotionState,
        instant: Option<Instant>,
        clipped: bool,
        omega: Option<f32>,
    ) -> Option<MotionCycle> {
        state.count += 1;
        let Some(instant) = instant else {
            return self.interrupt(state);
        };
        state.seen.clipped |= clipped;
        state.seen.unlocked |= omega.is_none();
        state.omega_supply = omega.unwrap_or(state.omega_supply);
        let c = state
            .coefficients
            .get_or_insert_with(|| self.circuit.at(0.0, 0.0));
        let t_sample = self.circuit.t_sample;
        let vectors = [instant.u, instant.i].map(observer::vector);
        state.scatter.add(vectors[0], vectors[1]);
        let Some(interval) = state.observer.step(c, t_sample, &instant) else {
            state.seen.first_current = magnitude(vectors[1]);
            return None;
        };
        state.sums.add(&self.circuit, c, &instant, &interval);
        state.influences.add(&interval, instant.turned);
        let ends = state.sums.samples >= self.samples;
        if !ends && state.influences.samples() < self.part {
            return None;
        }
        let c = *c;
        self.end_part(state, &c, &interval);
        ends.then(|| self.end_cycle(state, &c))
    }

    /// The instant with the channels as the instrument is known; `None` where something is missing.
    #[inline]
    fn instant(&self, state: &mut MotionState, sample: &MotionSample) -> Option<Instant> {
        let s = &sample.sample;
        let [g_a, g_b, g_c, h_a, h_b, h_c] = self.channel_gain;
        let corrected = |x: Abc, gains: [f32; 3]| x.zip(Abc::from_array(gains), |x, gain| x * gain);
        let u = s.u_s_abc.filter(|u| u.is_finite())?;
        let i = s.i_s_abc.filter(|i| i.is_finite())?;
        let turned = self.turned(state.last_speed.replace(s.speed), s.speed)?;
        let tau_load = match self.load {
            KnownLoad::Measured => s.tau_load.filter(|tau| tau.is_finite())?,
            KnownLoad::Friction | KnownLoad::Nothing => 0.0,
        };
        let old = state.observer.supply();
        Some(Instant {
            u: corrected(u, [g_a, g_b, g_c]),
            i: corrected(i, [h_a, h_b, h_c]),
            turned,
            tau_load,
            axis: sample.supply.map_or(old * self.step, |supply| supply.axis),
        })
    }

    /// How far the rotor turned since the sample before, electrical rad.
    #[inline]
    fn turned(&self, before: Option<SpeedSample>, now: SpeedSample) -> Option<f32> {
        let turned = match (before, now) {
            (None, SpeedSample::Count(_)) => 0.0,
            (None, SpeedSample::RadPerSecond(omega)) if omega.is_finite() => 0.0,
            (Some(SpeedSample::Count(old)), SpeedSample::Count(new)) => {
                f32::from(new.wrapping_sub(old).cast_signed()) * self.per_count
            }
            (Some(SpeedSample::RadPerSecond(old)), SpeedSample::RadPerSecond(new)) => {
                0.5 * (old + new) * self.circuit.t_sample * self.circuit.mechanics.n_p
            }
            // No speed, no number, or another kind of sensor.
            _ => return None,
        };
        // NaN is no number below the limit.
        (turned.abs() < FASTEST).then_some(turned)
    }

    /// Something is missing: whatever follows begins anew, only alarm and temperature stay.
    fn interrupt(&self, state: &mut MotionState) -> Option<MotionCycle> {
        let missing = state.seen.missing + 1.0;
        let whole = missing >= self.samples;
        state.resume_after_gap();
        state.seen.missing = if whole { 0.0 } else { missing };
        whole.then(|| self.not_judged(state, [0.0; MOTION_ROWS], NotInMotion::Missing))
    }

    fn end_part(&self, state: &mut MotionState, c: &Coefficients, interval: &Interval) {
        let omega = state.influences.omega(self.circuit.t_sample);
        let slip = self.slip(state, omega);
        let parts = (&self.circuit, c);
        let (rotor, moved) = (state.observer.rotor, &mut state.sums.moved);
        state.influences.close(parts, rotor, interval, slip, moved);
        let air_gap = state.observer.air_gap(c);
        state.coefficients = Some(self.circuit.at(air_gap, state.rise));
    }

    /// Slip at an electrical speed of the rotor, share of rated supply frequency.
    fn slip(&self, state: &MotionState, omega: f32) -> f32 {
        let direction = if state.direction < 0.0 { -1.0 } else { 1.0 };
        (state.omega_supply - direction * omega) / self.circuit.rated.omega
    }

    #[inline(never)]
    fn end_cycle(&self, state: &mut MotionState, c: &Coefficients) -> MotionCycle {
        let sums = core::mem::take(&mut state.sums);
        let seen = core::mem::take(&mut state.seen);
        state.observer.renormalise();
        let [forward, backward] = sums.sequences(0).map(|x| x.norm_sqr());
        state.direction = if backward > forward { -1.0 } else { 1.0 };
        let period = sums.samples * self.circuit.t_sample;
        let omega = sums.turned(self.circuit.mechanics.n_p) / period;
        let slip = self.slip(state, omega);
        if !state.gate.is_seeded {
            self.seed(state, &sums, &seen, omega);
        }
        let mut rows = sums.rows(&self.circuit, c, &mut state.past);
        rows.has_torque &= self.load != KnownLoad::Nothing;
        let priors = match state.last_speed {
            Some(SpeedSample::RadPerSecond(_)) => self.priors.with_speed_channel(),
            _ => self.priors,
        };
        let now = Circumstances {
            samples: sums.samples,
            slip: [
                slip,
                slip * self.circuit.rated.omega / state.omega_supply.max(1.0),
            ],
            current: sums.current(),
            flux: magnitude(state.observer.flux),
            heating_square: self.heating_square(state),
            late_s: priors.late_s(),
        };
        let white = state.scatter.whiten(&self.circuit, &priors, &rows, &now);
        if let Some(reason) = state.gate.close(&self.circuit, &sums, &seen, slip) {
            state.decision.pass();
            return self.not_judged(state, rows.rows, reason);
        }
        let outcome = state.decision.take(&white, &self.limits);
        self.follow_speed(state, omega);
        let dead = self
            .dead_channel(&sums)
            .or(state.speed_died.then_some(SensorFinding::SpeedImplausible));
        self.follow_heating(state, &outcome);
        let alarm = self.note_alarm(state, &outcome, dead);
        MotionCycle {
            sample_index: state.count,
            not_judged: None,
            rows: rows.rows,
            statistic: outcome.best.statistic.abs(),
            leading: ALL.get(outcome.best.hypothesis).map(|h| h.cause),
            square: outcome.square,
            alarm,
            is_alarmed: state.decision.is_alarmed(),
        }
    }

    fn not_judged(
        &self,
        state: &MotionState,
        rows: [f32; MOTION_ROWS],
        reason: NotInMotion,
    ) -> MotionCycle {
        MotionCycle {
            sample_index: state.count,
            not_judged: Some(reason),
            rows,
            statistic: 0.0,
            leading: None,
            square: 0.0,
            alarm: None,
            is_alarmed: state.decision.is_alarmed(),
        }
    }

    /// The flux of the steady state that the first cycle looks like: `psi_r = L_m I/(1 + j w_sl L_r/R_r)`.
    fn seed(&self, state: &mut MotionState, sums: &Sums, seen: &Seen, omega: f32) {
        let at_rest = Gate::began_at_rest(&self.circuit, sums, seen);
        if !at_rest {
            let [forward, backward] = sums.sequences(3);
            let axis = state.observer.supply();
            let (i, supply) = if state.direction < 0.0 {
                (backward * axis.conj(), -state.omega_supply)
            } else {
                (forward * axis, state.omega_supply)
            };
            let lag = Complex32::new(1.0, (supply - omega) * self.circuit.rotor_time());
            let psi_r = i * self.circuit.params.l_m / lag;
            state.observer.flux = psi_r * state.observer.rotor.conj();
            if let Some(c) = &state.coefficients {
                state.observer.adopt(c);
            }
        }
        state.gate.seed(&self.circuit, at_rest);
    }

    fn heating_square(&self, state: &mut MotionState) -> f32 {
        let [.., prior] = self.priors.0;
        let period = self.samples * self.circuit.t_sample;
        state.revised *= libm::expf(-period / self.circuit.rotor_time());
        let [mean, deviation] = state.rise_open;
        let open = match deviation > 0.0 {
            true => mean * mean + deviation * deviation,
            false => prior * prior,
        };
        open.min(prior * prior) + state.revised * state.revised
    }

    /// Takes the rows at the temperature that they show, as soon as they show it: far from the one of the motor file they are
    /// no straight lines. What was learnt is carried along, and so is the flux.
    fn follow_heating(&self, state: &mut MotionState, outcome: &Outcome) {
        let [.., prior] = self.priors.0;
        let [mean, deviation] = outcome.heating;
        state.rise_open = [mean * prior, deviation * prior];
        let [least, most] = RISES;
        let wanted = (state.rise + (1.0 + state.rise) * mean * prior)
            .max(least)
            .min(most);
        let relative = (wanted - state.rise) / (1.0 + state.rise);
        let unsure = deviation > KNOWN_HEATING || state.scatter.remembers_slip();
        if unsure || relative.abs() < LEAST_REVISION {
            return;
        }
        state.rise = wanted;
        state.rise_open = [0.0, deviation * prior];
        state.revised += relative.abs();
        state.decision.revise_heating(relative / prior);
        let moved = state.influences.of_rotor_resistance() * relative;
        state.observer.flux += moved;
        let air_gap = state
            .coefficients
            .map_or(0.0, |c| state.observer.air_gap(&c));
        let c = self.circuit.at(air_gap, state.rise);
        state.coefficients = Some(c);
        state.observer.adopt(&c);
    }

    /// A channel that shows nothing while its neighbours do.
    fn dead_channel(&self, sums: &Sums) -> Option<SensorFinding> {
        let [a, b, c, d, e, f] = sums.amplitudes();
        let voltage = dead_channel(&[a, b, c]).map(SensorFinding::DeadVoltage);
        voltage.or_else(|| dead_channel(&[d, e, f]).map(SensorFinding::DeadCurrent))
    }

    /// A shaft needs time to come to rest; a sensor that dies does not.
    fn follow_speed(&self, state: &mut MotionState, omega: f32) {
        let [older, newer] = state.turned.map(f32::abs);
        let turning = older.max(newer) > TURNING * self.circuit.rated.omega;
        state.speed_died = omega == 0.0 && (state.speed_died || turning);
        state.turned = [state.turned[1], omega];
    }
}

impl MotionState {
    /// Number of the sample with which the statistic left the noise, counted from 1; `None` while it is in the noise.
    pub fn restless_since(&self) -> Option<u64> {
        self.restless_since
    }

    /// After missing samples: flux and sums begin anew; alarm and temperature stay.
    ///
    /// Part by part: a second state would not fit on a board's stack.
    #[inline(never)]
    pub fn resume_after_gap(&mut self) {
        let MotionState {
            coefficients,
            observer,
            influences,
            sums,
            past,
            scatter,
            decision: _,
            gate,
            seen,
            last_speed,
            direction,
            omega_supply,
            rise: _,
            rise_open: _,
            revised,
            count: _,
            restless_since,
            raised: _,
            turned,
            speed_died,
        } = self;
        (*coefficients, *last_speed, *restless_since) = (None, None, None);
        *observer = Observer::default();
        *influences = Influences::default();
        *sums = Sums::default();
        *past = Past::default();
        (*scatter, *gate, *seen) = (Scatter::default(), Gate::default(), Seen::default());
        (*direction, *omega_supply, *revised) = (0.0, 0.0, 0.0);
        (*turned, *speed_died) = ([0.0; 2], false);
    }

    /// As before the first sample.
    pub(crate) fn begin_anew(&mut self) {
        self.resume_after_gap();
        self.decision.begin_anew();
        (self.rise, self.rise_open) = (0.0, [0.0; 2]);
        (self.count, self.raised) = (0, None);
    }
}

/// Step of the oscillator at rated frequency.
fn rated_step(omega: f32, t_sample: f32) -> Complex32 {
    small_rotation(omega * t_sample)
}
