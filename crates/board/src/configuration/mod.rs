//! Configuration in the field: motor constants, relay and line, changed over the line without a programmer.
//!
//! A master writes the words of a new configuration beside those that hold ([`Desk`]), has them checked as a motor file is,
//! and puts them on trial. Only what is confirmed over the new line settings within a minute goes to flash ([`ConfigurationStore`]); anything
//! else, a power failure too, leaves what held before ([`Configurator`]).

mod configurator;
mod desk;
mod line;
mod store;

pub use configurator::{Compiled, ConfigurationSource, Configurator, TRIAL_S};
pub use desk::{ACTIVE, Desk, STAGED};
pub use line::{Line, LineParity};
pub use store::{ConfigurationStore, PAGES as CONFIGURATION_PAGES};

use monitor::MonitorConfig;

use crate::door::relay::RelayMode;
use crate::image::{IMAGE_WORDS, ImageError, MotorImage, config_of};

/// Layout of the words; a different one gets a different number.
const LAYOUT: u32 = 0x444D_5301;
/// Bytes of the motor's name; what is left over is 0.
pub const NAME_BYTES: usize = 64;
const NAME_WORDS: usize = NAME_BYTES / 4;
const HEAD_WORDS: usize = 3;
/// Words of a configuration: layout; address, parity and relay; bit/s; name; motor constants.
pub const CONFIGURATION_WORDS: usize = HEAD_WORDS + NAME_WORDS + IMAGE_WORDS;
/// Registers of a configuration: two for each word, the high one first.
pub const CONFIGURATION_REGISTERS: u16 = 2 * CONFIGURATION_WORDS as u16;

/// Everything that can be changed in the field, as the words that lie in flash and registers. It is large: the board hands it round
/// by reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Configuration {
    words: [u32; CONFIGURATION_WORDS],
}

/// What of a configuration is refused. The numbers are those of the Modbus register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Refused {
    /// Written for another layout than this program's.
    Layout = 1,
    /// The address is outside 1 to 247.
    Unit = 2,
    /// The speed is outside 1200 to 115 200 bit/s.
    Baud = 3,
    /// Unknown parity.
    Parity = 4,
    /// Unknown mode of the relay.
    Relay = 5,
    /// The name is not UTF-8.
    Name = 6,
    /// The checksum of the motor constants does not hold: a part of them was not written.
    Checksum = 7,
    /// The motor constants hold a choice that this program does not know.
    Choice = 8,
    /// The motor constants name an effect that this program does not know.
    Effects = 9,
    /// A motor constant is outside its range, or made for another sampling rate.
    Range = 10,
    /// Flash refused it; what held before holds again when the trial ends.
    Flash = 11,
    /// Nothing is on trial that could be confirmed.
    NoTrial = 12,
}

impl Refused {
    /// All of them, in the order of their numbers.
    pub const ALL: [Refused; 12] = [
        Refused::Layout,
        Refused::Unit,
        Refused::Baud,
        Refused::Parity,
        Refused::Relay,
        Refused::Name,
        Refused::Checksum,
        Refused::Choice,
        Refused::Effects,
        Refused::Range,
        Refused::Flash,
        Refused::NoTrial,
    ];

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            Refused::Layout => "made for another version",
            Refused::Unit => "address",
            Refused::Baud => "speed of the line",
            Refused::Parity => "parity",
            Refused::Relay => "relay mode",
            Refused::Name => "name",
            Refused::Checksum => "checksum of the motor constants",
            Refused::Choice => "choice in the motor constants",
            Refused::Effects => "effect that the program does not know",
            Refused::Range => "motor constant outside its range",
            Refused::Flash => "flash",
            Refused::NoTrial => "nothing on trial",
        }
    }
}

impl Configuration {
    /// No configuration at all: refused like any other rubbish.
    pub const BLANK: Configuration = Configuration {
        words: [0; CONFIGURATION_WORDS],
    };

    /// The line as it comes, for a motor.
    pub fn of(name: &str, image: &MotorImage) -> Self {
        let mut configuration = Configuration::BLANK;
        configuration.set_line(Line::default());
        configuration.set_relay(RelayMode::default());
        configuration.set_motor(name, image);
        configuration
    }

    /// As words.
    pub fn words(&self) -> &[u32; CONFIGURATION_WORDS] {
        &self.words
    }

    /// The words, to be changed one by one. Whether they make sense says [`Self::check`].
    pub fn words_mut(&mut self) -> &mut [u32; CONFIGURATION_WORDS] {
        &mut self.words
    }

    /// The register `at`, counted from the first one; `None` beyond [`CONFIGURATION_REGISTERS`].
    pub fn register(&self, at: u16) -> Option<u16> {
        let word = self.words.get(usize::from(at / 2))?;
        Some((word >> shift(at)) as u16)
    }

