//! The monitor: one sample in, one report per supply cycle out.

use motor::effect::Rated;
use num_complex::Complex32;

use crate::checks::cage::CageLimits;
use crate::checks::rotor_bars::{RotorState, Sidebands};
use crate::checks::sensors::{HealthConfig, SensorFinding};
use crate::checks::speed_swing::Driven;
use crate::checks::supply::{SupplyConfig, SupplyFinding};
use crate::checks::unbalance;
use crate::config::{ConfigError, LoadKind, MonitorConfig};
use crate::input::chain::ConverterSupply;
use crate::input::codes::{Axes, Codes};
use crate::input::sample::{CHANNELS, Sample};
use crate::input::validity::{
    IntakeState, LEAST_REFERENCE, ReferenceFilter, reference_of, reference_scales,
};
use crate::isolation::Temperature;
use crate::lamps::logic::{PanelConfig, PanelState};
use crate::model::residuals::ResidualModel;
use crate::noise::allowance::CycleScatter;
use crate::rehearsal::Rehearsal;
use crate::report::{NotJudged, Report};
use crate::sync::encoder::{EncoderConfig, EncoderState};
use crate::sync::phasor::{CyclePhasors, PhasorState, Unit};
use crate::window::{Cycle, Window, WindowState};
use pll::{Supply, SyncConfig, SyncState, SyncTick};

/// The monitor's configuration in the form that the sample path uses. Shared, never changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monitor {
    pub(crate) config: MonitorConfig,
    pub(crate) sync: SyncConfig,
    pub(crate) encoder: EncoderConfig,
    pub(crate) codes: Codes,
    /// Turns [`reference_of`] voltages in V and of currents in A into shares of rated.
    reference_per_si: [f32; 2],
    pub(crate) reference_filter: ReferenceFilter,
    pub(crate) model: ResidualModel,
    pub(crate) health: HealthConfig,
    supply: SupplyConfig,
    panel: PanelConfig,
    pub(crate) rated: Rated<f32>,
    idle_samples: u32,
}

/// All that changes from sample to sample; a few kilobytes, no allocation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MonitorState {
    pub(crate) intake: IntakeState,
    pub(crate) sync: SyncState,
    pub(crate) phasor: PhasorState,
    pub(crate) axes: Axes,
    pub(crate) encoder: EncoderState,
    pub(crate) window: WindowState,
    pub(crate) scatter: CycleScatter,
    pub(crate) panel: PanelState,
    rotor: RotorState,
    pub(crate) temperature: Temperature,
    pub(crate) measured: [bool; 2],
    samples: u64,
    pub(crate) since_report: u32,
    pub(crate) rehearsal: Rehearsal,
    pub(crate) converter_supply: ConverterSupply,
    /// Whether the open cycle is summed up in codes.
    in_codes: bool,
}

impl MonitorState {
    /// Rehearses sensor faults from the next window on; [`Rehearsal::default`] ends it.
    pub fn rehearse(&mut self, gains: Rehearsal) {
        self.rehearsal = gains;
    }

    /// The supply's oscillator at the next sample; `None` while no supply is followed.
    pub fn supply(&self) -> Option<Supply> {
        (!self.sync.is_searching()).then(|| Supply {
            axis: self.sync.axis(),
            omega: self.sync.omega(),
        })
    }

    /// The converter's supply is `share` of the nominal one, from the next cycle on: absolute readings in codes are corrected by it.
    /// Beyond 0.9 to 1.1 nothing is corrected.
    pub fn note_converter_supply(&mut self, share: f32) {
        self.converter_supply = ConverterSupply::measured(share);
    }

    /// Counts samples that ended no cycle.
    pub(crate) fn count(&mut self, samples: usize) {
        self.samples = self.samples.wrapping_add(samples as u64);
        self.since_report = self.since_report.saturating_add(samples as u32);
    }

    /// A cycle that began in other units cannot be continued.
    pub(crate) fn expect_codes(&mut self, codes: bool) {
        if self.in_codes != codes {
            self.phasor = PhasorState::default();
            self.in_codes = codes;
        }
    }

