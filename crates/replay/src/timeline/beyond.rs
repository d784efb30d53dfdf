//! How much of a recording lies beyond what the calibration of its motor saw.

use monitor::Beyond;
use schemars::JsonSchema;
use serde::Serialize;

/// Windows beyond the currents, voltages and frequencies of the calibration; there less is known of the motor, and smaller faults
/// stay dark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct BeyondCalibration {
    /// Judged windows that lie a hundredth and more beyond.
    pub windows: u64,
    /// Farthest current beyond the largest of the calibration, percent of it.
    pub current_percent: f64,
    /// Farthest voltage over frequency from those of the calibration, percent of the nearest.
    pub volt_per_hertz_percent: f64,
    /// Farthest supply frequency from those of the calibration, percent of the nearest.
    pub frequency_percent: f64,
}

/// Less than this is not worth a word.
const TOLD_PERCENT: f64 = 1.0;

impl BeyondCalibration {
    pub(super) fn add(&mut self, beyond: &Beyond) {
        let seen = beyond.from_seen();
        let [current, volt_per_hertz, frequency] = seen.map(|share| 100.0 * f64::from(share).abs());
        let farthest = current.max(volt_per_hertz).max(frequency);
        if farthest < TOLD_PERCENT {
            return;
        }
        self.windows += 1;
        self.current_percent = self.current_percent.max(current);
        self.volt_per_hertz_percent = self.volt_per_hertz_percent.max(volt_per_hertz);
        self.frequency_percent = self.frequency_percent.max(frequency);
    }

    /// What lies beyond, in words; `None` where nothing does.
    pub fn words(&self) -> Option<String> {
        let parts = [
            ("current up to", self.current_percent, "above"),
            (
                "voltage over frequency up to",
                self.volt_per_hertz_percent,
                "off",
            ),
            ("frequency up to", self.frequency_percent, "off"),
        ];
        let told = parts
            .iter()
            .filter(|(_, percent, _)| *percent >= TOLD_PERCENT);
        let told: Vec<String> = told
            .map(|(what, percent, where_to)| format!("{what} {percent:.0} % {where_to}"))
            .collect();
        (self.windows > 0).then(|| told.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_lies_beyond_is_told() {
        let mut beyond = BeyondCalibration::default();
        beyond.add(&Beyond {
            current: 0.003,
            ..Beyond::default()
        });
        assert_eq!(beyond.words(), None, "noise");
        beyond.add(&Beyond {
            volt_per_hertz: -0.05,
            ..Beyond::default()
        });
        beyond.add(&Beyond {
            current: 0.5,
            volt_per_hertz: 0.02,
            ..Beyond::default()
        });
        assert_eq!(beyond.windows, 2);
        assert_eq!(
            beyond.words().as_deref(),
            Some("current up to 51 % above, voltage over frequency up to 5 % off"),
            "beside half a per cent that a grid wanders by"
        );
    }
}
