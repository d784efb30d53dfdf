//! A lamp in one character.

use monitor::Lamp;

/// Full, half or empty.
pub(crate) fn symbol(lamp: Lamp) -> &'static str {
    match lamp {
        Lamp::On => "●",
        Lamp::Blink => "◐",
        Lamp::Off => "○",
    }
}
