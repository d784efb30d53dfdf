//! Shaft speed from a quadrature encoder by the M/T method, or the mean of a measured speed.
//!
//! M/T: counts between two edges divided by the time between the same two edges, so that neither
//! the start nor the end of a window costs a count (Ohmae et al., IEEE Trans. Ind. Electron.
//! IE-29(3), 1982, doi:10.1109/TIE.1982.356669). Edge times are known to one sample here.

use core::f32::consts::TAU;

use crate::input::sample::SpeedSample;

/// The encoder and what it can plausibly deliver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderConfig {
    /// Sampling time, s.
    pub t_sample: f32,
    /// Counts per revolution: four per pulse of a quadrature encoder.
    pub counts_per_revolution: f32,
    /// Most counts from one sample to the next that are believed; more is a glitch.
    pub max_counts_per_sample: u32,
}

/// No shaft turns as fast, rad/s; squares and sums stay far from overflow.
const FASTEST: f32 = 1e6;

/// Counting since the last window end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderState {
    last_count: Option<u16>,
    /// Samples since the reference edge.
    samples: u32,
    /// Samples from the reference edge to the latest edge, and the counts up to it.
    latest_edge: u32,
    counts: i32,
    glitches: u16,
    /// Mean of a measured speed in this window: its first value, and sums of what the others are beside it.
    first: f32,
    sum: f32,
    square: f32,
    measured: u32,
    missing: u32,
}

/// What one window says about the shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedReading {
    /// Mean mechanical speed, rad/s; `None` without a sensor.
    pub omega_mech: Option<f32>,
    /// Counts that were too fast to be true and were left out.
    pub glitches: u16,
    /// Standard deviation of `omega_mech` by the scatter of a measured speed's samples, rad/s; ripple counts as noise. 0 with
    /// an encoder.
    pub noise: f32,
    /// No edge came in this window: the shaft stands, or the encoder is dead.
    pub silent: bool,
}

impl EncoderConfig {
    /// An encoder on a shaft that turns at `omega_mech_max`, rad/s, at most; `t_sample` is in seconds.
    pub fn new(t_sample: f32, counts_per_revolution: f32, omega_mech_max: f32) -> Self {
        // One count more than the fastest shaft delivers: the phase of the edges is arbitrary.
        let most = omega_mech_max * counts_per_revolution / TAU * t_sample + 1.0;
        EncoderConfig {
            t_sample,
            counts_per_revolution,
            max_counts_per_sample: most as u32,
        }
    }

    /// Takes the sensor's value at one sample.
    pub fn update(&self, state: &mut EncoderState, speed: SpeedSample) {
        match speed {
            SpeedSample::None => state.missing = state.missing.saturating_add(1),
            // NaN and infinity fail the comparison too.
            SpeedSample::RadPerSecond(omega) if omega.abs() < FASTEST => {
                if state.measured == 0 {
                    state.first = omega;
                }
                let beside = omega - state.first;
                state.sum += beside;
                state.square += beside * beside;
                state.measured = state.measured.saturating_add(1);
            }
            SpeedSample::RadPerSecond(_) => state.missing = state.missing.saturating_add(1),
            SpeedSample::Count(count) => self.count(state, count),
        }
    }

    /// Takes the free-running counter at one sample.
    #[inline(always)]
    pub(crate) fn count(&self, state: &mut EncoderState, count: u16) {
        let Some(last) = state.last_count.replace(count) else {
            return;
        };
        // Windows end many times a second, so that neither sum ever wraps.
        state.samples = state.samples.wrapping_add(1);
        // Two's complement: right across the wrap and in both directions.
        let delta = i32::from(count.wrapping_sub(last) as i16);
        if delta.unsigned_abs() > self.max_counts_per_sample {
            state.glitches = state.glitches.saturating_add(1);
        } else if delta != 0 {
            state.counts = state.counts.wrapping_add(delta);
            state.latest_edge = state.samples;
        }
    }

