//! Runs that supply and load allow: standard ones, random ones, and small changes.

use super::limits::Limits;
use super::plan::{Level, Plan};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Shortest time at a level, s: the motor settles and shows some blocks.
const DWELL: f64 = 0.6;
/// Time that a coast-down takes at the end, s.
const COAST: f64 = 1.2;
/// Time of a change of a drive's frequency, s.
const RAMP: f64 = 0.4;
/// Time of a drive's start, s.
const START: f64 = 1.0;
/// Steps between the lowest and the highest of what may be set.
const GRADES: usize = 4;

/// Draws runs.
pub(super) struct Family {
    limits: Limits,
    rng: Pcg64,
}

impl Family {
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            rng: Pcg64::seed_from_u64(8372),
        }
    }

    fn between([low, high]: [f64; 2], grade: usize) -> f64 {
        low + (high - low) * grade as f64 / GRADES as f64
    }

    /// A level by its grades of load, voltage and frequency.
    fn level(&self, at_s: f64, [load, voltage, frequency]: [usize; 3]) -> Level {
        let l = &self.limits;
        let frequency_hz = Self::between(l.frequency_hz, frequency);
        let own = match l.drive {
            true => frequency_hz / l.frequency_hz[1].max(1e-9),
            false => 1.0,
        };
        Level {
            at_s,
            ramp_s: match (l.drive, at_s > 0.0) {
                (true, true) => RAMP,
                _ => 0.0,
            },
            load: Self::between(l.load, load),
            voltage: own * Self::between(l.voltage, voltage),
            frequency_hz,
        }
    }

    /// A run through these grades, equally long each.
    fn through(&self, grades: &[[usize; 3]], coasts: bool) -> Plan {
        let l = &self.limits;
        let coasts = coasts && l.coast_down;
        let end = l.duration_s - if coasts { COAST } else { 0.0 };
        let mut levels = Vec::new();
        let mut begin = 0.0;
        if l.drive && l.start {
            // From nearly nothing, without load.
            levels.push(Level {
                voltage: 0.04,
                frequency_hz: 1.0,
                ..self.level(0.0, [0, GRADES, 0])
            });
            begin = 0.1;
        }
        let each = (end - begin) / grades.len() as f64;
        for (k, grades) in grades.iter().enumerate() {
            let mut level = self.level(begin + each * k as f64, *grades);
            if k == 0 && l.drive && l.start {
                level.ramp_s = START.min(0.6 * each);
            }
            levels.push(level);
        }
        Plan {
            drive: l.drive,
            starts: l.start,
            levels,
            off_s: coasts.then_some(end),
            duration_s: l.duration_s,
        }
    }

    /// The runs that a person would try first.
    pub fn standard(&self) -> Vec<(&'static str, Plan)> {
        let top = GRADES;
        let loads: Vec<[usize; 3]> = (0..=top).map(|load| [load, top, top]).collect();
        let voltages: Vec<[usize; 3]> = (0..=top).map(|voltage| [0, voltage, top]).collect();
        let frequencies: Vec<[usize; 3]> = (0..=top).map(|f| [top / 2, top, f]).collect();
        let mut all = vec![
            ("a start and loads", self.through(&loads, false)),
            (
                "no load, and a coast-down",
                self.through(&[[0, top, top]], true),
            ),
            (
                "half and full load",
                self.through(&[[top / 2, top, top], [top, top, top]], false),
            ),
        ];
        if self.limits.voltage[1] > self.limits.voltage[0] {
            all.push((
                "a sweep of the voltage without load",
                self.through(&voltages, true),
            ));
        }
        if self.limits.drive {
            all.push((
                "a sweep of the frequency at half load",
                self.through(&frequencies, false),
            ));
        }
        all
    }

    /// A random run.
    pub fn random(&mut self) -> Plan {
        let most = (self.limits.duration_s / DWELL) as usize;
        let count = self.rng.random_range(2..=most.clamp(2, 8));
        let mut grade = || self.rng.random_range(0..=GRADES);
        let mut grades: Vec<[usize; 3]> = (0..count).map(|_| [grade(), grade(), grade()]).collect();
        if self.limits.start {
            // A start against the full load may not come to speed.
            grades[0][0] = 0;
        }
        let coasts = self.rng.random_range(0..2) == 0;
        self.through(&grades, coasts)
    }

    /// A run with one level moved.
    pub fn changed(&mut self, plan: &Plan) -> Plan {
        let first = plan.levels.len() - plan.levels.len().saturating_sub(1).max(1);
        let k = self
            .rng
            .random_range(first.min(plan.levels.len() - 1)..plan.levels.len());
        let grades = [0; 3].map(|_| self.rng.random_range(0..=GRADES));
        let mut changed = plan.clone();
        let old = plan.levels[k];
        let mut level = self.level(old.at_s, grades);
        level.ramp_s = old.ramp_s;
        if self.limits.start && k <= 1 {
            level.load = self.limits.load[0];
        }
        match self.rng.random_range(0..3) {
            0 => changed.levels[k].load = level.load,
            1 => {
                (changed.levels[k].voltage, changed.levels[k].frequency_hz) =
                    (level.voltage, level.frequency_hz)
            }
            _ => changed.levels[k] = level,
        }
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever is drawn stays within the limits, begins at 0 and gets everywhere in time.
    #[test]
    fn runs_stay_within_the_limits() {
        for drive in [false, true] {
            let mut limits = Limits::usual(drive, 50.0);
            (limits.load, limits.voltage) = ([0.1, 0.8], [0.8, 1.1]);
            let mut family = Family::new(limits);
            let mut plans: Vec<Plan> = family
                .standard()
                .into_iter()
                .map(|(_, plan)| plan)
                .collect();
            for _ in 0..200 {
                let plan = family.random();
                plans.push(family.changed(&plan));
                plans.push(plan);
            }
            for plan in plans {
                assert_eq!(plan.levels[0].at_s, 0.0);
                assert!(plan.levels.is_sorted_by(|a, b| a.at_s + a.ramp_s < b.at_s));
                let skip = usize::from(drive);
                for level in &plan.levels[skip..] {
                    assert!((0.1..=0.8).contains(&level.load), "{level:?}");
                    let own = if drive {
                        level.frequency_hz / 50.0
                    } else {
                        1.0
                    };
                    assert!(level.voltage <= 1.1 * own + 1e-9 && level.voltage >= 0.8 * own - 1e-9);
                }
                assert!(plan.off_s.is_none_or(|off| !drive && off < plan.duration_s));
            }
        }
    }
}
