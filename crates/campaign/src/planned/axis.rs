//! The conditions that a campaign varies, one axis each.

use document::Bounds;

/// A quantity that runs differ in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Torque at rated speed, percent of rated.
    Load,
    /// Torque after the load step, percent of rated.
    LoadStepTo,
    /// Supply voltage, percent of rated.
    Voltage,
    /// Supply voltage after the step, percent of rated.
    VoltageStepTo,
    /// Supply frequency, Hz.
    Frequency,
    /// Negative over positive sequence of the supply, percent.
    Unbalance,
    /// Total harmonic distortion of the supply, percent.
    Distortion,
    /// Temperature of stator and rotor winding, degC.
    Winding,
    /// Standard deviation of the noise, percent of full scale.
    Noise,
    /// Resolution of the converter, bit.
    Bits,
    /// Largest gain error left in a voltage or current channel, percent.
    GainError,
    /// Samples a second, Hz.
    SampleRate,
    /// 1 where the motor runs backwards, 0 where it runs forwards.
    Backwards,
    /// How long steps of voltage, load and frequency take, s; 0 for at once.
    Ramp,
    /// Supply frequency after the step, Hz.
    FrequencyStepTo,
    /// How long a cycle of the load takes, s: half of it before the step, half after.
    LoadCycle,
}

/// Number of axes.
pub const AXES: usize = 16;

/// Axes that every plan draws from one stream of random numbers; those that came later have another, so that the runs of a
/// plan which does not name them stay what they were.
pub(crate) const FIRST_STREAM: usize = 11;

/// The board's sampling rate, Hz.
const BOARD_RATE_HZ: f64 = 10_000.0;

/// An axis as a plan file names it.
pub(crate) struct Described {
    #[cfg_attr(
        not(test),
        expect(
            dead_code,
            reason = "it says which entry is which, and a test holds the order"
        )
    )]
    pub axis: Axis,
    pub key: &'static str,
    pub bounds: Bounds,
    /// Where the plan does not name it; not a number where the motor file decides or nothing happens.
    pub default: f64,
}

const fn described(axis: Axis, key: &'static str, bounds: Bounds, default: f64) -> Described {
    Described {
        axis,
        key,
        bounds,
        default,
    }
}

/// In the order in which a plan's random numbers are drawn: never change it, only add at the end.
pub(crate) const DESCRIBED: [Described; AXES] = [
    described(
        Axis::Load,
        "load_percent",
        Bounds::between(0.0, 300.0, "percent of rated torque"),
        100.0,
    ),
    described(
        Axis::LoadStepTo,
        "load_step_to_percent",
        Bounds::between(0.0, 300.0, "percent of rated torque"),
        f64::NAN,
    ),
    described(
        Axis::Voltage,
        "voltage_percent",
        Bounds::between(1.0, 150.0, "percent of rated"),
        100.0,
    ),
    described(
        Axis::VoltageStepTo,
        "voltage_step_to_percent",
        Bounds::between(1.0, 150.0, "percent of rated"),
        f64::NAN,
    ),
    described(
        Axis::Frequency,
        "frequency_hz",
        Bounds::between(1.0, 400.0, "Hz"),
        f64::NAN,
    ),
    described(
        Axis::Unbalance,
        "unbalance_percent",
        Bounds::between(0.0, 20.0, "percent"),
        0.0,
    ),
    described(
        Axis::Distortion,
        "voltage_thd_percent",
        Bounds::between(0.0, 50.0, "percent"),
        0.0,
    ),
    described(
        Axis::Winding,
        "winding_degc",
        Bounds::between(-60.0, 300.0, "degC"),
        f64::NAN,
    ),
    described(
        Axis::Noise,
        "noise_percent_of_full_scale",
        Bounds::between(0.0, 10.0, "percent of full scale"),
        f64::NAN,
    ),
    described(
        Axis::Bits,
        "adc_bits",
        Bounds::between(6.0, 16.0, "bit"),
        f64::NAN,
    ),
    described(
        Axis::GainError,
        "sensor_gain_error_percent",
        Bounds::between(0.0, 50.0, "percent"),
        0.0,
    ),
    described(
        Axis::SampleRate,
        "sample_rate_hz",
        Bounds::between(500.0, 50_000.0, "Hz"),
        BOARD_RATE_HZ,
    ),
    described(
        Axis::Backwards,
        "backwards",
        Bounds::between(0.0, 1.0, "0 or 1"),
        0.0,
    ),
    described(Axis::Ramp, "ramp_s", Bounds::between(0.0, 600.0, "s"), 0.0),
    described(
        Axis::FrequencyStepTo,
        "frequency_step_to_hz",
        Bounds::between(1.0, 400.0, "Hz"),
        f64::NAN,
    ),
    described(
        Axis::LoadCycle,
        "load_cycle_s",
        Bounds::between(0.02, 60.0, "s"),
        f64::NAN,
    ),
];

/// The values of one axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Grid {
    /// One after the other.
    Values(Vec<f64>),
    /// Anything between two limits, drawn for every run.
    Between(f64, f64),
}

impl Grid {
    /// Values in a full product.
    pub fn len(&self) -> usize {
        match self {
            Grid::Values(values) => values.len(),
            Grid::Between(..) => 1,
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at a position of a full product.
    pub fn at(&self, position: usize) -> f64 {
        match self {
            Grid::Values(values) => values[position % values.len()],
            Grid::Between(from, to) => 0.5 * (from + to),
        }
    }

    /// The value that a uniform random number in 0..1 stands for.
    pub fn drawn(&self, uniform: f64) -> f64 {
        match self {
            // Truncation is the meaning: equal shares of 0..1.
            Grid::Values(values) => {
                values[((uniform * values.len() as f64) as usize).min(values.len() - 1)]
            }
            Grid::Between(from, to) => from + uniform * (to - from),
        }
    }
}

/// The conditions of one run, a value for every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions(pub(crate) [f64; AXES]);

impl Conditions {
    /// The value of an axis; not a number where the plan leaves it to the motor file or nothing happens.
    pub fn of(&self, axis: Axis) -> f64 {
        self.0[axis as usize]
    }

    /// The value of an axis, or the default of one that the plan does not name.
    pub fn or(&self, axis: Axis, otherwise: f64) -> f64 {
        let value = self.of(axis);
        if value.is_nan() { otherwise } else { value }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_stand_in_the_order_of_their_numbers() {
        for (k, described) in DESCRIBED.iter().enumerate() {
            assert_eq!(described.axis as usize, k, "{}", described.key);
        }
    }

    #[test]
    fn uniform_numbers_give_every_value_its_share() {
        let grid = Grid::Values(vec![1.0, 2.0, 3.0]);
        let drawn = [0.0, 0.34, 0.67, 0.999_999].map(|u| grid.drawn(u));
        assert_eq!(drawn, [1.0, 2.0, 3.0, 3.0]);
        assert_eq!(Grid::Between(10.0, 150.0).drawn(0.5), 80.0);
    }
}
