//! Everything the monitor must know before the first sample, validated once.

use motor::{Mechanics, TParams};

use crate::checks::cage::Cage;
use crate::input::chain::AnalogueChain;
use crate::input::converter::Converter;
use crate::input::sample::CHANNELS;
use crate::isolation::Healthy;
use crate::lamps::threshold::ComparatorConfig;
use crate::model::doubt::ParameterDoubt;
use crate::model::effects::{ActiveEffects, ActiveLaws};
use crate::model::operating_point::Frame;
use crate::model::residuals::{FieldCurrent, RESIDUALS};
use crate::window::MAX_WINDOW_CYCLES;

/// What drives the shaft's load, as the motor file declares it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadKind {
    /// `B_l w`, the paper's case: a change is a fault.
    #[default]
    Friction,
    /// A torque channel exists.
    Measured,
    /// Anything: r2, r3 and r4 say nothing about the motor.
    Free,
}

/// Configuration of the monitor. SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorConfig {
    /// Sampling time, s, in 2e-5..=2e-3.
    pub t_sample: f32,
    /// Codes to SI; unused when samples arrive in SI.
    pub converter: Converter,
    /// Counts per revolution of the encoder (four per pulse), > 0.
    pub encoder_counts_per_revolution: f32,
    /// Electrical parameters per star phase.
    pub params: TParams<f32>,
    /// Physical effects beyond the T model.
    pub effects: ActiveEffects,
    /// Laws that no effect holds.
    pub laws: ActiveLaws,
    /// Corrections of the channels that the effects bring along: voltages a, b, c, then currents a, b, c; 1 for none.
    pub channel_gain: [f32; CHANNELS],
    /// Pole pairs, inertia, friction.
    pub mechanics: Mechanics<f32>,
    /// Rated phase voltage, amplitude, V, > 0.
    pub rated_voltage: f32,
    /// Rated phase current, amplitude, A, > 0.
    pub rated_current: f32,
    /// Rated frequency, rad/s, > 0.
    pub rated_omega: f32,
    /// Rated torque, N m, > 0.
    pub rated_torque: f32,
    /// Where the d axis lies.
    pub frame: Frame,
    /// Source of the field current.
    pub field: FieldCurrent,
    /// Kind of load.
    pub load: LoadKind,
    /// Thresholds of r1..r4 as shares of their scales, > 0.
    pub thresholds: [f32; RESIDUALS],
    /// Supply cycles in a window, 2..=[`MAX_WINDOW_CYCLES`].
    pub window_cycles: usize,
    /// Persistence and hysteresis of all comparators.
    pub comparator: ComparatorConfig,
    /// Statistics of the healthy motor; without them FAULT follows the thresholds of r1..r4.
    pub healthy: Option<Healthy>,
    /// What is known of the rotor's cage.
    pub cage: Cage,
    /// What is not known of the parameters.
    pub doubt: ParameterDoubt,
}

/// A parameter outside its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigError {
    /// Name of the field.
    pub parameter: &'static str,
    /// What it was.
    pub value: f32,
    /// Smallest and largest allowed value.
    pub range: [f32; 2],
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let [least, greatest] = self.range;
        let (name, value) = (self.parameter, self.value);
        write!(f, "{name} = {value} is outside {least}..={greatest}")
    }
}

impl core::error::Error for ConfigError {}

/// Larger than anything a motor can have; keeps the single-precision arithmetic away from overflow.
const HUGE: f32 = 1e6;
const TINY: f32 = 1e-9;

impl MonitorConfig {
    /// Shortest and longest sampling time, s.
    pub const SAMPLING_TIMES: [f32; 2] = [2e-5, 2e-3];

    /// Rated amplitudes of a voltage, V, and of a current, A.
    pub(crate) fn rated_channels(&self) -> [f32; 2] {
        [self.rated_voltage, self.rated_current]
    }

