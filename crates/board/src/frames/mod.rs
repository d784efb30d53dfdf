//! What goes over the virtual COM port: frames, and the samples around an alarm.

pub mod capture;
pub mod frame;
pub mod framing;
pub mod message;
