//! What a made-up motor does, second by second: rest and running, a start, load that wanders, windings that warm up, a supply
//! that varies, and in some of them a fault that grows.
//!
//! Its numbers are plausible and no more: it feeds the way from a board to the store and to pages. Nothing about detection
//! can be concluded from it; the physical simulation is in the crate `scenario`.

use monitor::Reason;
use motor::FaultId;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg32;

/// What lights a lamp, share of a residual's scale.
const THRESHOLD: f32 = 0.05;
/// Noise of one window's residual, share of its scale, standard deviation.
const NOISE: f32 = 0.006;
/// Residual of a grown fault, share of its scale.
const GROWN: f32 = 0.15;
/// A fault grows within this time, s.
const GROWTH_S: f32 = 60.0;
/// A motor runs up within this time, s.
const START_S: u32 = 3;
/// Time constant of the windings, s.
const WARM_S: f32 = 1_200.0;
/// Residual of a warm winding: what its resistance has risen by, as far as the model does not follow.
const WARM: f32 = 0.012;
/// Share of its current that a motor draws without load.
const MAGNETISING: f32 = 0.4;
/// Seconds for which a residual must be beyond its threshold before FAULT lights.
const PERSISTENCE_S: u32 = 3;

/// What a motor shows in a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    /// Phase voltage, V RMS; 0 while it is switched off.
    pub voltage_volt: f32,
    /// Phase current, A RMS.
    pub current_amp: f32,
    /// Of the supply, Hz; NaN while there is none.
    pub supply_hz: f32,
    /// 1/min.
    pub speed_rpm: f32,
    /// Mean residuals; `None` where nothing is judged.
    pub residuals: Option<[f32; 4]>,
    /// Number of the reason why nothing is judged; 0 where it is.
    pub not_judged: u16,
    /// Lamps r1 to r4.
    pub lit: [bool; 4],
    /// FAULT, with the number of its likely cause.
    pub fault: Option<u16>,
}

/// A motor.
#[derive(Clone, Debug)]
pub(super) struct Life {
    rng: Pcg32,
    rated_volt: f32,
    rated_amp: f32,
    rated_slip: f32,
    pole_pairs: f32,
    load: f32,
    warmth: f32,
    supply: f32,
    /// Seconds since it was switched on or, negative, until it is.
    running_s: i64,
    /// When it is switched on or off next, s.
    switch_in_s: u32,
    fault: Option<(FaultId, u32)>,
    since_fault_s: u32,
    beyond_s: u32,
}

fn number(reason: Reason) -> u16 {
    u16::from(reason.number())
}

impl Life {
    /// One that begins to fail after `fault_s`, where that is given.
    pub fn new(mut rng: Pcg32, fault_s: Option<u32>) -> Self {
        let faults: Vec<_> = FaultId::ALL
            .into_iter()
            .filter(|fault| fault.published_pattern().is_some())
            .collect();
        let fault = fault_s.map(|at| (faults[rng.random_range(0..faults.len())], at));
        Life {
            rated_volt: 230.9,
            rated_amp: rng.random_range(1.5..60.0),
            rated_slip: rng.random_range(0.015..0.06),
            pole_pairs: rng.random_range(1_u8..=3).into(),
            load: rng.random_range(0.4..0.9),
            warmth: rng.random_range(0.0..1.0),
            supply: 0.0,
            running_s: 3_600,
            switch_in_s: rng.random_range(300..14_400),
            fault,
            since_fault_s: 0,
            beyond_s: 0,
            rng,
        }
    }

    /// The next second.
    pub fn step(&mut self) -> Moment {
        self.switch();
        self.wander();
        let running = self.running_s >= 0;
        let starting = running && self.running_s < i64::from(START_S);
        let residuals = (running && !starting).then(|| self.residuals());
        let lit = residuals.map_or([false; 4], |r| r.map(|r| r.abs() > THRESHOLD));
        Moment {
            residuals,
            lit,
            fault: self.judge(lit, residuals.is_some()),
            not_judged: match (running, starting) {
                (false, _) => number(Reason::NotLocked),
                (true, true) => number(Reason::Transient),
                (true, false) => 0,
            },
            ..self.measured(running, starting)
        }
    }

    /// Its board started again: what that had seen of residuals is lost.
    pub fn forget(&mut self) {
        self.beyond_s = 0;
    }

    /// A normal deviate of one window.
    pub fn deviate(&mut self) -> f32 {
        StandardNormal.sample(&mut self.rng)
    }

    /// Noise of one window's residuals.
    pub fn noise(&mut self) -> f32 {
        NOISE * self.deviate()
    }

