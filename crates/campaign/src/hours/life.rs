//! Days of a machine: runs, changes and events in their order, through one monitor.

use monitor::{Abc, MonitorState, Report, Sample, SpeedSample};
use motor::motor_file::LoadKind;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::cycles::Cycles;
use super::events::{Event, Staged};
use super::habits::{DAY_S, exponential};
use super::instrument::Shown;
use super::learn::Watched;
use super::operating::{Conditions, Shows, shows};
use super::weather::{Body, Wander, signed};
use crate::runs::run::T_SAMPLE_S;

/// What a machine was doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Doing {
    /// Steady hours, made cycle by cycle.
    Steady,
    /// A slow change of its load, made cycle by cycle.
    Ramp,
    /// The supply's unbalance changes within a second, made cycle by cycle.
    Unbalance,
    /// An event, made sample by sample.
    Event(Event),
}

impl Doing {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Doing::Steady => "steady hours",
            Doing::Ramp => "load ramp",
            Doing::Unbalance => "unbalance step",
            Doing::Event(event) => event.name(),
        }
    }
}

/// When a report came.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time since the Monday's midnight on which it all began, s.
    pub t_s: f64,
    /// Time that its board saw: hours in which nothing but cycles pass may be lapsed, s.
    pub lived_s: f64,
    /// What the machine was doing.
    pub doing: Doing,
    /// Temperatures of winding and cage, degC.
    pub degc: [f64; 2],
}

/// How long steady conditions are taken for straight lines, s.
const KNOT_S: f64 = 1.0;
/// Standard deviation and memory of the supply's voltage (share), frequency (Hz) and unbalance.
const VOLTAGE_WANDERS: (f64, f64) = (0.006, 60.0);
const FREQUENCY_WANDERS: (f64, f64) = (0.02, 120.0);
const UNBALANCE_WANDERS: (f64, f64) = (0.0008, 300.0);
/// Daily swing of the voltage, share.
const VOLTAGE_OF_A_DAY: f64 = 0.02;
/// A machine starts with its load, but with this share of the rated torque at the most.
const STARTS_WITH: f64 = 0.3;
/// After a start the load comes within this time, s.
const LOADED_WITHIN_S: f64 = 15.0;
/// Share of the changes of a load that are seconds of swings.
const SWINGS: f64 = 0.2;
/// Standard deviation and memory of a friction that is declared: grease warms and moves.
const FRICTION_WANDERS: (f64, f64) = (0.005, 600.0);

/// In a lapse resistances change no faster than this share a second of the board's time; the monitor allows 0.2 %.
const LAPSED_RATE: f64 = 1e-3;
/// Change of a copper resistance with its temperature, share a kelvin.
const PER_KELVIN: f64 = 3.9e-3;

/// Of a rest the board sees so much, s: by then a winding may have any temperature.
const DARK_SEEN_S: f64 = 200.0;

/// How long a machine ran, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ran {
    /// By the calendar.
    pub calendar_s: f64,
    /// In cycles and samples.
    pub lived_s: f64,
}

/// Lets a machine live for `days`; `each` hears of every report of its monitor.
///
/// In steady hours up to `lapse` seconds of the calendar pass in one second of cycles, as long as temperatures change slowly and no
/// load ramps: day, temperatures and what happens go by the calendar, noise and what wanders by the cycles.
pub fn live(
    watched: &Watched,
    days: f64,
    lapse: f64,
    each: &mut dyn FnMut(&Moment, &Report),
) -> Ran {
    let mut random = Pcg64::seed_from_u64(!watched.machine.seed);
    let runs = watched.machine.habits.runs(days, &mut random);
    let mut life = Life::new(watched, random, each);
    life.lapse = lapse;
    let mut ran = Ran::default();
    for (turn, (from_s, to_s)) in runs.into_iter().enumerate() {
        life.backwards = watched.machine.habits.reverses && turn % 2 == 1;
        life.rest_until(from_s);
        let before_s = life.lived_s;
        life.run_until(to_s);
        ran.calendar_s += to_s - from_s;
        ran.lived_s += life.lived_s - before_s;
    }
    ran
}