    /// Changes the register `at`, counted from the first one; `false` beyond [`CONFIGURATION_REGISTERS`].
    pub fn set_register(&mut self, at: u16, value: u16) -> bool {
        let Some(word) = self.words.get_mut(usize::from(at / 2)) else {
            return false;
        };
        *word = *word & !(0xFFFF << shift(at)) | u32::from(value) << shift(at);
        true
    }

    /// All of them, in their order.
    pub fn registers(&self) -> impl Iterator<Item = u16> {
        (0..CONFIGURATION_REGISTERS).map_while(|at| self.register(at))
    }

    /// The Modbus line.
    ///
    /// # Errors
    /// Another layout, or a line that the board cannot have.
    pub fn line(&self) -> Result<Line, Refused> {
        let [layout, choices, baud, ..] = self.words;
        if layout != LAYOUT {
            return Err(Refused::Layout);
        }
        Line::from_word(choices as u16, baud)
    }

    /// Changes the line.
    pub fn set_line(&mut self, line: Line) {
        let [layout, choices, baud, ..] = &mut self.words;
        *layout = LAYOUT;
        *choices = *choices & 0xFFFF_0000 | line.to_word();
        *baud = line.baud;
    }

    /// What opens the relay.
    ///
    /// # Errors
    /// Unknown mode.
    pub fn relay(&self) -> Result<RelayMode, Refused> {
        let [_, choices, ..] = self.words;
        RelayMode::by_number((choices >> 16) as u16).ok_or(Refused::Relay)
    }

    /// Changes what opens the relay.
    pub fn set_relay(&mut self, relay: RelayMode) {
        let [_, choices, ..] = &mut self.words;
        *choices = *choices & 0xFFFF | u32::from(relay as u16) << 16;
    }

    /// Changes the motor; a name that is too long is cut.
    pub fn set_motor(&mut self, name: &str, image: &MotorImage) {
        let bytes = name_bytes(name);
        let name = bytes.as_chunks::<4>().0.iter();
        let name = name.map(|four| u32::from_be_bytes(*four));
        let places = self.words.iter_mut().skip(HEAD_WORDS);
        places
            .zip(name.chain(image.0))
            .for_each(|(place, word)| *place = word);
    }

    /// Constants of motor, sensors and lamps.
    pub fn constants(&self) -> &[u32; IMAGE_WORDS] {
        const { assert!(IMAGE_WORDS < CONFIGURATION_WORDS) };
        self.words.last_chunk().unwrap_or(&[0; IMAGE_WORDS])
    }

    /// What tells the motor constants from any others.
    pub fn identification(&self) -> u32 {
        let [.., checksum] = self.words;
        checksum
    }

    /// Name of the motor.
    pub fn name(&self) -> Name {
        let mut bytes = [0; NAME_BYTES];
        let (places, _) = bytes.as_chunks_mut::<4>();
        let words = self.words.iter().skip(HEAD_WORDS);
        places
            .iter_mut()
            .zip(words)
            .for_each(|(four, word)| *four = word.to_be_bytes());
        Name(bytes)
    }

    /// Whether the board can be run with it; `t_sample` is the board's sampling time, s.
    ///
    /// # Errors
    /// Line, relay or name outside their ranges; constants that this program cannot compute with.
    #[inline(never)]
    pub fn check(&self, t_sample: f32) -> Result<(), Refused> {
        self.line()?;
        self.relay()?;
        self.name().text().ok_or(Refused::Name)?;
        let config = config_of(self.constants()).map_err(|error| match error {
            ImageError::Checksum => Refused::Checksum,
            ImageError::Schema => Refused::Layout,
            ImageError::Choice => Refused::Choice,
            ImageError::Effects => Refused::Effects,
        })?;
        let sound = config.t_sample == t_sample && config.validate().is_ok();
        sound.then_some(()).ok_or(Refused::Range)
    }

    /// What the monitor computes with; `None` where [`Self::check`] refuses it.
    #[inline(never)]
    pub fn config(&self) -> Option<MonitorConfig> {
        config_of(self.constants()).ok()
    }
}

/// The high register comes first.
fn shift(at: u16) -> u32 {
    if at.is_multiple_of(2) { 16 } else { 0 }
}

/// A motor's name, filled up with 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name([u8; NAME_BYTES]);

impl Name {
    /// `None` where the bytes are not UTF-8.
    pub fn text(&self) -> Option<&str> {
        let end = self.0.iter().position(|byte| *byte == 0);
        core::str::from_utf8(self.0.get(..end.unwrap_or(NAME_BYTES))?).ok()
    }
}

/// As much of a name as fits, whole characters only.
fn name_bytes(name: &str) -> [u8; NAME_BYTES] {
    let mut bytes = [0; NAME_BYTES];
    let fits = name.char_indices().map(|(at, c)| at + c.len_utf8());
    let end = fits
        .take_while(|end| *end <= NAME_BYTES)
        .last()
        .unwrap_or(0);
    let text = name.as_bytes().iter().take(end);
    bytes
        .iter_mut()
        .zip(text)
        .for_each(|(place, byte)| *place = *byte);
    bytes
}

#[cfg(test)]
pub(crate) mod tests;