    fn switch(&mut self) {
        self.switch_in_s = self.switch_in_s.saturating_sub(1);
        if self.switch_in_s == 0 {
            let on = self.running_s < 0;
            self.running_s = if on { 0 } else { -1 };
            let times = if on { 300..14_400 } else { 20..600 };
            self.switch_in_s = self.rng.random_range(times);
        } else if self.running_s >= 0 {
            self.running_s += 1;
        }
    }

    /// Load and supply are mean-reverting random walks; the windings follow the square of the load.
    fn wander(&mut self) {
        let (load, supply) = (self.deviate(), self.deviate());
        self.load = (self.load + 0.01 * (0.65 - self.load) + 0.01 * load).clamp(0.1, 1.1);
        self.supply = self.supply * 0.99 + 0.1 * supply;
        let heat = if self.running_s >= 0 {
            self.load * self.load
        } else {
            0.0
        };
        self.warmth += (heat - self.warmth) / WARM_S;
        if let Some((_, in_s)) = &mut self.fault {
            match in_s {
                0 => self.since_fault_s += 1,
                _ => *in_s -= 1,
            }
        }
    }

    fn residuals(&mut self) -> [f32; 4] {
        let warm = WARM * self.warmth;
        let healthy = [warm, 0.0, 0.3 * warm, 0.5 * warm];
        let pattern = self.fault.and_then(|(fault, _)| fault.published_pattern());
        let grown = GROWN * (self.since_fault_s as f32 / GROWTH_S).min(1.0);
        std::array::from_fn(|k| {
            let lit = pattern.is_some_and(|pattern| pattern[k]);
            healthy[k] + if lit { grown } else { 0.0 }
        })
    }

    /// The likely fault once a residual has been beyond its threshold for long enough.
    fn judge(&mut self, lit: [bool; 4], judged: bool) -> Option<u16> {
        match lit.contains(&true) {
            true => self.beyond_s += 1,
            false if judged => self.beyond_s = 0,
            false => {}
        }
        let number = self.fault.map_or(0, |(fault, _)| fault.number());
        (self.beyond_s >= PERSISTENCE_S).then_some(number)
    }

    fn measured(&self, running: bool, starting: bool) -> Moment {
        let hz = 50.0 + 0.02 * self.supply;
        let synchronous_rpm = 60.0 * hz / self.pole_pairs;
        let share = self.running_s as f32 / START_S as f32;
        let load = (1.0 - MAGNETISING * MAGNETISING) * self.load * self.load;
        let (current, speed) = match (running, starting) {
            (false, _) => (0.0, 0.0),
            (true, true) => (6.0 - 2.0 * share, share),
            (true, false) => (
                (MAGNETISING * MAGNETISING + load).sqrt(),
                1.0 - self.rated_slip * self.load,
            ),
        };
        Moment {
            voltage_volt: if running {
                self.rated_volt * (1.0 + 0.01 * self.supply)
            } else {
                0.0
            },
            current_amp: current * self.rated_amp,
            supply_hz: if running { hz } else { f32::NAN },
            speed_rpm: speed * synchronous_rpm,
            residuals: None,
            not_judged: 0,
            lit: [false; 4],
            fault: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn lives(fault_s: Option<u32>) -> impl Iterator<Item = Life> {
        (0..20).map(move |seed| Life::new(Pcg32::seed_from_u64(seed), fault_s))
    }

    #[test]
    fn a_healthy_motor_starts_rests_and_never_shows_a_fault() {
        let mut seen = [false; 3];
        for mut life in lives(None) {
            for _ in 0..20_000 {
                let moment = life.step();
                seen[0] |= moment.not_judged == number(Reason::Transient);
                seen[1] |= moment.not_judged == number(Reason::NotLocked);
                seen[2] |= moment.not_judged == 0;
                assert_eq!((moment.lit, moment.fault), ([false; 4], None));
                assert_eq!(moment.residuals.is_some(), moment.not_judged == 0);
            }
        }
        assert_eq!(seen, [true; 3]);
    }

    #[test]
    fn a_fault_lights_the_lamps_of_its_row_and_then_fault() {
        for mut life in lives(Some(100)) {
            let (fault, _) = life.fault.expect("a fault");
            let pattern = fault.published_pattern();
            let moments: Vec<_> = (0..400).map(|_| life.step()).collect();
            assert!(moments[..100].iter().all(|moment| moment.fault.is_none()));
            let judged = moments.iter().rev().find(|moment| moment.not_judged == 0);
            let last = judged.expect("it runs");
            assert_eq!(
                (Some(last.lit), last.fault),
                (pattern, Some(fault.number()))
            );
        }
    }
}