    /// After missing samples: finds the supply anew; lamps and their persistence stay as they are.
    pub fn resume_after_gap(&mut self) {
        let mut scatter = self.scatter;
        scatter.interrupt();
        *self = MonitorState {
            scatter,
            panel: self.panel,
            temperature: self.temperature,
            samples: self.samples,
            rehearsal: self.rehearsal,
            converter_supply: self.converter_supply,
            ..MonitorState::default()
        };
    }
}

/// Supply frequencies that lock, rad/s: 5..100 Hz with a tenth to spare.
const OMEGA_RANGE: [f32; 2] = [28.0, 690.0];
/// Fastest believable shaft, as a multiple of the synchronous speed at the highest frequency.
const OVERSPEED: f32 = 1.5;
/// Without a supply a report comes at this interval, s.
const IDLE_REPORT_S: f32 = 0.1;
/// Lowest and highest supply voltage as shares of rated: wider than IEC 60034-1 zone B (0.9..1.1),
/// because a motor may be run outside it and still be judged.
const VOLTAGE_RANGE: [f32; 2] = [0.75, 1.2];
/// Negative-sequence voltage beyond which IEC 60034-26 and NEMA MG 1 14.36 derate heavily.
const MAX_UNBALANCE: f32 = 0.03;

impl Monitor {
    /// Prepares a monitor.
    ///
    /// # Errors
    /// A parameter outside its range.
    #[inline(never)]
    pub fn new(config: MonitorConfig) -> Result<Self, ConfigError> {
        config.validate()?;
        let [omega_min, omega_max] = OMEGA_RANGE;
        Ok(Monitor {
            sync: SyncConfig {
                t_sample: config.t_sample,
                omega_min,
                omega_max,
                min_amplitude: LEAST_REFERENCE,
            },
            encoder: EncoderConfig::new(
                config.t_sample,
                config.encoder_counts_per_revolution,
                OVERSPEED * omega_max / config.mechanics.n_p,
            ),
            codes: Codes::new(&config),
            reference_per_si: reference_scales(config.rated_channels()),
            reference_filter: ReferenceFilter::new(config.t_sample),
            model: ResidualModel {
                mechanics: config.mechanics,
                field: config.field,
                rated_torque: config.rated_torque,
            },
            health: HealthConfig {
                rated_voltage: config.rated_voltage,
                rated_current: config.rated_current,
            },
            supply: SupplyConfig {
                rated_voltage: config.rated_voltage,
                rated_omega: config.rated_omega,
                voltage_range: VOLTAGE_RANGE,
                max_unbalance: MAX_UNBALANCE,
            },
            panel: PanelConfig::new(&config),
            rated: Rated {
                voltage: config.rated_voltage,
                current: config.rated_current,
                omega_sync: config.rated_omega,
                n_p: config.mechanics.n_p,
                torque: config.rated_torque,
            },
            idle_samples: (IDLE_REPORT_S / config.t_sample) as u32,
            config,
        })
    }

    /// The configuration it was made from.
    pub fn config(&self) -> &MonitorConfig {
        &self.config
    }

    /// Takes one instant in SI units; a report comes once per supply cycle, or every 0.1 s without a supply.
    pub fn update(&self, state: &mut MonitorState, sample: &Sample) -> Option<Report> {
        state.expect_codes(false);
        let admitted = state.intake.admit(sample);
        state.count(1);
        let (u, i) = (admitted.u_s_abc, admitted.i_s_abc);
        let [per_volt, per_ampere] = self.reference_per_si;
        let shares = [reference_of(u) * per_volt, reference_of(i) * per_ampere];
        let reference = state.intake.reference(shares, &self.reference_filter);
        let tick = self.sync.update(&mut state.sync, reference);
        self.encoder.update(&mut state.encoder, sample.speed);
        let x = [u.a, u.b, u.c, i.a, i.b, i.c];
        self.take_instant(state, &tick, &x, &[Unit::SI; CHANNELS])
    }

