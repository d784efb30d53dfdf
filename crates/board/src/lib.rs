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

mod calibration;
mod checksum;
#[cfg(test)]
mod chip;
mod configuration;
mod door;
mod events;
mod frames;
mod health;
mod image;
mod learn;
pub mod modbus;
mod seconds;

pub use calibration::{
    COVARIANCES, Calibration, CalibrationSource, ChannelTrim, Healthy, Loaded, PAGE_BYTES, PAGES,
    RECORD_BYTES, Store, StoreError,
};
pub use checksum::{Checksum, crc32, crc32_words};
pub use configuration::{
    ACTIVE, CONFIGURATION_PAGES, CONFIGURATION_REGISTERS, CONFIGURATION_WORDS, Compiled,
    Configuration, ConfigurationSource, ConfigurationStore, Configurator, Desk, Line, LineParity,
    NAME_BYTES, Name, Refused, STAGED, TRIAL_S,
};
pub use door::button::{Button, Press};
pub use door::display::{Display, LAMP_NAMES, LAMPS, Overrides, Shown, levels};
pub use door::relay::{Relay, RelayMode};
pub use events::{
    Appended, EVENT_BYTES, Event, EventCause, EventLog, Journal, LOG_EVENTS, LOG_PAGES, Situation,
    place_of,
};
pub use frames::capture::{
    CAPTURE_BYTES, CAPTURE_EVERY, CAPTURE_HEAD_BYTES, CAPTURE_INSTANTS, Capture, CaptureAlarm,
    CaptureChunk, CaptureHead, CaptureState, captured_samples,
};
pub use frames::frame::Frame;
pub use frames::framing::{FrameError, MAX_FRAME_BYTES};
pub use frames::message::Message;
pub use health::doubt::{Doubt, Doubts};
pub use health::fault_record::{FAULT_RECORD_WORDS, FaultCause, FaultRecord};
pub use health::stuck::StuckChannels;
pub use image::{IMAGE_WORDS, ImageError, MotorImage};
pub use learn::{LEARN_WINDOWS, LearnState, Learner, Progress, Refusal};
pub use seconds::{SECOND_BYTES, SECONDS, Second, SecondRing, place_of_second};
