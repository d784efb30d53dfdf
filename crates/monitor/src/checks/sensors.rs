//! Plausibility of the measured channels themselves: dead, clipped or contradicting sensors.

use crate::window::Window;
use frames::magnitude;

/// A phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Phase a.
    A,
    /// Phase b.
    B,
    /// Phase c.
    C,
}

impl Phase {
    /// All phases in order.
    pub const ALL: [Phase; 3] = [Phase::A, Phase::B, Phase::C];

    /// Lower-case letter.
    pub const fn letter(self) -> &'static str {
        match self {
            Phase::A => "a",
            Phase::B => "b",
            Phase::C => "c",
        }
    }
}

/// A finding about a sensor, independent of the motor model's thresholds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorFinding {
    /// A voltage channel shows nothing while the others do.
    DeadVoltage(Phase),
    /// A current channel shows nothing while the others do.
    DeadCurrent(Phase),
    /// No voltage channel shows anything, yet currents flow.
    VoltagesMissing,
    /// The currents do not add up to zero although there is no fourth wire.
    CurrentSum,
    /// The speed contradicts what voltages and currents say about the slip.
    SpeedImplausible,
}

impl SensorFinding {
    /// Whether a channel shows nothing at all, rather than something that contradicts the others.
    pub const fn is_dead(self) -> bool {
        matches!(
            self,
            SensorFinding::DeadVoltage(_)
                | SensorFinding::DeadCurrent(_)
                | SensorFinding::VoltagesMissing
        )
    }
}

/// Limits of the plausibility checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthConfig {
    /// Rated phase voltage, amplitude, V.
    pub rated_voltage: f32,
    /// Rated phase current, amplitude, A.
    pub rated_current: f32,
}

/// A channel below this share of the mean of its neighbours is dead: a lost phase of a running
/// motor still carries some half of the voltage by induction.
const DEAD_SHARE: f32 = 0.1;
/// Voltages and currents below this share of rated cannot be told from nothing.
const SILENT_SHARE: f32 = 0.05;
/// Zero sequence over the one that carries the motor that uncalibrated current transformers do not reach: a dead
/// channel gives 0.5, a gain of one half 0.2; a real set of unequal transformers in a laboratory gave 0.11.
const CURRENT_SUM_SHARE: f32 = 0.18;
/// Contradiction between measured and implied speed, as a share of synchronous speed. The implied
/// speed of a locked rotor errs by some 0.3 (saturated leakage, deep bars); a lost encoder by 0.9.
const SPEED_CONTRADICTION: f32 = 0.4;

/// A hot rotor slips this much more than its cold resistance implies: copper from 20 to 150 degC.
const HOT_ROTOR: f32 = 1.5;

impl HealthConfig {
    /// Whether the supply is there at all.
    pub fn has_supply(&self, window: &Window) -> bool {
        let least = SILENT_SHARE * self.rated_voltage;
        magnitude(window.u_s.positive) > least
    }

    /// Whether the motor draws current at all.
    pub fn has_current(&self, window: &Window) -> bool {
        amplitudes(window, 3)
            .iter()
            .any(|&x| x > SILENT_SHARE * self.rated_current)
    }

    /// Checks the voltage channels.
    pub fn check_voltages(&self, window: &Window) -> Option<SensorFinding> {
        let voltages = amplitudes(window, 0);
        if self.are_silent(&voltages) {
            let missing = self.are_silent(&swings(window)) && self.has_current(window);
            return missing.then_some(SensorFinding::VoltagesMissing);
        }
        dead_channel(&voltages).map(SensorFinding::DeadVoltage)
    }

    /// Whether the voltages swing, but not at the frequency of the window: the oscillator does not follow them.
    pub fn is_astray(&self, window: &Window) -> bool {
        self.are_silent(&amplitudes(window, 0)) && !self.are_silent(&swings(window))
    }

    fn are_silent(&self, voltages: &[f32; 3]) -> bool {
        let silent = SILENT_SHARE * self.rated_voltage;
        voltages.iter().all(|&u| u < silent)
    }

    /// Checks the current channels.
    pub fn check_currents(&self, window: &Window) -> Option<SensorFinding> {
        if !self.has_current(window) {
            return None;
        }
        let i = &window.i_s;
        let carrying = magnitude(i.positive).max(magnitude(i.negative));
        if magnitude(i.zero) < CURRENT_SUM_SHARE * carrying {
            return None;
        }
        let dead = dead_channel(&amplitudes(window, 3)).map(SensorFinding::DeadCurrent);
        // Currents without their crests, as in an inrush, need not add up to zero.
        let whole = !(0..3).any(|phase| window.clipped.current(phase));
        dead.or(whole.then_some(SensorFinding::CurrentSum))
    }

