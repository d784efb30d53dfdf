//! Measured torque and speed made ready to drive a model: as smooth as their noise allows.

use crate::data::unsupported::Unsupported;
use recording::{Channel, LoadTorque, Recording};
use signal::{Windows, longest_real, sigma};

/// Shortest window of a load torque, samples: a load step stays a step.
const SHORTEST_TORQUE: usize = 25;
/// Shortest window of a speed, s.
const SHORTEST_SPEED: f64 = 0.01;

/// Noise of what drives a model, before it was smoothed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputNoise {
    /// Voltage, V per axis.
    pub voltage: f64,
    /// Load torque, N m.
    pub torque: f64,
    /// Speed that is given to the model, rad/s; zero where the model finds its own.
    pub speed: f64,
}

/// A measured quantity that drives a model.
#[derive(Clone, Debug, Default)]
pub struct Driver {
    /// Smoothed values.
    pub value: Vec<f64>,
    /// Their windows.
    pub windows: Windows,
    /// Noise before smoothing, standard deviation.
    pub noise: f64,
}

impl Driver {
    fn new(
        rec: &Recording,
        channel: Channel,
        x: &[f64],
        shortest: usize,
        may_be_raw: bool,
    ) -> Self {
        let noise = sigma(rec, channel, x);
        let windows = longest_real(x, noise, shortest, may_be_raw);
        Self {
            value: windows.smooth(x),
            windows,
            noise,
        }
    }
}

/// What the recording says of the load.
pub struct Load {
    /// Load torque beyond the friction of the motor file, N m.
    pub torque: Driver,
    /// Whether nothing says what the load is, so that the measured speed must drive the model.
    pub unknown: bool,
}

impl Load {
    /// A measured torque, the friction of the motor file, or a measured speed that takes the load's place.
    ///
    /// # Errors
    /// None of the three: then every torque explains the currents, with another speed.
    pub fn new(rec: &Recording) -> Result<Self, Unsupported> {
        let none = Driver {
            value: vec![0.0; rec.len()],
            ..Driver::default()
        };
        let known = |torque| Self {
            torque,
            unknown: false,
        };
        match (rec.metadata.load_torque, rec.torque()) {
            (LoadTorque::Friction, _) => Ok(known(none)),
            (_, Some(x)) => {
                let torque = Driver::new(rec, Channel::TORQUE, x, SHORTEST_TORQUE, true);
                Ok(known(torque))
            }
            _ if rec.speed().is_some() => Ok(Self {
                torque: none,
                unknown: true,
            }),
            _ => Err(Unsupported::new(
                "the recording has neither speed nor torque: what the motor carries is not known",
                "record `speed` (rad/s), or `torque` (N m) at the shaft; if the load is the friction of the motor file alone, write `load_torque = \"friction\"` into the sidecar",
            )),
        }
    }
}

/// The measured speed, rad/s; empty without a speed channel.
pub fn measured_speed(rec: &Recording, t_sample: f64) -> Driver {
    let shortest = (SHORTEST_SPEED / t_sample) as usize;
    rec.speed().map_or_else(Driver::default, |x| {
        Driver::new(rec, Channel::SPEED, x, shortest, false)
    })
}
