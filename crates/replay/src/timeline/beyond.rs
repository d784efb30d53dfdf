//! How much of a recording lies beyond what the calibration of its motor saw.

use monitor::Beyond;
use schemars::JsonSchema;
use serde::Serialize;

/// Windows beyond the currents, voltages, frequencies and slips of the calibration, loaded more lightly or feeding back where it always drove; there less is known of the motor, and smaller faults
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
    /// Farthest active current below the smallest of the calibration, percent of the rated current.
    pub lighter_percent: f64,
    /// Largest active current fed back beyond the calibration, percent of the rated current.
    pub fed_back_percent: f64,
    /// Highest frequency in the cage beyond that of loads, percent of the rated frequency.
    pub slip_percent: f64,
}

/// Less than this is not worth a word.
const TOLD_PERCENT: f64 = 1.0;

impl BeyondCalibration {
    pub(super) fn add(&mut self, beyond: &Beyond) {
        let seen = beyond.from_seen();
        let percent = [
            seen.current,
            seen.volt_per_hertz,
            seen.frequency,
            seen.lighter,
            seen.fed_back,
            seen.slip,
        ]
        .map(|share| 100.0 * f64::from(share).abs());
        if percent.iter().all(|percent| *percent < TOLD_PERCENT) {
            return;
        }
        self.windows += 1;
        let farthest = [
            &mut self.current_percent,
            &mut self.volt_per_hertz_percent,
            &mut self.frequency_percent,
            &mut self.lighter_percent,
            &mut self.fed_back_percent,
            &mut self.slip_percent,
        ];
        for (farthest, percent) in farthest.into_iter().zip(percent) {
            *farthest = farthest.max(percent);
        }
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
            (
                "active current up to",
                self.lighter_percent,
                "of the rated current below",
            ),
            (
                "fed back up to",
                self.fed_back_percent,
                "of the rated current",
            ),
            ("frequency in the cage up to", self.slip_percent, "above"),
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

    #[test]
    fn a_load_that_drives_and_a_shaft_that_is_held_are_told() {
        let mut beyond = BeyondCalibration::default();
        beyond.add(&Beyond {
            fed_back: 0.545,
            slip: 0.8,
            ..Beyond::default()
        });
        assert_eq!(
            beyond.words().as_deref(),
            Some(
                "fed back up to 40 % of the rated current, frequency in the cage up to 80 % above"
            ),
            "without 15 % that losses take, and half a per cent"
        );
    }
}
