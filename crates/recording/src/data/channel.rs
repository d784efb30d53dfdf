//! The channels of a recording and their names in files.

use std::fmt;

/// A physical signal of a recording, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Signal {
    /// Voltage of phase a to neutral, V.
    Va,
    /// Voltage of phase b to neutral, V.
    Vb,
    /// Voltage of phase c to neutral, V.
    Vc,
    /// Current into phase a, A.
    Ia,
    /// Current into phase b, A.
    Ib,
    /// Current into phase c, A.
    Ic,
    /// Mechanical speed of the shaft, rad/s.
    Speed,
    /// Brake torque at the shaft, N m, positive against the motor.
    Torque,
    /// Temperature of the winding, degrees Celsius.
    Temperature,
}

impl Signal {
    /// Every signal, in the order in which files list them.
    pub const ALL: [Signal; 9] = [
        Signal::Va,
        Signal::Vb,
        Signal::Vc,
        Signal::Ia,
        Signal::Ib,
        Signal::Ic,
        Signal::Speed,
        Signal::Torque,
        Signal::Temperature,
    ];

    /// The column name in a file.
    pub const fn name(self) -> &'static str {
        match self {
            Signal::Va => "va",
            Signal::Vb => "vb",
            Signal::Vc => "vc",
            Signal::Ia => "ia",
            Signal::Ib => "ib",
            Signal::Ic => "ic",
            Signal::Speed => "speed",
            Signal::Torque => "torque",
            Signal::Temperature => "temperature",
        }
    }

    /// What is measured.
    pub const fn quantity(self) -> Quantity {
        match self {
            Signal::Va | Signal::Vb | Signal::Vc => Quantity::Voltage,
            Signal::Ia | Signal::Ib | Signal::Ic => Quantity::Current,
            Signal::Speed => Quantity::Speed,
            Signal::Torque => Quantity::Torque,
            Signal::Temperature => Quantity::Temperature,
        }
    }
}

/// What a channel measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// Seconds since the start of the recording.
    Time,
    /// Volt.
    Voltage,
    /// Ampere.
    Current,
    /// Mechanical rad/s.
    Speed,
    /// Newton metre.
    Torque,
    /// Degrees Celsius.
    Temperature,
}

impl Quantity {
    /// The unit inside this crate, as reports print it.
    pub const fn si(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Voltage => "V",
            Quantity::Current => "A",
            Quantity::Speed => "rad/s",
            Quantity::Torque => "Nm",
            Quantity::Temperature => "degC",
        }
    }
}

/// One channel: a signal as seen by its first or its second probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Channel {
    /// What is measured.
    pub signal: Signal,
    /// Whether this is the second probe of the signal (`ic2` beside `ic`).
    pub second: bool,
}

impl Channel {
    /// The three phase voltages.
    pub const VOLTAGES: [Channel; 3] = [
        Channel::first(Signal::Va),
        Channel::first(Signal::Vb),
        Channel::first(Signal::Vc),
    ];
    /// The three phase currents.
    pub const CURRENTS: [Channel; 3] = [
        Channel::first(Signal::Ia),
        Channel::first(Signal::Ib),
        Channel::first(Signal::Ic),
    ];
    /// The shaft speed.
    pub const SPEED: Channel = Channel::first(Signal::Speed);
    /// The brake torque.
    pub const TORQUE: Channel = Channel::first(Signal::Torque);
    /// The winding temperature.
    pub const TEMPERATURE: Channel = Channel::first(Signal::Temperature);

    /// The first probe of a signal.
    pub const fn first(signal: Signal) -> Channel {
        Channel {
            signal,
            second: false,
        }
    }

    /// The second probe of a signal.
    pub const fn second(signal: Signal) -> Channel {
        Channel {
            signal,
            second: true,
        }
    }

    /// Every channel that a file may name, first probes first.
    pub fn all() -> impl Iterator<Item = Channel> {
        let firsts = Signal::ALL.into_iter().map(Channel::first);
        firsts.chain(Signal::ALL.into_iter().map(Channel::second))
    }

    /// The channel that a file calls `name`: `va`, `ic2`, `speed`.
    pub fn parse(name: &str) -> Option<Channel> {
        Channel::all().find(|channel| channel.to_string() == name)
    }

    /// What is measured.
    pub const fn quantity(self) -> Quantity {
        self.signal.quantity()
    }

    /// Whether this is a voltage or a current.
    pub fn is_electrical(self) -> bool {
        matches!(self.quantity(), Quantity::Voltage | Quantity::Current)
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let probe = if self.second { "2" } else { "" };
        write!(f, "{}{probe}", self.signal.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back() {
        for channel in Channel::all() {
            assert_eq!(Channel::parse(&channel.to_string()), Some(channel));
        }
        assert_eq!(Channel::all().count(), 18);
        assert_eq!(Channel::parse("va3"), None);
        assert_eq!(Channel::parse(""), None);
    }
}
