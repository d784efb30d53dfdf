//! Colours; `anstream` drops them for files, pipes and NO_COLOR.

use anstyle::{AnsiColor, Style};

/// A piece of text in a style.
pub struct Painted<T>(Style, T);

impl<T: std::fmt::Display> std::fmt::Display for Painted<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}{}", self.0.render(), self.1, self.0.render_reset())
    }
}

fn coloured<T>(colour: AnsiColor, text: T) -> Painted<T> {
    Painted(colour.on_default().bold(), text)
}

/// Red.
pub fn error<T>(text: T) -> Painted<T> {
    coloured(AnsiColor::Red, text)
}

/// Green.
pub fn good<T>(text: T) -> Painted<T> {
    coloured(AnsiColor::Green, text)
}

/// Yellow.
pub fn caution<T>(text: T) -> Painted<T> {
    coloured(AnsiColor::Yellow, text)
}

/// Bold.
pub fn strong<T>(text: T) -> Painted<T> {
    Painted(Style::new().bold(), text)
}

/// Dim.
pub fn faint<T>(text: T) -> Painted<T> {
    Painted(Style::new().dimmed(), text)
}
