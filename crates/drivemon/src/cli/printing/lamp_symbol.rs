//! A lamp in one character.

/// Of a lamp that is `on`, `blink` or `off`.
pub(crate) fn symbol(lamp: &str) -> &'static str {
    match lamp {
        "on" => "●",
        "blink" => "◐",
        _ => "○",
    }
}
