//! The door of the panel: lamps, button, relay.

pub mod button;
pub mod display;
pub mod relay;