    /// Checks the electrical speed against the one that voltages and currents imply, all in rad/s. `doubt` is the standard
    /// deviation of the rotor resistance's logarithm: the implied slip is known no better.
    pub fn check_speed(
        &self,
        omega_sync: f32,
        measured: f32,
        implied: f32,
        doubt: f32,
    ) -> Option<SensorFinding> {
        let (slip, implied_slip) = (omega_sync - measured, omega_sync - implied);
        let factor = libm::expf(DOUBTED * doubt);
        let warm = implied_slip * HOT_ROTOR * factor;
        let cold = implied_slip / factor;
        let off = (cold.min(warm) - slip).max(slip - cold.max(warm));
        let contradiction = off > SPEED_CONTRADICTION * omega_sync;
        contradiction.then_some(SensorFinding::SpeedImplausible)
    }
}

/// Standard deviations of a parameter that no contradiction may be made of.
const DOUBTED: f32 = 4.5;

/// Fundamental amplitudes of three channels from `first` on.
fn amplitudes(window: &Window, first: usize) -> [f32; 3] {
    let mut result = [0.0; 3];
    for (amplitude, channel) in result.iter_mut().zip(window.channels.iter().skip(first)) {
        *amplitude = magnitude(channel.phasor);
    }
    result
}

/// Amplitudes of the voltages were they sines of any frequency, V.
fn swings(window: &Window) -> [f32; 3] {
    let [a, b, c, ..] = window.channels;
    [a, b, c].map(|channel| {
        let square = channel.mean_square - channel.offset * channel.offset;
        processor::sqrtf(2.0 * processor::higher(square, 0.0))
    })
}

/// The channel of three, by their amplitudes, that shows next to nothing while its neighbours do.
pub fn dead_channel([a, b, c]: &[f32; 3]) -> Option<Phase> {
    let neighbours = [(a, b + c), (b, a + c), (c, a + b)];
    Phase::ALL
        .into_iter()
        .zip(neighbours)
        .find(|(_, (own, others))| **own < DEAD_SHARE * 0.5 * others)
        .map(|(phase, _)| phase)
}

#[cfg(test)]
mod tests {
    use super::*;
    use frames::Sequence;
    use num_complex::Complex32;

    const CONFIG: HealthConfig = HealthConfig {
        rated_voltage: 325.0,
        rated_current: 7.0,
    };

    /// A balanced window with a gain on each channel.
    fn window(voltage_gains: [f32; 3], current_gains: [f32; 3]) -> Window {
        let mut window = Window::default();
        for phase in 0..3 {
            let axis = Complex32::from_polar(1.0, -(phase as f32) * core::f32::consts::TAU / 3.0);
            window.channels[phase].phasor = axis * 325.0 * voltage_gains[phase];
            window.channels[3 + phase].phasor = axis * 5.0 * current_gains[phase];
        }
        let [ua, ub, uc, ia, ib, ic] = window.channels.map(|channel| channel.phasor);
        window.u_s = Sequence::from_phases([ua, ub, uc]);
        window.i_s = Sequence::from_phases([ia, ib, ic]);
        window
    }

    #[test]
    fn healthy_channels_raise_nothing() {
        let window = window([1.0, 1.02, 0.99], [1.0, 0.97, 1.03]);
        assert_eq!(CONFIG.check_voltages(&window), None);
        assert_eq!(CONFIG.check_currents(&window), None);
    }

    #[test]
    fn each_dead_channel_is_named() {
        for phase in 0..3 {
            let mut gains = [1.0; 3];
            gains[phase] = 0.01;
            let expected = Phase::ALL[phase];
            let window = window(gains, gains);
            assert_eq!(
                CONFIG.check_voltages(&window),
                Some(SensorFinding::DeadVoltage(expected))
            );
            assert_eq!(
                CONFIG.check_currents(&window),
                Some(SensorFinding::DeadCurrent(expected))
            );
        }
    }

    #[test]
    fn an_open_motor_phase_is_no_sensor_fault() {
        // One phase open: the other two carry opposite currents, the sum stays zero.
        let mut window = window([1.0; 3], [1.0; 3]);
        let current = Complex32::new(5.0, 0.0);
        window.i_s = Sequence::from_phases([Complex32::ZERO, current, -current]);
        assert_eq!(CONFIG.check_currents(&window), None);
    }

    #[test]
    fn a_gain_of_one_half_shows_in_the_sum() {
        let window = window([1.0; 3], [0.5, 1.0, 1.0]);
        assert_eq!(
            CONFIG.check_currents(&window),
            Some(SensorFinding::CurrentSum)
        );
    }

