//! A run that a person can make.

/// What holds from an instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Beginning, s.
    pub at_s: f64,
    /// Time in which supply and frequency get there, s; 0: at once.
    pub ramp_s: f64,
    /// Load, share of rated torque.
    pub load: f64,
    /// Voltage, share of rated.
    pub voltage: f64,
    /// Supply frequency, Hz.
    pub frequency_hz: f64,
}

/// A run.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What the supply is.
    pub drive: bool,
    /// Whether it begins at standstill; otherwise with the motor running at the first level.
    pub starts: bool,
    /// Levels, in their order; the first at 0.
    pub levels: Vec<Level>,
    /// When the supply is switched off, s.
    pub off_s: Option<f64>,
    /// Length, s.
    pub duration_s: f64,
}

/// Time from the beginning of the recording until the motor is switched on, s.
pub(super) const SWITCH_ON: f64 = 0.05;

impl Plan {
    /// Without levels that change nothing.
    pub(super) fn simplified(mut self) -> Self {
        let same = |a: &Level, b: &Level| {
            (a.load, a.voltage, a.frequency_hz) == (b.load, b.voltage, b.frequency_hz)
        };
        self.levels.dedup_by(|next, kept| same(next, kept));
        self
    }

    /// Whether the motor is connected.
    pub(super) fn is_on(&self, t: f64) -> bool {
        (!self.starts || t >= SWITCH_ON) && self.off_s.is_none_or(|off| t < off)
    }

    fn at(&self, t: f64, of: impl Fn(&Level) -> f64) -> f64 {
        let after = self.levels.partition_point(|level| level.at_s <= t).max(1);
        let level = &self.levels[after - 1];
        let Some(before) = after.checked_sub(2).map(|k| &self.levels[k]) else {
            return of(level);
        };
        let share = match level.ramp_s > 0.0 {
            true => ((t - level.at_s) / level.ramp_s).min(1.0),
            false => 1.0,
        };
        of(before) + share * (of(level) - of(before))
    }

    /// Voltage, share of rated; 0 while switched off.
    pub(super) fn voltage(&self, t: f64) -> f64 {
        match self.is_on(t) {
            true => self.at(t, |level| level.voltage),
            false => 0.0,
        }
    }

    /// Supply frequency, Hz.
    pub(super) fn frequency_hz(&self, t: f64) -> f64 {
        self.at(t, |level| level.frequency_hz)
    }

    /// Load, share of rated torque: nothing while the motor coasts.
    pub(super) fn load(&self, t: f64) -> f64 {
        let after = self.levels.partition_point(|level| level.at_s <= t).max(1);
        match self.is_on(t) {
            true => self.levels[after - 1].load,
            false => 0.0,
        }
    }

    /// Samples during which the terminals are open behind a running motor.
    pub(super) fn open(&self, t_sample: f64, count: usize) -> Vec<std::ops::Range<usize>> {
        let off = self.off_s.map(|off| (off / t_sample).ceil() as usize);
        off.filter(|off| *off < count)
            .map(|off| off..count)
            .into_iter()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> Plan {
        let level = |at_s, ramp_s, load, voltage, frequency_hz| Level {
            at_s,
            ramp_s,
            load,
            voltage,
            frequency_hz,
        };
        Plan {
            drive: true,
            starts: true,
            levels: vec![
                level(0.0, 0.0, 0.0, 0.1, 5.0),
                level(1.0, 1.0, 0.5, 0.9, 45.0),
            ],
            off_s: Some(3.0),
            duration_s: 4.0,
        }
    }

    #[test]
    fn levels_are_reached_in_their_ramps_and_loads_at_once() {
        let plan = plan();
        assert_eq!(plan.voltage(0.01), 0.0);
        assert_eq!(
            (plan.voltage(0.5), plan.frequency_hz(0.5), plan.load(0.5)),
            (0.1, 5.0, 0.0)
        );
        assert!((plan.voltage(1.5) - 0.5).abs() < 1e-12);
        assert!((plan.frequency_hz(1.5) - 25.0).abs() < 1e-12);
        assert_eq!((plan.load(1.5), plan.voltage(2.5)), (0.5, 0.9));
    }

    #[test]
    fn off_is_no_voltage_no_load_and_open_terminals() {
        let plan = plan();
        assert_eq!((plan.voltage(3.5), plan.load(3.5)), (0.0, 0.0));
        assert_eq!(plan.open(1e-3, 4000), vec![3000..4000; 1]);
        let stays = Plan {
            off_s: None,
            ..plan
        };
        assert!(stays.open(1e-3, 4000).is_empty());
    }
}
