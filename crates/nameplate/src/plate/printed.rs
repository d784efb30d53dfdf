//! A number as it is printed: its digits say how far it may be rounded.

use std::fmt;
use std::str::FromStr;

/// A printed number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// The number.
    pub value: f64,
    /// Half a step of its last digit: the true value is within `value +- half_step`.
    pub half_step: f64,
}

/// Why a text is no number of a plate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("\"{0}\" is not a number above 0; write digits with a decimal point, such as 5.5")]
pub struct NotANumber(pub String);

impl Printed {
    /// A number without rounding.
    pub fn exact(value: f64) -> Printed {
        Printed {
            value,
            half_step: 0.0,
        }
    }

    /// The number in another unit.
    pub fn times(self, factor: f64) -> Printed {
        Printed {
            value: self.value * factor,
            half_step: self.half_step * factor,
        }
    }

    /// Half a step relative to the number.
    pub fn relative(self) -> f64 {
        self.half_step / self.value
    }
}

impl FromStr for Printed {
    type Err = NotANumber;

    fn from_str(text: &str) -> Result<Printed, NotANumber> {
        let text = text.trim();
        let refused = || NotANumber(text.to_owned());
        let value: f64 = text.parse().map_err(|_| refused())?;
        if !(value.is_finite() && value > 0.0) {
            return Err(refused());
        }
        let half_step = 0.5 * 10f64.powi(-decimals(text));
        Ok(Printed { value, half_step })
    }
}

/// Digits after the decimal point, less the power of ten that follows.
fn decimals(text: &str) -> i32 {
    let (digits, power) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let after = digits.split_once('.').map_or(0, |(_, after)| after.len());
    i32::try_from(after).unwrap_or(i32::MAX) - power.parse::<i32>().unwrap_or(0)
}

impl fmt::Display for Printed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_digits_say_the_step() {
        let half = |text: &str| text.parse::<Printed>().unwrap().half_step;
        assert_eq!(half("5.5"), 0.05);
        assert_eq!(half("1455"), 0.5);
        assert!((half("0.850") - 0.0005).abs() < 1e-18);
        assert!((half("1.5e1") - 0.5).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_positive_number_is_refused() {
        for text in ["", "abc", "nan", "inf", "-3", "0", "1,5"] {
            assert!(text.parse::<Printed>().is_err(), "{text}");
        }
    }
}
