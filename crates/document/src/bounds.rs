//! The allowed range of a number in a file, with its unit and a hint for the usual slip.

/// An allowed range; prints itself in error messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    low: f64,
    low_allowed: bool,
    high: f64,
    unit: &'static str,
    hint: &'static str,
}

impl Bounds {
    /// `low < x <= high`.
    pub const fn above(low: f64, high: f64, unit: &'static str) -> Bounds {
        Bounds {
            low,
            low_allowed: false,
            high,
            unit,
            hint: "",
        }
    }

    /// `low <= x <= high`.
    pub const fn between(low: f64, high: f64, unit: &'static str) -> Bounds {
        Bounds {
            low_allowed: true,
            ..Bounds::above(low, high, unit)
        }
    }

    /// Adds what usually went wrong when the value is out of range, as a sentence.
    pub const fn hint(self, hint: &'static str) -> Bounds {
        Bounds { hint, ..self }
    }

    /// Whether a value is finite and inside the range.
    pub fn contains(&self, x: f64) -> bool {
        let above = x > self.low || (self.low_allowed && x == self.low);
        x.is_finite() && above && x <= self.high
    }

    /// The range in words: `above 0 and at most 100000 ohm`.
    pub fn describe(&self) -> String {
        let low = if self.low_allowed {
            "at least"
        } else {
            "above"
        };
        let unit = if self.unit.is_empty() { "" } else { " " };
        format!(
            "{low} {} and at most {}{unit}{}",
            self.low, self.high, self.unit
        )
    }

    /// What is wrong with a value outside the range, or nothing.
    pub fn complaint(&self, x: f64) -> Option<String> {
        if self.contains(x) {
            return None;
        }
        let what = if x.is_finite() {
            "is out of range"
        } else {
            "is not a finite number"
        };
        let hint = if self.hint.is_empty() {
            String::new()
        } else {
            format!(" ({})", self.hint)
        };
        Some(format!("{x} {what}: write {}{hint}", self.describe()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_and_closed_ends_differ_at_the_low_end_only() {
        let open = Bounds::above(0.0, 10.0, "ohm");
        let closed = Bounds::between(0.0, 10.0, "ohm");
        assert!(!open.contains(0.0) && closed.contains(0.0));
        assert!(open.contains(10.0) && closed.contains(10.0));
        assert!(!open.contains(10.1) && !closed.contains(-0.1));
    }

    #[test]
    fn a_complaint_names_value_range_unit_and_hint() {
        let bounds = Bounds::above(0.0, 5.0, "H").hint("millihenry?");
        assert_eq!(
            bounds.complaint(28.0).as_deref(),
            Some("28 is out of range: write above 0 and at most 5 H (millihenry?)")
        );
        assert!(
            bounds
                .complaint(f64::NAN)
                .is_some_and(|text| text.contains("not a finite number"))
        );
        assert_eq!(bounds.complaint(1.0), None);
    }
}
