//! What a machine's lamps and alarms came to.

use std::collections::BTreeMap;

use campaign::hours::{Doing, Event, Moment};
use fleet::alarm::{Action, AlarmCause, AlarmChange, Change, Desk, Memory, Rules};
use fleet::{Entry, MotorId, Second, lamp};
use monitor::{Lamp, Report};
use replay::causes;

/// A machine's false alarms.
#[derive(Default)]
pub struct Tally {
    pub words: String,
    /// Why its calibration was refused.
    pub refused: Option<String>,
    pub days: f64,
    /// Running, by the calendar, and in cycles and samples.
    pub ran_days: f64,
    pub lived_days: f64,
    pub windows: u64,
    pub judged: u64,
    /// How often each event happened.
    pub events: BTreeMap<Event, u64>,
    /// FAULT that came, and SENSOR.
    pub faults: Vec<Lit>,
    pub sensors: Vec<Lit>,
    /// Alarms of the desk, of FAULT and of SENSOR.
    pub alarms: [u64; 2],
    /// Judged windows of steady hours by their departure over the limit of FAULT, in tenths of it.
    pub departures: [u64; 10],
}

/// A lamp that came.
#[derive(Clone)]
pub struct Lit {
    pub doing: Doing,
    pub cause: String,
    pub t_s: f64,
    pub degc: [f64; 2],
    /// Departure in standard deviations; NaN where none was computed.
    pub significance: f32,
    /// Time since what happens had begun, s, and what the window measured.
    pub since_s: f64,
    pub window: String,
}

/// Hears the reports of one machine.
pub struct Listener {
    tally: Tally,
    was: [bool; 2],
    doing: Option<Doing>,
    doing_since_s: f64,
    desk: Desk,
    motor: MotorId,
    second: Second,
    /// Of FAULT, standard deviations.
    limit: f32,
}

/// Milliseconds of the desk's clock at the beginning: any Monday.
const BEGIN_MS: i64 = 1_790_000_000_000;

impl Listener {
    pub fn new(tally: Tally, limit: f32) -> Listener {
        Listener {
            tally,
            was: [false; 2],
            doing: None,
            doing_since_s: 0.0,
            desk: Desk::new(Rules::default(), Vec::new(), Memory::default()),
            motor: "machine".parse().expect("a name"),
            second: Second {
                start: 1,
                ..Second::default()
            },
            limit,
        }
    }

    pub fn hear(&mut self, moment: &Moment, report: &Report) {
        self.tally.windows += 1;
        self.tally.judged += u64::from(report.is_judged());
        self.count_event(moment);
        self.count_departure(moment, report);
        let lamps = [report.lamps.fault, report.lamps.sensor];
        for (k, lit) in lamps.map(|lamp| lamp == Lamp::On).into_iter().enumerate() {
            if lit && !self.was[k] {
                let mut came = came(moment, report);
                came.since_s = moment.lived_s - self.doing_since_s;
                let list = match k {
                    0 => &mut self.tally.faults,
                    _ => &mut self.tally.sensors,
                };
                list.push(came);
            }
            self.was[k] = lit;
        }
        self.close_second_before(moment);
        let places = [lamp::FAULT, lamp::SENSOR];
        for (place, lamp) in places.into_iter().zip(lamps) {
            self.second.lamps = brighter(self.second.lamps, place, lamp);
        }
        self.second.windows = self.second.windows.saturating_add(1);
        self.second.judged = self
            .second
            .judged
            .saturating_add(u8::from(report.is_judged()));
    }

    pub fn finish(mut self) -> Tally {
        self.tell_desk();
        self.tally
    }

    fn count_departure(&mut self, moment: &Moment, report: &Report) {
        let steady = !matches!(moment.doing, Doing::Event(_)) && report.is_judged();
        if let Some(isolation) = report.isolation.filter(|_| steady) {
            let tenth = 10.0 * isolation.significance / self.limit;
            let last = self.tally.departures.len() - 1;
            // What is beyond the limit counts with the last tenth.
            self.tally.departures[(tenth as usize).min(last)] += 1;
        }
    }

