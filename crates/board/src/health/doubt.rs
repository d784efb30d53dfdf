//! What the board doubts about itself. One place decides what a doubt does: stop judging, or only be shown.

/// One thing about the instrument that does not hold. The numbers are the bits of the Modbus register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Doubt {
    /// The converters' supply is off.
    Supply = 0,
    /// A channel of the converter is stuck.
    Channel = 1,
    /// The crystal is dead; the internal oscillator is 1 % off.
    Clock = 2,
    /// Crystal and low-speed oscillator contradict each other.
    ClockRatio = 3,
    /// The program in flash is not what was sealed.
    Program = 4,
    /// The program was never sealed, so that its flash cannot be tested.
    Unsealed = 5,
    /// A cell of the RAM failed its test.
    Ram = 6,
    /// The processor's registers failed their test.
    Processor = 7,
    /// Settings of converter, DMA, timers or pins changed by themselves.
    Settings = 8,
    /// Too few or too many blocks of samples.
    Blocks = 9,
    /// A lamp's wire does not follow.
    Lamps = 10,
    /// The relay's contact does not follow.
    Relay = 11,
    /// Option bytes are not as docs/firmware.md wants them.
    OptionBytes = 12,
    /// The motor constants are damaged.
    Constants = 13,
    /// Three crashes without a quiet minute between them: nothing is computed until somebody acknowledges.
    Restarts = 14,
    /// The deepest stack is beyond three quarters of its room.
    Stack = 15,
}

impl Doubt {
    /// All of them, in the order of their bits.
    pub const ALL: [Doubt; 16] = [
        Doubt::Supply,
        Doubt::Channel,
        Doubt::Clock,
        Doubt::ClockRatio,
        Doubt::Program,
        Doubt::Unsealed,
        Doubt::Ram,
        Doubt::Processor,
        Doubt::Settings,
        Doubt::Blocks,
        Doubt::Lamps,
        Doubt::Relay,
        Doubt::OptionBytes,
        Doubt::Constants,
        Doubt::Restarts,
        Doubt::Stack,
    ];

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            Doubt::Supply => "converters' supply",
            Doubt::Channel => "stuck channel",
            Doubt::Clock => "no crystal",
            Doubt::ClockRatio => "clock frequency",
            Doubt::Program => "program in flash",
            Doubt::Unsealed => "program not sealed",
            Doubt::Ram => "RAM",
            Doubt::Processor => "processor",
            Doubt::Settings => "settings of peripherals",
            Doubt::Blocks => "rate of samples",
            Doubt::Lamps => "lamp wires",
            Doubt::Relay => "relay contact",
            Doubt::OptionBytes => "option bytes",
            Doubt::Constants => "motor constants",
            Doubt::Restarts => "repeated restarts",
            Doubt::Stack => "stack nearly full",
        }
    }

    /// Whether nothing that is measured can be trusted; the others are shown and change no judgement.
    pub fn stops_judging(self) -> bool {
        !matches!(
            self,
            Doubt::Unsealed | Doubt::Lamps | Doubt::Relay | Doubt::OptionBytes | Doubt::Stack
        )
    }
}

/// All doubts that there are now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Doubts(u32);

impl Doubts {
    /// From the register's bits.
    pub fn from_bits(bits: u32) -> Self {
        Doubts(bits)
    }

    /// For the register.
    pub fn bits(self) -> u32 {
        self.0
    }

    /// Raises or clears one; whether it was raised just now.
    pub fn set(&mut self, doubt: Doubt, raised: bool) -> bool {
        let bit = 1 << doubt as u32;
        let new = raised && self.0 & bit == 0;
        self.0 = if raised { self.0 | bit } else { self.0 & !bit };
        new
    }

    /// Whether there is this one.
    pub fn has(self, doubt: Doubt) -> bool {
        self.0 >> doubt as u32 & 1 == 1
    }

    /// Whether there is any.
    pub fn is_any(self) -> bool {
        self.0 != 0
    }

    /// Whether one of them leaves nothing to be judged.
    pub fn stop_judging(self) -> bool {
        self.iter().any(Doubt::stops_judging)
    }

    /// One after the other.
    pub fn iter(self) -> impl Iterator<Item = Doubt> {
        Doubt::ALL.into_iter().filter(move |doubt| self.has(*doubt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_doubt_has_a_bit_of_its_own() {
        for (k, doubt) in Doubt::ALL.into_iter().enumerate() {
            let mut doubts = Doubts::default();
            assert!(doubts.set(doubt, true) && !doubts.set(doubt, true));
            assert_eq!(doubts.bits(), 1 << k);
            assert_eq!(doubts.iter().collect::<Vec<_>>(), [doubt]);
            assert_eq!(doubts.stop_judging(), doubt.stops_judging());
            doubts.set(doubt, false);
            assert!(!doubts.is_any());
        }
    }

    #[test]
    fn option_bytes_are_shown_and_stop_nothing() {
        let mut doubts = Doubts::default();
        doubts.set(Doubt::OptionBytes, true);
        assert!(doubts.is_any() && !doubts.stop_judging());
        doubts.set(Doubt::Ram, true);
        assert!(doubts.stop_judging());
    }
}