    /// What follows from one instant, whose channels are in `units`.
    #[inline(always)]
    pub(crate) fn take_instant(
        &self,
        state: &mut MonitorState,
        tick: &SyncTick,
        x: &[f32; CHANNELS],
        units: &[Unit; CHANNELS],
    ) -> Option<Report> {
        if tick.restarted {
            self.restart(state);
        }
        if state.sync.is_searching() {
            return self.idle_report(state);
        }
        let phasors = state.phasor.update(tick, x, units)?;
        Some(self.close_cycle(state, phasors))
    }

    fn restart(&self, state: &mut MonitorState) {
        state.window.clear();
        state.scatter.interrupt();
        state.intake.close_cycle();
        self.encoder.close_window(&mut state.encoder);
    }

    #[inline(never)]
    fn close_cycle(&self, state: &mut MonitorState, phasors: CyclePhasors) -> Report {
        let tally = state.intake.close_cycle();
        state.measured = tally.measured();
        let cycle = Cycle {
            phasors,
            speed: self.encoder.close_window(&mut state.encoder),
            torque: tally.torque(),
            clipped: tally.clipped,
            invalid_samples: tally.invalid,
        };
        let corrected = self.at_terminals(state, cycle);
        self.take_cycle(state, corrected)
    }

    /// What follows from one cycle at the terminals.
    pub(crate) fn take_cycle(&self, state: &mut MonitorState, cycle: Cycle) -> Report {
        state.window.push(cycle, self.config.window_cycles);
        let window = state
            .window
            .measure(self.config.window_cycles, self.config.t_sample)
            .filter(|_| state.sync.is_locked());
        self.report(state, window, cycle.clipped.any())
    }

    /// The cycle with all that is known of the instrument. Samples in SI units come from another recorder than the board.
    fn at_terminals(&self, state: &MonitorState, cycle: Cycle) -> Cycle {
        let cycle = cycle.corrected(&self.config.channel_gain);
        if state.in_codes {
            let converter = &self.config.converter;
            let gains = converter.supply_gains(state.converter_supply.0);
            let cycle = cycle.corrected(&gains);
            cycle.ahead_of(&converter.chain, state.sync.omega())
        } else {
            cycle
        }
    }

    fn idle_report(&self, state: &mut MonitorState) -> Option<Report> {
        if state.since_report < self.idle_samples {
            return None;
        }
        state.window.clear();
        self.encoder.close_window(&mut state.encoder);
        state.measured = state.intake.close_cycle().measured();
        Some(self.report(state, None, false))
    }

    fn report(&self, state: &mut MonitorState, window: Option<Window>, clipped: bool) -> Report {
        self.let_winding_warm(state, window.as_ref());
        state.since_report = 0;
        let mut report = Report {
            sample_index: state.samples,
            window,
            ..Report::default()
        };
        match &window {
            Some(window) => self.examine(state, window, &mut report),
            None if clipped => report.not_judged = Some(NotJudged::Clipped),
            None => self.explain_silence(state, &mut report),
        }
        self.panel.show(&mut state.panel, &mut report);
        report
    }

    fn explain_silence(&self, state: &MonitorState, report: &mut Report) {
        let dark = state.intake.is_dark();
        let searching = state.sync.is_searching();
        let frozen = state
            .intake
            .is_frozen(self.idle_samples / 2, self.config.rated_channels());
        report.supply = (dark && !frozen && state.measured[0]).then_some(SupplyFinding::Lost);
        report.not_judged = Some(match (report.supply, searching) {
            _ if frozen => NotJudged::Invalid,
            (Some(finding), _) => NotJudged::Supply(finding),
            (None, true) => NotJudged::NotLocked,
            (None, false) => NotJudged::Settling,
        });
    }