    fn count_event(&mut self, moment: &Moment) {
        if self.doing == Some(moment.doing) {
            return;
        }
        if let Doing::Event(event) = moment.doing {
            *self.tally.events.entry(event).or_default() += 1;
        }
        self.doing = Some(moment.doing);
        self.doing_since_s = moment.lived_s;
    }

    /// The board's second ends when a report of a later one comes.
    fn close_second_before(&mut self, moment: &Moment) {
        let number = moment.lived_s.floor() as u32 + 1;
        if number == self.second.number {
            return;
        }
        if self.second.number > 0 {
            self.tell_desk();
        }
        self.second = Second {
            start: 1,
            number,
            time_ms: BEGIN_MS + i64::from(number) * 1000,
            ..Second::default()
        };
    }

    /// The gateway's alarms; an operator acknowledges at once.
    fn tell_desk(&mut self) {
        let time_ms = self.second.time_ms;
        let told = self
            .desk
            .take(&self.motor, &Entry::Second(self.second.clone()));
        let ticked = self.desk.tick(time_ms);
        for change in told.iter().chain(&ticked) {
            self.count_alarm(change, time_ms);
        }
    }

    fn count_alarm(&mut self, change: &AlarmChange, time_ms: i64) {
        if change.change != Change::Raised {
            return;
        }
        match change.alarm.cause {
            AlarmCause::Fault => self.tally.alarms[0] += 1,
            AlarmCause::Sensor => self.tally.alarms[1] += 1,
            _ => {}
        }
        let number = change.alarm.number;
        self.desk
            .act(number, &Action::Acknowledge, "operator", "", time_ms)
            .expect("it is there");
    }
}

fn came(moment: &Moment, report: &Report) -> Lit {
    let candidates = causes::of_report(report, &[], false);
    let likeliest = candidates.first();
    let cause = match likeliest {
        _ if report.rotor.is_broken => "bars".to_owned(),
        Some(first) => {
            let phase = first
                .phase
                .map_or(String::new(), |phase| format!(" {phase}"));
            format!("{}{phase}", first.fault.name())
        }
        None => "not named".to_owned(),
    };
    let cause = match report.sensor {
        Some(finding) => format!("{cause} ({finding:?})"),
        None => cause,
    };
    Lit {
        doing: moment.doing,
        cause,
        t_s: moment.t_s,
        degc: moment.degc,
        significance: report
            .isolation
            .map_or(f32::NAN, |isolation| isolation.significance),
        since_s: 0.0,
        window: measured(report),
    }
}

fn measured(report: &Report) -> String {
    let Some(window) = &report.window else {
        return format!("no window, {:?}", report.not_judged);
    };
    let residuals = report
        .residuals
        .map_or([f32::NAN; 4], |residuals| residuals.r);
    format!(
        "{:.1} V, {:.2} A, {:.2} Hz, {:.1} rad/s, unbalance {:.1} %, r {:.2?} %, warmer by {:.3}, {:.1} at any temperature, {}",
        window.u_s.positive.norm(),
        window.i_s.positive.norm(),
        window.omega_sync / std::f32::consts::TAU,
        window.shaft_speed().unwrap_or(f32::NAN),
        100.0 * window.i_s.negative.norm() / window.i_s.positive.norm(),
        residuals.map(|r| 100.0 * r),
        report
            .isolation
            .map_or(f32::NAN, |isolation| isolation.heating.rise),
        report
            .isolation
            .map_or(f32::NAN, |isolation| isolation.at_any_temperature),
        report
            .not_judged
            .map_or("judged".to_owned(), |why| format!("{why:?}"))
    )
}

/// Lamps with one of them as bright as it was, or brighter: on, then blinking, then off.
fn brighter(lamps: u32, place: u32, lamp: Lamp) -> u32 {
    let now = match lamp {
        Lamp::Off => 0,
        Lamp::On => 1,
        Lamp::Blink => 2,
    };
    let before = lamps >> (2 * place) & 3;
    let brightest = match (before, now) {
        (1, _) | (_, 1) => 1,
        _ => before.max(now),
    };
    lamps & !(3 << (2 * place)) | brightest << (2 * place)
}
