//! What supply and load can do.

use document::{Bounds, Document, FileError, Section};

const PERCENT: Bounds = Bounds::between(0.0, 200.0, "%").hint("percent of the rated value");
const FREQUENCY: Bounds = Bounds::between(1.0, 400.0, "Hz");
/// Whether a drive feeds the motor.
const SUPPLIES: [(&str, bool); 2] = [("grid", false), ("drive", true)];
const DURATION: Bounds = Bounds::between(2.0, 60.0, "s");

/// The next experiment that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct NextRun {
    /// What supply and load can do.
    pub limits: Limits,
    /// The motor file as the scenario file of the run names it.
    pub motor_file: String,
}

/// Limits of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Whether a drive sets frequency and voltage; otherwise a grid.
    pub drive: bool,
    /// Lowest and highest load, share of rated torque.
    pub load: [f64; 2],
    /// Lowest and highest voltage, share of rated; behind a drive of what belongs to the frequency.
    pub voltage: [f64; 2],
    /// Lowest and highest frequency, Hz; behind a drive only.
    pub frequency_hz: [f64; 2],
    /// Length of the recording, s.
    pub duration_s: f64,
    /// Whether the motor may be started while it is recorded.
    pub start: bool,
    /// Whether the supply may be switched off while the motor runs.
    pub coast_down: bool,
}

impl Limits {
    /// What most test benches can do: loads up to the rated torque, a start, a coast-down; the voltage is what the grid
    /// gives, or what belongs to a drive's frequency (rated `frequency_hz`).
    pub fn usual(drive: bool, frequency_hz: f64) -> Self {
        Self {
            drive,
            load: [0.0, 1.0],
            voltage: [1.0, 1.0],
            frequency_hz: match drive {
                true => [0.2 * frequency_hz, frequency_hz],
                false => [frequency_hz, frequency_hz],
            },
            duration_s: 6.0,
            start: true,
            coast_down: !drive,
        }
    }

    /// From TOML text; what is not written is [`Limits::usual`] for a motor of this rated frequency (Hz).
    ///
    /// # Errors
    /// Text that is not TOML, unknown keys, values out of range or ranges that are upside down, each with its line.
    pub fn parse(text: &str, file: &str, frequency_hz: f64) -> Result<Self, FileError> {
        let document = Document::parse(text, file)?;
        let root = document.root();
        let limits = read(&root, frequency_hz);
        root.finish();
        document.finish(limits)
    }
}

fn read(root: &Section<'_>, rated: f64) -> Option<Limits> {
    let drive = root.choice_or("supply", &SUPPLIES, false)?;
    let usual = Limits::usual(drive, rated);
    let percent = |key: &str, usual: [f64; 2]| {
        let [low, high] = range(root, key, &PERCENT, usual.map(|x| 100.0 * x))?;
        Some([low / 100.0, high / 100.0])
    };
    let load = percent("load_percent", usual.load);
    let voltage = percent("voltage_percent", usual.voltage);
    let frequency = range(root, "frequency_hz", &FREQUENCY, usual.frequency_hz);
    let duration = root.number_or("duration_s", &DURATION, usual.duration_s);
    let start = root.flag_or("start", usual.start);
    let coast_down = root.flag_or("coast_down", usual.coast_down);
    Some(Limits {
        drive,
        load: load?,
        voltage: voltage?,
        frequency_hz: frequency?,
        duration_s: duration?,
        start: start?,
        coast_down: coast_down?,
    })
}

/// Lowest and highest value, in this order.
fn range(root: &Section<'_>, key: &str, bounds: &Bounds, usual: [f64; 2]) -> Option<[f64; 2]> {
    let Some([low, high]) = root.optional_numbers(key, bounds)? else {
        return Some(usual);
    };
    if low > high {
        root.report(
            key,
            format!("{low} is above {high}: write the lower number first"),
        );
        return None;
    }
    Some([low, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_written_is_usual() {
        let limits = Limits::parse("start = true", "limits.toml", 50.0).expect("usual");
        assert_eq!(limits, Limits::usual(false, 50.0));
        let text = "supply = \"drive\"\nload_percent = [10, 80]\nfrequency_hz = [5, 45]\nstart = false\nduration_s = 4";
        let limits = Limits::parse(text, "limits.toml", 50.0).expect("limits");
        assert_eq!(
            (limits.load, limits.frequency_hz),
            ([0.1, 0.8], [5.0, 45.0])
        );
        assert!(limits.drive && !limits.start && !limits.coast_down && limits.duration_s == 4.0);
    }

    #[test]
    fn slips_are_named_with_their_line() {
        let wrong =
            "supply = \"grid\"\nload_percent = [80, 10]\nvoltage_percent = [90, 900]\nspeed = 3";
        let said = Limits::parse(wrong, "limits.toml", 50.0)
            .expect_err("wrong")
            .to_string();
        for part in [
            "limits.toml:2",
            "lower number first",
            "limits.toml:3",
            "limits.toml:4",
            "speed",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
}
