//! When the seconds of a board were: boards have no clock, and answers come late by changing amounts.

/// A step of the gateway's clock, or a board that counted nothing for a while, ms.
const STEP_MS: f64 = 5_000.0;
/// How much slower than the gateway's clock a board's crystal may run: 200 ppm, ms of a second.
const DRIFT_MS: f64 = 0.2;

/// When a run of a board's program began, by the gateway's clock.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clock {
    zero_ms: Option<f64>,
    second: u32,
}

impl Clock {
    /// As a stored second tells.
    pub fn of_stored(number: u32, time_ms: i64) -> Self {
        Clock {
            zero_ms: Some((time_ms - 1_000 * i64::from(number)) as f64),
            second: number,
        }
    }

    /// At `now_ms` the newest second was `number`. It ended up to a second and the answer's way ago: the earliest of all
    /// observations is right, and it is let go as fast as a crystal may be off.
    pub fn observe(&mut self, now_ms: i64, number: u32) {
        let seen = (now_ms - 1_000 * i64::from(number)) as f64;
        let passed = f64::from(number.saturating_sub(self.second));
        self.second = number;
        self.zero_ms = Some(match self.zero_ms {
            Some(zero) if (seen - zero).abs() < STEP_MS => seen.min(zero + DRIFT_MS * passed),
            _ => seen,
        });
    }

    /// End of a second, Unix ms; `None` before the first observation.
    pub fn time_ms(&self, number: u32) -> Option<i64> {
        Some(self.zero_ms? as i64 + 1_000 * i64::from(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEGIN_MS: i64 = 1_790_000_000_000;

    /// Answers that come late by 0 to 900 ms, in turns; the board's crystal is `ppm` slow.
    fn after(seconds: u32, ppm: f64) -> (Clock, f64) {
        let mut clock = Clock::default();
        let end_ms = |number: u32| f64::from(number) * 1_000.0 * (1.0 + ppm * 1e-6);
        for number in 1..=seconds {
            let late = f64::from(number * 7 % 10) * 100.0;
            clock.observe(BEGIN_MS + (end_ms(number) + late) as i64, number);
        }
        (clock, end_ms(seconds))
    }

    #[test]
    fn late_answers_do_not_move_the_time() {
        for ppm in [-50.0, 0.0, 50.0] {
            let (clock, end) = after(10_000, ppm);
            let time = clock.time_ms(10_000).expect("observed") - BEGIN_MS;
            // Ten seconds without a prompt answer, let go by 0.2 ms each, and roundings.
            assert!((time as f64 - end).abs() < 4.0, "{ppm}: {time} {end}");
        }
    }

    #[test]
    fn a_step_of_the_clock_is_followed() {
        let (mut clock, _) = after(100, 0.0);
        clock.observe(BEGIN_MS + 101_000 + 3_600_000, 101);
        assert_eq!(clock.time_ms(101), Some(BEGIN_MS + 101_000 + 3_600_000));
        clock.observe(BEGIN_MS + 102_000, 102);
        assert_eq!(clock.time_ms(102), Some(BEGIN_MS + 102_000));
    }
}
