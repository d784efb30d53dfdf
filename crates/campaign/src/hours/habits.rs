//! What a machine does all day: when it runs, how its load goes, what happens to its supply.

use rand::Rng;
use rand_pcg::Pcg64;

use super::weather::log_between;

/// Seconds of an hour, and of a day.
pub(super) const HOUR_S: f64 = 3600.0;
pub(super) const DAY_S: f64 = 24.0 * HOUR_S;

/// When a machine runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Running {
    /// Day and night, with a stop once in so many s.
    Always(f64),
    /// In shifts, so many a day; every so many s it stands for a while. Free days of a week.
    Shifts(u32, f64, u32),
    /// In shifts, on and off all the time: means of running and of standing, s.
    OnAndOff(u32, f64, f64),
}

/// What a machine does.
#[derive(Clone, Debug)]
pub(super) struct Habits {
    pub running: Running,
    /// Whether its load is a friction, and declared as such.
    pub is_friction: bool,
    /// Every other run goes the other way.
    pub reverses: bool,
    /// Ordinary load, share of rated torque.
    pub load: f64,
    /// How far the load goes from that, and how far it wanders: shares of rated torque.
    pub load_range: [f64; 2],
    pub load_wander: f64,
    /// How long the load remembers, s.
    pub load_forgets_s: f64,
    /// Mean time between changes of the load, s, and the share of them that are sudden.
    pub load_change_s: f64,
    pub sudden: f64,
    /// Mean time between events of the supply, s.
    pub supply_event_s: f64,
}

impl Habits {
    pub fn draw(random: &mut Pcg64) -> Habits {
        let is_friction = random.random_bool(0.2);
        let load = random.random_range(0.1..1.0);
        let running = running(random);
        let lowest: f64 = random.random_range(0.0..load);
        Habits {
            running,
            is_friction,
            reverses: random.random_bool(0.15),
            load,
            load_range: [lowest, random.random_range(load..1.1)],
            load_wander: log_between(random, 0.002, 0.06),
            load_forgets_s: log_between(random, 20.0, 300.0),
            load_change_s: log_between(random, 300.0, 3.0 * HOUR_S),
            sudden: random.random_range(0.2..0.9),
            supply_event_s: log_between(random, 0.5 * HOUR_S, 12.0 * HOUR_S),
        }
    }

    pub fn words(&self) -> String {
        let running = match self.running {
            Running::Always(_) => "day and night".to_owned(),
            Running::Shifts(shifts, ..) => format!("{shifts} shifts"),
            Running::OnAndOff(shifts, ..) => format!("on and off in {shifts} shifts"),
        };
        let load = if self.is_friction {
            "friction"
        } else {
            "free load"
        };
        let turns = if self.reverses { ", both ways" } else { "" };
        format!("{running}, {load} {:.0} %{turns}", 100.0 * self.load)
    }

    /// Stretches in which it runs, begin and end in s, within `days`; day 0 is a Monday.
    pub fn runs(&self, days: f64, random: &mut Pcg64) -> Vec<(f64, f64)> {
        let end = days * DAY_S;
        let mut runs = Vec::new();
        let mut t = random.random_range(0.0..300.0);
        while t < end {
            let Some(open_until) = self.open_until(t) else {
                t += 300.0 * random.random_range(0.5..1.5);
                continue;
            };
            let [runs_s, stands_s] = self.means();
            let stops = (t + exponential(runs_s, random)).min(open_until).min(end);
            // What is shorter than a start is no run.
            if stops - t > SHORTEST_RUN_S {
                runs.push((t, stops));
            }
            t = stops + SHORTEST_RUN_S + exponential(stands_s, random);
        }
        runs
    }

    /// Means of running and standing, s.
    fn means(&self) -> [f64; 2] {
        match self.running {
            Running::Always(every) => [every, 1800.0],
            Running::Shifts(_, every, _) => [every, 900.0],
            Running::OnAndOff(_, runs, stands) => [runs, stands],
        }
    }

    /// Until when the machine may run at `t`; `None` in the night, on a free day.
    fn open_until(&self, t: f64) -> Option<f64> {
        let (shifts, free) = match self.running {
            Running::Always(_) => return Some(f64::INFINITY),
            Running::Shifts(shifts, _, free) => (shifts, free),
            Running::OnAndOff(shifts, ..) => (shifts, 2),
        };
        let day = (t / DAY_S).floor();
        let hour = (t - day * DAY_S) / HOUR_S;
        let weekday = day.rem_euclid(7.0);
        let closes = 6.0 + 8.0 * f64::from(shifts);
        let open = weekday < f64::from(7 - free) && (6.0..closes).contains(&hour);
        open.then_some(day * DAY_S + closes * HOUR_S)
    }
}

/// A start and what follows it until the motor is steady, s.
pub(super) const SHORTEST_RUN_S: f64 = 20.0;

fn running(random: &mut Pcg64) -> Running {
    let shifts = random.random_range(1..3);
    match random.random_range(0..10) {
        0..3 => Running::Always(log_between(random, 0.5 * DAY_S, 7.0 * DAY_S)),
        3..7 => Running::Shifts(
            shifts,
            log_between(random, 0.5 * HOUR_S, 6.0 * HOUR_S),
            random.random_range(0..3),
        ),
        _ => Running::OnAndOff(
            shifts,
            log_between(random, 120.0, 1200.0),
            log_between(random, 60.0, 900.0),
        ),
    }
}

/// A time of which nobody knows when it ends.
pub(super) fn exponential(mean_s: f64, random: &mut Pcg64) -> f64 {
    -mean_s * (1.0 - random.random::<f64>()).ln()
}
