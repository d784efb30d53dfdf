//! Commands that simulate a motor.

pub(crate) mod campaign;
pub(crate) mod demo;
pub(crate) mod simulate;

use report::json::Format;

/// The formats of their JSON.
pub fn formats() -> Vec<Format> {
    vec![
        Format::of::<demo::DemoJson>(),
        Format::of::<campaign::TableJson>(),
    ]
}
