//! Numbers as people read them; each carries the address it was taken from.

use maud::{Markup, html};

use super::place::Place;

/// How a number is written.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    digits: Digits,
    scale: f64,
    signed: bool,
}

#[derive(Clone, Copy, Debug)]
enum Digits {
    After(usize),
    Significant(usize),
}

/// With this many digits after the point.
pub const fn decimals(after: usize) -> Style {
    Style {
        digits: Digits::After(after),
        scale: 1.0,
        signed: false,
    }
}

/// With this many significant digits, for quantities of unknown size.
pub const fn significant(digits: usize) -> Style {
    Style {
        digits: Digits::Significant(digits),
        scale: 1.0,
        signed: false,
    }
}

impl Style {
    /// Multiplied before it is written: 100 turns a share into percent, 1000 s into ms.
    pub const fn times(self, scale: f64) -> Self {
        Style { scale, ..self }
    }

    /// With a plus where it is positive.
    pub const fn signed(self) -> Self {
        Style {
            signed: true,
            ..self
        }
    }

    /// The text of `x`.
    pub fn text(self, x: f64) -> String {
        let x = x * self.scale;
        let text = match self.digits {
            Digits::After(after) => fixed(x, after),
            Digits::Significant(digits) => rounded(x, digits),
        };
        let plus = if self.signed && x > 0.0 { "+" } else { "" };
        format!("{plus}{}", text.replace('-', "\u{2212}"))
    }
}

/// A zero never keeps the sign of what was rounded away.
fn fixed(x: f64, after: usize) -> String {
    let text = format!("{x:.after$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.replace('-', "") } else { text }
}

fn rounded(x: f64, digits: usize) -> String {
    let exponent = if x == 0.0 {
        0
    } else {
        x.abs().log10().floor() as i32
    };
    if !(-4..=6).contains(&exponent) {
        return format!("{x:.*e}", digits - 1);
    }
    let after = (digits as i32 - 1 - exponent).max(0);
    fixed(x, after as usize)
}

/// The number under `path`, or a dash.
pub fn shown(place: &Place<'_>, path: &str, style: Style) -> Markup {
    match place.number(path) {
        Some(x) => html! {
            data value=(x) data-from=(place.pointer_to(path)) data-scale=(style.scale) { (style.text(x)) }
        },
        None => html! { span { "–" } },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_and_signed_as_asked() {
        assert_eq!(decimals(2).text(-1.3826), "\u{2212}1.38");
        assert_eq!(decimals(1).text(-0.02), "0.0");
        assert_eq!(decimals(0).signed().text(50.0), "+50");
        assert_eq!(decimals(1).times(100.0).text(0.4847), "48.5");
        assert_eq!(significant(4).text(0.010_735_192), "0.01074");
        assert_eq!(significant(3).text(6123.4), "6123");
        assert_eq!(significant(3).text(7.5e-5), "7.50e\u{2212}5");
        assert_eq!(significant(3).text(0.0), "0.00");
    }
}
