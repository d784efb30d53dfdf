//! How fast what a window shows changes.

use num_complex::Complex32;

use frames::magnitude;

/// Slopes of straight lines through the cycles of a window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Of the voltage's amplitude, V/s.
    pub voltage: f32,
    /// Of the current as the voltage sees it, A/s.
    pub current: Complex32,
    /// Of the mechanical speed with the field, rad/s2; 0 without a sensor.
    pub speed: f32,
    /// Of the supply's frequency, rad/s2.
    pub supply: f32,
}

/// What noise may make of each of [`Rates`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateNoise {
    /// Of the voltage's amplitude, V/s.
    pub voltage: f32,
    /// Of the current, A/s.
    pub current: f32,
    /// Of the mechanical speed, rad/s2.
    pub speed: f32,
    /// Of the supply's frequency, rad/s2.
    pub supply: f32,
}

impl Rates {
    /// What remains of each rate beyond `noise`.
    pub fn beyond(&self, noise: &RateNoise) -> Self {
        Rates {
            voltage: self.voltage * share_beyond(self.voltage.abs(), noise.voltage),
            current: self.current * share_beyond(magnitude(self.current), noise.current),
            speed: self.speed * share_beyond(self.speed.abs(), noise.speed),
            supply: self.supply * share_beyond(self.supply.abs(), noise.supply),
        }
    }
}

fn share_beyond(length: f32, noise: f32) -> f32 {
    if length > noise {
        1.0 - noise / length
    } else {
        0.0
    }
}