struct Life<'w> {
    watched: &'w Watched,
    random: Pcg64,
    each: &'w mut dyn FnMut(&Moment, &Report),
    state: MonitorState,
    t_s: f64,
    lived_s: f64,
    lapse: f64,
    backwards: bool,
    doing: Doing,
    /// Load and where it goes, shares of rated torque, and how fast, 1/s.
    load: f64,
    load_to: f64,
    load_rate: f64,
    /// Beside the ordinary day's: share of voltage, unbalance.
    tap: f64,
    unbalance_step: Complex64,
    voltage: Wander,
    frequency: Wander,
    unbalance: [Wander; 2],
    torque: Wander,
    friction: Wander,
    bodies: [Body; 2],
    /// Lengths of the currents of the latest steady point, A.
    amps: [f64; 2],
    /// Where the voltage lies seen from the oscillator.
    reference: Complex64,
}

impl<'w> Life<'w> {
    fn new(
        watched: &'w Watched,
        mut random: Pcg64,
        each: &'w mut dyn FnMut(&Moment, &Report),
    ) -> Life<'w> {
        let machine = &watched.machine;
        let (heat, habits) = (&machine.heat, &machine.habits);
        let wander =
            |(sigma, forgets): (f64, f64), random: &mut Pcg64| Wander::new(sigma, forgets, random);
        let body = |k: usize| {
            Body::new(
                heat.hall_degc[0],
                heat.constant_s[k],
                2.5 * heat.constant_s[k],
            )
        };
        Life {
            watched,
            each,
            state: MonitorState::default(),
            t_s: 0.0,
            lived_s: 0.0,
            lapse: 1.0,
            backwards: false,
            doing: Doing::Steady,
            load: habits.load,
            load_to: habits.load,
            load_rate: 0.0,
            tap: 0.0,
            unbalance_step: Complex64::ZERO,
            voltage: wander(VOLTAGE_WANDERS, &mut random),
            frequency: wander(FREQUENCY_WANDERS, &mut random),
            unbalance: [0; 2].map(|_| wander(UNBALANCE_WANDERS, &mut random)),
            torque: wander((habits.load_wander, habits.load_forgets_s), &mut random),
            friction: wander(FRICTION_WANDERS, &mut random),
            bodies: [body(0), body(1)],
            amps: [0.0; 2],
            reference: Complex64::ONE,
            random,
        }
    }

    fn rest_until(&mut self, until_s: f64) {
        self.see_darkness(until_s - self.t_s);
        while self.t_s < until_s {
            let seconds = (until_s - self.t_s).min(60.0);
            self.warm(seconds, false);
            self.wander(seconds);
            self.lived_s += seconds;
        }
    }

    /// The board goes on while its motor rests: what it knew of the temperature gets old.
    fn see_darkness(&mut self, seconds: f64) {
        let dark = Sample {
            u_s_abc: Some(Abc::default()),
            i_s_abc: Some(Abc::default()),
            speed: SpeedSample::RadPerSecond(0.0),
            ..Sample::default()
        };
        for _ in 0..(seconds.min(DARK_SEEN_S) / T_SAMPLE_S) as usize {
            let _ = self.watched.monitor.update(&mut self.state, &dark);
        }
    }

    fn run_until(&mut self, until_s: f64) {
        let heat = self.watched.machine.heat;
        self.bodies[1].degc += heat.start_k;
        let load = self.load;
        self.load = load.min(STARTS_WITH);
        let at = self.conditions();
        self.happen(Event::Start, at, at);
        self.go_to(load, LOADED_WITHIN_S);
        let habits = self.watched.machine.habits.clone();
        let mut load_at_s = self.t_s + exponential(habits.load_change_s, &mut self.random);
        let mut supply_at_s = self.t_s + exponential(habits.supply_event_s, &mut self.random);
        while self.t_s < until_s {
            self.steady_until(until_s.min(load_at_s).min(supply_at_s));
            if self.t_s >= load_at_s {
                self.change_load();
                load_at_s = self.t_s + exponential(habits.load_change_s, &mut self.random);
            }
            if self.t_s >= supply_at_s {
                self.change_supply();
                supply_at_s = self.t_s + exponential(habits.supply_event_s, &mut self.random);
            }
        }
        let at = self.conditions();
        self.happen(Event::Stop, at, at);
    }

    fn go_to(&mut self, load: f64, seconds: f64) {
        self.load_to = load;
        self.load_rate = (load - self.load) / seconds;
    }

    fn change_load(&mut self) {
        let habits = &self.watched.machine.habits;
        let [low, high] = habits.load_range;
        let load = self.random.random_range(low..high);
        if self.watched.machine.declares_friction() {
            return;
        }
        if self.random.random_bool(SWINGS) {
            let at = self.conditions();
            self.happen(Event::LoadSwing, at, at);
        } else if self.random.random_bool(habits.sudden) {
            let from = self.conditions();
            (self.load, self.load_to, self.load_rate) = (load, load, 0.0);
            let to = self.conditions();
            self.happen(Event::LoadStep, from, to);
        } else {
            let seconds = self.random.random_range(20.0..300.0);
            self.go_to(load, seconds);
        }
    }

    fn change_supply(&mut self) {
        let from = self.conditions();
        match self.random.random_range(0..10) {
            0..4 => self.happen(Event::Dip, from, from),
            4 => self.happen(Event::Interruption, from, from),
            5..8 => {
                self.tap = 0.02 * signed(&mut self.random);
                let to = self.conditions();
                self.happen(Event::VoltageStep, from, to);
            }
            _ => {
                let size = self.random.random_range(0.0..0.01);
                let angle = self.random.random_range(0.0..std::f64::consts::TAU);
                self.unbalance_step = Complex64::from_polar(size, angle);
                self.doing = Doing::Unbalance;
            }
        }
    }

    /// Steady conditions now.
    fn conditions(&self) -> Conditions {
        let machine = &self.watched.machine;
        let plate = &machine.truth.nameplate;
        let day = (std::f64::consts::TAU * self.t_s / DAY_S).sin();
        let share = machine.voltage + self.tap + VOLTAGE_OF_A_DAY * day + self.voltage.value;
        let [re, im] = self.unbalance.map(|wander| wander.value);
        let (torque, friction) = match machine.truth.load {
            LoadKind::Friction => (0.0, 1.0 + self.friction.value),
            _ => ((self.load + self.torque.value).max(0.0), 1.0),
        };
        Conditions {
            volt: share * plate.phase_voltage_amplitude(),
            hertz: plate.frequency_hz + self.frequency.value,
            unbalance: machine.unbalance + self.unbalance_step + Complex64::new(re, im),
            torque: torque * plate.torque_nm,
            friction,
            degc: self.degc(),
            cabinet_degc: self.hall_degc() + machine.heat.cabinet_k,
        }
    }

    /// Temperatures of winding and cage now, degC.
    fn degc(&self) -> [f64; 2] {
        let own = self.bodies.map(|body| body.degc);
        self.watched.machine.heat.shared(own)
    }

    /// The afternoon is warmest.
    fn hall_degc(&self) -> f64 {
        let [mean, swing] = self.watched.machine.heat.hall_degc;
        mean + swing * (std::f64::consts::TAU * (self.t_s / DAY_S - 0.375)).sin()
    }

    /// Lets time pass for temperatures.
    fn warm(&mut self, seconds: f64, running: bool) {
        let hall = self.hall_degc();
        let targets = [0, 1].map(|k| self.target_degc(k, hall, running));
        for (body, target) in self.bodies.iter_mut().zip(targets) {
            body.step(seconds, target, running);
        }
        self.t_s += seconds;
    }

    /// How many seconds of the calendar pass in one of cycles now.
    fn lapse(&self) -> f64 {
        if self.load_rate != 0.0 || self.doing == Doing::Unbalance {
            return 1.0;
        }
        let hall = self.hall_degc();
        let fastest = (0..2).map(|k| self.kelvin_per_second(k, hall).abs() * PER_KELVIN);
        let fastest = fastest.fold(f64::MIN_POSITIVE, f64::max);
        (LAPSED_RATE / fastest).clamp(1.0, self.lapse)
    }

    fn kelvin_per_second(&self, k: usize, hall: f64) -> f64 {
        self.bodies[k].rate(self.target_degc(k, hall, true))
    }

    /// Temperature that winding (0) or cage (1) would come to.
    fn target_degc(&self, k: usize, hall: f64, running: bool) -> f64 {
        let machine = &self.watched.machine;
        let rated = machine.truth.nameplate.current_amplitude();
        let share = if running { self.amps[k] / rated } else { 0.0 };
        hall + machine.heat.rise_k[k] * share * share
    }

    /// Lets what wanders go on.
    fn wander(&mut self, seconds: f64) {
        let wanders = [
            &mut self.voltage,
            &mut self.frequency,
            &mut self.torque,
            &mut self.friction,
        ];
        for wander in wanders.into_iter().chain(&mut self.unbalance) {
            wander.step(seconds, &mut self.random);
        }
    }

    fn load_moves(&mut self, seconds: f64) {
        let left = self.load_to - self.load;
        let step = self.load_rate * seconds;
        if step.abs() >= left.abs() {
            (self.load, self.load_rate) = (self.load_to, 0.0);
        } else {
            self.load += step;
        }
    }

    fn shows(&self) -> Option<Shows> {
        let machine = &self.watched.machine;
        let at = self.conditions();
        shows(&machine.truth, &machine.instrument, &machine.harmonics, &at).ok()
    }

    /// Cycle by cycle, from knot to knot.
    fn steady_until(&mut self, until_s: f64) {
        let Watched {
            machine, config, ..
        } = self.watched;
        let mut cycles = Cycles::new(
            &machine.instrument,
            config,
            self.reference,
            self.backwards,
            &mut self.random,
        );
        let Some(mut from) = self.shows() else {
            self.t_s = until_s;
            return;
        };
        if self.doing != Doing::Unbalance {
            self.doing = Doing::Steady;
        }
        let mut begun = 0.0;
        while self.t_s < until_s {
            let began = (self.t_s, self.lived_s);
            self.amps = from.amps;
            let lapse = self.lapse();
            self.load_moves(KNOT_S);
            self.warm(lapse * KNOT_S, true);
            self.wander(KNOT_S);
            self.lived_s += KNOT_S;
            let to = self.shows().unwrap_or(from);
            begun = self.knot(&mut cycles, &from, &to, began, begun);
            self.doing = if self.load_rate == 0.0 {
                Doing::Steady
            } else {
                Doing::Ramp
            };
            from = to;
        }
    }

    /// All cycles that begin between two knots, the first after a share of `begun`; returns how far the last one reaches beyond.
    fn knot(
        &mut self,
        cycles: &mut Cycles,
        from: &Shows,
        to: &Shows,
        (began_s, lived_s): (f64, f64),
        begun: f64,
    ) -> f64 {
        let degc = self.degc();
        let mut share = begun;
        while share < 1.0 {
            let length = 1.0 / (from.hertz * KNOT_S);
            let middle = (share + 0.5 * length).min(1.0);
            let cycle = cycles.cycle(from, to, middle, &mut self.random);
            let report = self.watched.monitor.update_cycle(&mut self.state, &cycle);
            share += length;
            let moment = Moment {
                t_s: began_s + share * (self.t_s - began_s),
                lived_s: lived_s + share * KNOT_S,
                doing: self.doing,
                degc,
            };
            (self.each)(&moment, &report);
        }
        share - 1.0
    }

    /// An event, sample by sample; one that the motor cannot live through does not happen.
    fn happen(&mut self, event: Event, from: Conditions, to: Conditions) {
        let Watched {
            machine,
            config,
            monitor,
            ..
        } = self.watched;
        let staged = Staged {
            machine,
            event,
            from,
            to,
        };
        let Ok(simulation) = staged.simulation(&mut self.random) else {
            return;
        };
        self.doing = Doing::Event(event);
        self.state.resume_after_gap();
        let began_s = self.t_s;
        let degc = self.degc();
        let mut last = 0.0;
        for (simulated, sample) in Shown::new(
            simulation,
            config.converter,
            &machine.instrument,
            self.backwards,
        ) {
            last = simulated.t;
            let Some(report) = monitor.update(&mut self.state, &sample) else {
                continue;
            };
            if let Some(window) = &report.window {
                let u = window.u_s.positive;
                let angle = f64::from(u.im.atan2(u.re));
                self.reference = Complex64::from_polar(1.0, angle);
            }
            let moment = Moment {
                t_s: began_s + simulated.t,
                lived_s: self.lived_s + simulated.t,
                doing: self.doing,
                degc,
            };
            (self.each)(&moment, &report);
        }
        // Steady hours go on where the event has ended: what wanders stands still meanwhile.
        self.warm(last, event != Event::Stop);
        self.lived_s += last;
    }
}
