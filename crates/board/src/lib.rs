#![cfg_attr(not(test), no_std)]
//! What the board stores, shows and says: formats shared by the firmware and the host. No hardware.
//!
//! The map that a Modbus master reads, and a value in it:
//!
//! ```
//! use board::modbus::{Field, Image, address};
//!
//! let mut image = Image::default();
//! image.set_float(Field::Speed, 1_450.0);
//! let words = image.range(address(Field::Speed), 2).expect("in the map");
//! assert_eq!(f32::from_bits(u32::from(words[0]) << 16 | u32::from(words[1])), 1_450.0);
//! ```

mod button;
mod calibration;
mod capture;
mod checksum;
#[cfg(test)]
mod chip;
mod configuration;
mod display;
mod doubt;
mod events;
mod fault_record;
mod frame;
mod framing;
mod image;
mod learn;
mod message;
pub mod modbus;
mod relay;
mod stuck;

pub use button::{Button, Press};
pub use calibration::{
    COVARIANCES, Calibration, CalibrationSource, ChannelTrim, Healthy, Loaded, PAGE_BYTES, PAGES,
    RECORD_BYTES, Store, StoreError,
};
pub use capture::{CAPTURE_EVERY, CAPTURE_INSTANTS, Capture, CaptureChunk, CaptureState};
pub use checksum::{Checksum, crc32, crc32_words};
pub use configuration::{
    ACTIVE, CONFIGURATION_PAGES, CONFIGURATION_REGISTERS, CONFIGURATION_WORDS, Compiled,
    Configuration, ConfigurationSource, ConfigurationStore, Configurator, Desk, Line, LineParity,
    NAME_BYTES, Name, Refused, STAGED, TRIAL_S,
};
pub use display::{Display, LAMP_NAMES, LAMPS, Overrides, Shown, levels};
pub use doubt::{Doubt, Doubts};
pub use events::{
    Appended, EVENT_BYTES, Event, EventCause, EventLog, Journal, LOG_EVENTS, LOG_PAGES, LogFlash,
    Situation, place_of,
};
pub use fault_record::{FAULT_RECORD_WORDS, FaultCause, FaultRecord};
pub use frame::Frame;
pub use framing::{FrameError, MAX_FRAME_BYTES};
pub use image::{IMAGE_WORDS, ImageError, MotorImage};
pub use learn::{LEARN_WINDOWS, LearnState, Learner, Progress, Refusal};
pub use message::Message;
pub use relay::{Relay, RelayMode};
pub use stuck::StuckChannels;