    /// An inrush beyond full scale: what is left of the currents adds up to anything. A dead channel stays one.
    #[test]
    fn clipped_currents_prove_no_sum() {
        let clipped = |gains| {
            let mut window = window([1.0; 3], gains);
            window.clipped.mark_current(1);
            CONFIG.check_currents(&window)
        };
        assert_eq!(clipped([0.5, 1.0, 1.0]), None);
        let dead = SensorFinding::DeadCurrent(Phase::A);
        assert_eq!(clipped([0.01, 1.0, 1.0]), Some(dead));
    }

    #[test]
    fn currents_without_voltages_are_a_sensor_and_silence_is_not() {
        assert_eq!(
            CONFIG.check_voltages(&window([0.0; 3], [1.0; 3])),
            Some(SensorFinding::VoltagesMissing)
        );
        assert_eq!(CONFIG.check_voltages(&window([0.0; 3], [0.0; 3])), None);
    }

    /// An oscillator that stays behind on a ramp: 100 V at another frequency leave 2 V at its own.
    #[test]
    fn voltages_of_another_frequency_are_not_missing() {
        let mut window = window([0.006; 3], [1.0; 3]);
        assert!(!CONFIG.is_astray(&window));
        for channel in &mut window.channels[..3] {
            channel.mean_square = 0.5 * 100.0 * 100.0;
        }
        assert_eq!(CONFIG.check_voltages(&window), None);
        assert!(CONFIG.is_astray(&window));
    }

    #[test]
    fn a_lost_encoder_is_told_from_a_locked_rotor() {
        assert!(CONFIG.check_speed(314.0, 0.0, 300.0, 0.0).is_some());
        assert!(CONFIG.check_speed(314.0, 0.0, 60.0, 0.0).is_none());
        // Stalled and hot: the cold resistance implies two thirds of the slip.
        assert!(CONFIG.check_speed(314.0, 10.0, 314.0 * 0.42, 0.0).is_none());
    }

    #[test]
    fn a_twentieth_of_rated_is_where_silence_ends() {
        let with_voltage = |share: f32| window([share * 325.0 / 325.0; 3], [0.0; 3]);
        assert!(!CONFIG.has_supply(&with_voltage(0.049)));
        assert!(CONFIG.has_supply(&with_voltage(0.051)));
        let with_current = |ampere: f32| window([1.0; 3], [ampere / 5.0, 0.0, 0.0]);
        assert!(!CONFIG.has_current(&with_current(0.049 * 7.0)));
        assert!(CONFIG.has_current(&with_current(0.051 * 7.0)));
    }

    #[test]
    fn without_current_no_current_channel_is_blamed() {
        assert_eq!(CONFIG.check_currents(&window([1.0; 3], [0.0; 3])), None);
    }

    /// A lost phase of a running motor still carries half of the voltage; a dead channel less than a tenth.
    #[test]
    fn a_channel_is_dead_below_a_tenth_of_its_neighbours() {
        for (gain, dead) in [(0.09, true), (0.11, false)] {
            for phase in 0..3 {
                let mut gains = [1.0; 3];
                gains[phase] = gain;
                let found = CONFIG.check_voltages(&window(gains, [1.0; 3]));
                let expected = dead.then_some(SensorFinding::DeadVoltage(Phase::ALL[phase]));
                assert_eq!(found, expected, "{gain} in phase {phase}");
            }
        }
    }

    /// The neighbours are both of the others: one of them at half its length moves the limit with it.
    #[test]
    fn unequal_neighbours_count_with_their_mean() {
        // 0.1 * (0.4 + 1.0)/2 = 0.07.
        for (own, dead) in [(0.068, true), (0.072, false)] {
            for (phase, gains) in [[own, 0.4, 1.0], [0.4, own, 1.0], [1.0, 0.4, own]]
                .into_iter()
                .enumerate()
            {
                let found = CONFIG.check_voltages(&window(gains, [1.0; 3]));
                let expected = dead.then_some(SensorFinding::DeadVoltage(Phase::ALL[phase]));
                assert_eq!(found, expected);
            }
        }
    }

    /// A speed off by 0.4 of synchronous speed beyond what a hot rotor explains.
    #[test]
    fn a_contradiction_is_counted_from_the_hot_rotor_on() {
        let found = |slip: f32, implied: f32| {
            CONFIG
                .check_speed(100.0, 100.0 - slip, 100.0 - implied, 0.0)
                .is_some()
        };
        // Implied slip 10, hot 15: implausible beyond 55 and below -30.
        assert!(!found(54.0, 10.0) && found(56.0, 10.0));
        assert!(!found(-29.0, 10.0) && found(-31.0, 10.0));
        // A generator's slip is negative; hot is further from synchronous speed there as well.
        assert!(!found(-54.0, -10.0) && found(-56.0, -10.0));
        assert!(!found(29.0, -10.0) && found(31.0, -10.0));
    }

    #[test]
    fn phases_have_their_letters() {
        assert_eq!(Phase::ALL.map(Phase::letter), ["a", "b", "c"]);
    }
}