    /// Everything that one complete window can say, and whether thresholds may be applied to it.
    fn examine(&self, state: &mut MonitorState, window: &Window, report: &mut Report) {
        let measured @ [voltages, currents] = state.measured;
        // Samples substituted for NaN cannot prove a dead sensor.
        let numbers = window.invalid_samples == 0;
        if numbers {
            report.sensor = self.check_channels(measured, window);
        }
        if numbers && voltages && self.health.has_supply(window) {
            report.supply = self.supply.check(window);
        }
        report.not_judged = self.obstacle(measured, window, report);
        report.unbalance = unbalance::unexplained(&self.config, window);
        report.rotor.sidebands = self.follow_rotor(state, window, report.not_judged);
        let limits = |sidebands: &Sidebands| self.cage_limits(sidebands.active);
        report.rotor.limits = report.rotor.sidebands.as_ref().map(limits);
        let movement = (voltages && currents)
            .then(|| self.movement(&state.rehearsal, window))
            .flatten();
        let calm = movement.is_none_or(|m| m.is_steady && !m.is_plugged);
        let noise = self.allowance(state, window, calm && report.not_judged.is_none());
        if let Some(movement) = &movement {
            self.set_limits(&state.rehearsal, window, movement, &noise, report);
        }
        let rise = self.isolate(state, window, &noise, report);
        if movement.is_some() {
            self.evaluate(rise, &state.rehearsal, window, report);
        }
    }

    /// Sidebands from which on the cage is doubtful or broken, at an active current, A.
    pub fn cage_limits(&self, active: f32) -> CageLimits {
        let share = active / self.config.rated_current;
        self.config.cage.limits(share, self.config.mechanics.n_p)
    }

    /// Adds the latest cycle to the block of whole turns of twice the slip angle. What hinders judging begins a new one.
    fn follow_rotor(
        &self,
        state: &mut MonitorState,
        window: &Window,
        obstacle: Option<NotJudged>,
    ) -> Option<Sidebands> {
        let seen = state.window.latest_current().zip(window.omega_mech);
        let loaded =
            |i: Complex32| i.re.abs() > Sidebands::LEAST_ACTIVE * self.config.rated_current;
        let sound = seen.filter(|((i, _), _)| obstacle.is_none() && loaded(*i));
        let Some(((i, samples), omega_mech)) = sound else {
            state.rotor = RotorState::default();
            return None;
        };
        let slip = window.omega_sync - self.config.mechanics.n_p * omega_mech;
        let driven = Driven::of(&self.config.params, window);
        let step = 2.0 * slip * samples * self.config.t_sample;
        state.rotor.follow(i, step, &driven)
    }

    fn check_channels(
        &self,
        [voltages, currents]: [bool; 2],
        window: &Window,
    ) -> Option<SensorFinding> {
        let of_voltages = || self.health.check_voltages(window).filter(|_| voltages);
        let of_currents = || self.health.check_currents(window).filter(|_| currents);
        of_voltages().or_else(of_currents)
    }

    /// The first reason, in the order in which a person would mend it, why this window cannot be judged.
    fn obstacle(
        &self,
        [voltages, currents]: [bool; 2],
        window: &Window,
        report: &Report,
    ) -> Option<NotJudged> {
        let by_currents = self.judges_currents_alone(currents) && !voltages;
        let reasons = [
            (!voltages && !by_currents, NotJudged::NoVoltages),
            (!currents, NotJudged::NoCurrents),
            (window.invalid_samples > 0, NotJudged::Invalid),
            (window.clipped.any(), NotJudged::Clipped),
            (
                voltages && self.health.is_astray(window),
                NotJudged::NotLocked,
            ),
        ];
        let plain = reasons
            .into_iter()
            .find(|(holds, _)| *holds)
            .map(|(_, reason)| reason);
        plain
            .or(report.sensor.map(NotJudged::Sensor))
            .or(window.reverses.then_some(NotJudged::Reversing))
            .or((!self.health.has_current(window)).then_some(NotJudged::NoLoadCurrent))
            .or((window.omega_mech.is_none() && !by_currents).then_some(NotJudged::NoSpeed))
    }

    /// A motor whose healthy current unbalance is known can be judged by its currents.
    fn judges_currents_alone(&self, currents: bool) -> bool {
        let healthy = self.config.healthy.as_ref();
        currents && healthy.is_some_and(|healthy| healthy.current_unbalance_scatter > 0.0)
    }

    /// The brake torque, where the motor file says that it is measured.
    pub(crate) fn tau_load(&self, window: &Window) -> Option<f32> {
        let is_measured = self.config.load == LoadKind::Measured;
        window.tau_load.filter(|_| is_measured)
    }
}