    /// Ends a window: its mean speed; the latest edge becomes the reference of the next window.
    pub fn close_window(&self, state: &mut EncoderState) -> SpeedReading {
        let reading = SpeedReading {
            omega_mech: self.mean_speed(state),
            glitches: state.glitches,
            noise: measured_noise(state),
            silent: state.latest_edge == 0 && state.measured == 0,
        };
        state.samples = state.samples.wrapping_sub(state.latest_edge);
        (state.counts, state.latest_edge, state.glitches) = (0, 0, 0);
        (state.sum, state.square) = (0.0, 0.0);
        (state.measured, state.missing) = (0, 0);
        reading
    }

    fn mean_speed(&self, state: &EncoderState) -> Option<f32> {
        if state.missing > state.measured {
            return None;
        }
        if state.measured > 0 {
            return Some(state.first + state.sum / state.measured as f32);
        }
        state.last_count?;
        if state.latest_edge == 0 {
            return Some(0.0);
        }
        let revolutions = state.counts as f32 / self.counts_per_revolution;
        Some(TAU * revolutions / (state.latest_edge as f32 * self.t_sample))
    }
}

/// Standard deviation of a mean of independent samples.
fn measured_noise(state: &EncoderState) -> f32 {
    if state.measured < 2 {
        return 0.0;
    }
    let n = state.measured as f32;
    let mean = state.sum / n;
    processor::sqrtf((state.square / n - mean * mean).max(0.0) / (n - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn config() -> EncoderConfig {
        EncoderConfig::new(1e-4, 4096.0, 700.0)
    }

    /// Counter value of an ideal encoder at sample `k` of a shaft at constant speed.
    fn count_at(k: u32, omega: f64) -> u16 {
        let counts = omega * f64::from(k) * 1e-4 * 4096.0 / core::f64::consts::TAU + 0.3;
        (counts.floor() as i64) as u16
    }

    fn speed_over(windows: u32, samples: u32, omega: f64) -> f32 {
        let mut state = EncoderState::default();
        let mut reading = SpeedReading::default();
        for k in 0..windows * samples {
            config().update(&mut state, SpeedSample::Count(count_at(k, omega)));
            if k % samples == samples - 1 {
                reading = config().close_window(&mut state);
            }
        }
        reading.omega_mech.unwrap_or(f32::NAN)
    }

    proptest! {
        /// An edge is known to one sample (M/T's T) or one count (its M), whichever is coarser.
        #[test]
        fn any_speed_and_direction_is_measured(omega in -600.0f64..600.0) {
            prop_assume!(omega.abs() > 1.0);
            let counts_in_window = (omega.abs() * 0.02 * 4096.0 / core::f64::consts::TAU).max(1.0);
            let resolution = (2.0 / 200.0_f64).min(2.0 / counts_in_window);
            let measured = f64::from(speed_over(3, 200, omega));
            prop_assert!((measured / omega - 1.0).abs() <= resolution + 1e-5, "{measured} for {omega}");
        }
    }

    /// Alternating by 1 rad/s about 150: the mean of 100 samples is 150, known to 1/sqrt(99).
    #[test]
    fn a_measured_speed_knows_its_noise() {
        let mut state = EncoderState::default();
        for _ in 0..2 {
            for k in 0..100 {
                let omega = 150.0 + if k % 2 == 0 { 1.0 } else { -1.0 };
                config().update(&mut state, SpeedSample::RadPerSecond(omega));
            }
            let reading = config().close_window(&mut state);
            assert_eq!(reading.omega_mech, Some(150.0));
            assert!((reading.noise - 0.1005).abs() < 1e-4, "{}", reading.noise);
        }
    }

    #[test]
    fn the_counter_wrap_is_invisible() {
        // 70 000 counts pass in this time: the 16-bit counter wraps.
        let omega = 70_000.0 / 4096.0 * core::f64::consts::TAU / 2.0;
        assert!((f64::from(speed_over(100, 200, omega)) / omega - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_standing_shaft_is_zero_and_silent() {
        let mut state = EncoderState::default();
        for _ in 0..200 {
            config().update(&mut state, SpeedSample::Count(17));
        }
        let reading = config().close_window(&mut state);
        assert_eq!(reading.omega_mech, Some(0.0));
        assert!(reading.silent);
    }

    #[test]
    fn a_glitch_is_left_out_and_counted() {
        let mut state = EncoderState::default();
        for k in 0..400 {
            let glitch = if k == 250 { 9000 } else { 0 };
            config().update(
                &mut state,
                SpeedSample::Count(count_at(k, 150.0).wrapping_add(glitch)),
            );
        }
        let reading = config().close_window(&mut state);
        assert_eq!(reading.glitches, 2, "the jump there and the jump back");
        // Two of 400 intervals are lost with their counts.
        assert!((reading.omega_mech.unwrap_or(0.0) / 150.0 - 1.0).abs() < 2.5 / 400.0 + 1e-3);
    }

    #[test]
    fn a_reversal_changes_the_sign() {
        assert!(speed_over(2, 200, -150.0) < -149.0);
    }

    #[test]
    fn no_sensor_is_no_speed_and_a_measured_speed_is_averaged() {
        let mut state = EncoderState::default();
        config().update(&mut state, SpeedSample::None);
        assert_eq!(config().close_window(&mut state).omega_mech, None);
        for omega in [100.0, 102.0] {
            config().update(&mut state, SpeedSample::RadPerSecond(omega));
        }
        assert_eq!(config().close_window(&mut state).omega_mech, Some(101.0));
    }

    /// A shaft of 700 rad/s and 4096 counts gives 45.6 counts in 0.1 ms; one more is allowed for the phase of the edges.
    #[test]
    fn the_fastest_shaft_is_believed_and_no_faster_one() {
        for (counts, glitches) in [(46, 0), (47, 1), (-46, 0), (-47, 1)] {
            let mut state = EncoderState::default();
            for count in [0_i16, counts] {
                config().update(&mut state, SpeedSample::Count(count as u16));
            }
            assert_eq!(
                config().close_window(&mut state).glitches,
                glitches,
                "{counts}"
            );
        }
    }

    /// Edge to edge: the time before the first edge and after the last one counts in the window to which the next edge belongs.
    #[test]
    fn the_time_after_the_last_edge_goes_to_the_next_window() {
        let mut state = EncoderState::default();
        let mut feed = |count: u16, samples: u32| {
            for _ in 0..samples {
                config().update(&mut state, SpeedSample::Count(count));
            }
        };
        feed(0, 1);
        feed(1, 10);
        let reading = config().close_window(&mut state);
        // One count one sample after the first value; nine samples wait.
        let one_count = core::f32::consts::TAU / 4096.0;
        assert_eq!(reading.omega_mech, Some(one_count / 1e-4));
        let mut feed = |count: u16| config().update(&mut state, SpeedSample::Count(count));
        feed(2);
        let speed = config().close_window(&mut state).omega_mech.unwrap_or(0.0);
        assert!(
            (speed * 10.0 * 1e-4 / one_count - 1.0).abs() < 1e-5,
            "{speed}"
        );
    }

    #[test]
    fn half_of_the_samples_must_carry_a_speed() {
        let numbers = [100.0, f32::NAN, f32::INFINITY];
        for (take, expected) in [(2, Some(100.0)), (3, None)] {
            let mut state = EncoderState::default();
            for omega in numbers.into_iter().take(take) {
                config().update(&mut state, SpeedSample::RadPerSecond(omega));
            }
            let reading = config().close_window(&mut state);
            assert_eq!(reading.omega_mech, expected);
            assert!(!reading.silent, "a number came");
        }
    }
}