    /// Checks every range, so that nothing in the sample path can fail.
    ///
    /// # Errors
    /// The first parameter that is not a number or lies outside its range.
    #[inline(never)]
    pub fn validate(&self) -> Result<(), ConfigError> {
        let positive = [TINY, HUGE];
        let non_negative = [0.0, HUGE];
        let p = &self.params;
        let checks = [
            ("t_sample", self.t_sample, MonitorConfig::SAMPLING_TIMES),
            (
                "encoder_counts_per_revolution",
                self.encoder_counts_per_revolution,
                [1.0, HUGE],
            ),
            ("r_s", p.r_s, positive),
            ("r_r", p.r_r, positive),
            ("l_ls", p.l_ls, non_negative),
            ("l_lr", p.l_lr, non_negative),
            ("l_ls + l_lr", p.l_ls + p.l_lr, positive),
            ("l_m", p.l_m, positive),
            ("n_p", self.mechanics.n_p, [1.0, 50.0]),
            ("inertia", self.mechanics.inertia, positive),
            ("friction", self.mechanics.friction, non_negative),
            ("load_friction", self.mechanics.load_friction, non_negative),
            ("rated_voltage", self.rated_voltage, positive),
            ("rated_current", self.rated_current, positive),
            ("rated_omega", self.rated_omega, positive),
            ("rated_torque", self.rated_torque, positive),
            (
                "window_cycles",
                self.window_cycles as f32,
                [2.0, MAX_WINDOW_CYCLES as f32],
            ),
            (
                "persistence",
                f32::from(self.comparator.persistence),
                [1.0, 255.0],
            ),
            ("hysteresis", self.comparator.hysteresis, [0.1, 1.0]),
        ];
        let thresholds = self
            .thresholds
            .map(|value| ("thresholds", value, [1e-5, HUGE]));
        checks
            .into_iter()
            .chain(thresholds)
            .chain(
                self.channel_gain
                    .map(|gain| ("channel_gain", gain, [0.1, 10.0])),
            )
            .chain(chain_ranges(&self.converter.chain))
            .try_for_each(check_range)?;
        check_cage(&self.cage)?;
        self.healthy
            .as_ref()
            .map_or(Ok(()), |healthy| healthy.validate())
    }
}

pub(crate) fn check_range(
    (parameter, value, [least, greatest]): (&'static str, f32, [f32; 2]),
) -> Result<(), ConfigError> {
    if (least..=greatest).contains(&value) {
        Ok(())
    } else {
        Err(ConfigError {
            parameter,
            value,
            range: [least, greatest],
        })
    }
}

type Range = (&'static str, f32, [f32; 2]);

fn chain_ranges(chain: &AnalogueChain) -> impl Iterator<Item = Range> {
    let delays = chain
        .delay
        .map(|delay| ("converter.chain.delay", delay, AnalogueChain::DELAYS));
    let roll_off = (
        "converter.chain.roll_off",
        chain.roll_off,
        AnalogueChain::ROLL_OFFS,
    );
    delays.into_iter().chain([roll_off])
}

fn check_cage(cage: &Cage) -> Result<(), ConfigError> {
    check_range(("cage.bars", cage.bars, [0.0, 1000.0]))?;
    let Some(healthy) = &cage.healthy else {
        return Ok(());
    };
    let ([light, heavy], [first, last]) = (healthy.at, healthy.lower);
    let checks = [
        ("cage.healthy.at", light, [1e-3, 100.0]),
        ("cage.healthy.at", heavy, [light, 100.0]),
        ("cage.healthy.lower", first, [0.0, 1.0]),
        ("cage.healthy.lower", last, [0.0, 1.0]),
        ("cage.healthy.scatter", healthy.scatter, [0.0, 1.0]),
    ];
    checks.into_iter().try_for_each(check_range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::cage::HealthySidebands;

    #[test]
    fn ranges_of_the_cage_are_checked() {
        let cage = |at, lower, bars| Cage {
            bars,
            healthy: Some(HealthySidebands {
                at,
                lower,
                scatter: 0.001,
            }),
        };
        assert!(check_cage(&Cage::UNKNOWN).is_ok());
        assert!(check_cage(&cage([0.5, 1.0], [0.004, 0.006], 28.0)).is_ok());
        for wrong in [
            cage([1.0, 0.5], [0.004, 0.006], 28.0),
            cage([0.0, 0.5], [0.004, 0.006], 28.0),
            cage([0.5, 1.0], [-0.004, 0.006], 28.0),
            cage([0.5, f32::NAN], [0.004, 0.006], 28.0),
            cage([0.5, 1.0], [0.004, 0.006], f32::NAN),
        ] {
            assert!(check_cage(&wrong).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn an_error_says_what_was_wrong_and_what_would_be_right() {
        let error = check_range(("hysteresis", 1.5, [0.1, 1.0])).expect_err("outside");
        assert_eq!(error.to_string(), "hysteresis = 1.5 is outside 0.1..=1");
    }

    #[test]
    fn both_ends_of_a_range_belong_to_it_and_not_a_number_never_does() {
        for (value, ok) in [
            (1.0, true),
            (2.0, true),
            (0.99, false),
            (2.01, false),
            (f32::NAN, false),
        ] {
            assert_eq!(check_range(("x", value, [1.0, 2.0])).is_ok(), ok, "{value}");
        }
    }
}
