//! What an audit says.

use recording::Channel;
use schemars::JsonSchema;
use serde::Serialize;

/// The kinds of finding; the names are stable in JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Code {
    /// A channel ran into the end of its range; value: the level.
    Clipping,
    /// Time without samples; value: the longest, s.
    Gap,
    /// A channel does not follow what it measures.
    Stuck,
    /// Currents and voltages do not belong to the same phases.
    SwappedPhases,
    /// The phases follow each other as a, c, b.
    PhaseOrder,
    /// A channel, or all currents, are inverted.
    Polarity,
    /// A channel has a mean that it should not have; value: the mean.
    Offset,
    /// Three channels do not add up to zero; value: percent of the positive sequence.
    ZeroSequence,
    /// Line voltages taken as phase voltages; value: ratio to the rated phase voltage.
    LineVoltages,
    /// Effective values instead of instantaneous ones.
    RmsValues,
    /// A unit other than the declared one; value: the factor.
    Unit,
    /// The sampling clock; value: percent jitter, or samples per period.
    Clock,
    /// No periodic supply was found.
    NotLocked,
    /// Negative sequence of the voltages; value: percent of the positive sequence.
    SupplyUnbalance,
    /// Harmonics of the voltages; value: total harmonic distortion, percent.
    SupplyHarmonics,
    /// The speed cannot be this motor's; value: slip, percent.
    SpeedImplausible,
    /// The scale of a channel was declared unknown; value: 1.
    ScaleUnknown,
    /// Channels look like the output of a sensor whose scale was not said; value: ratio to the rated amplitude.
    SensorScale,
    /// A channel that judging needs is absent.
    ChannelMissing,
    /// Samples far off their neighbours were bridged; value: how many.
    Spikes,
    /// All channels hold their values; value: the longest stretch, s.
    Frozen,
    /// A channel is refreshed more slowly than rows are written; value: rows per refresh.
    Held,
    /// Channels were sampled one after the other; value: the step within three of a kind, us.
    Skew,
    /// Voltages and currents were sampled by two clocks; value: how much faster the currents' runs, ppm.
    ClockDrift,
    /// Samples are missing though the times go on evenly; value: how often.
    LostSamples,
    /// The supply's frequency is not the rated one, by an inverter or a wrong sampling rate; value: the frequency, Hz.
    SupplyFrequency,
    /// The motor turns where the recording is said to begin at standstill; value: the speed, rad/s.
    StartsFrom,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// What kind it is.
    pub code: Code,
    /// The channel, or several separated by blanks.
    pub channel: String,
    /// The one channel of several that is to blame, where that can be told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub suspect: Option<String>,
    /// How much; finite.
    pub value: f64,
    /// Unit of `value`.
    pub unit: String,
    /// A sentence that says what was seen, and the remedy.
    pub detail: String,
    /// Whether this alone makes the recording unusable.
    pub refuses: bool,
    /// Begin of the stretch that is concerned, s, where it is not the whole recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_s: Option<f64>,
    /// End of that stretch, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to_s: Option<f64>,
    /// Share of the recording's pieces that have it, where it was audited in several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
}

/// The audit of one recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Audit {
    /// Whether anything trustworthy can be computed from the recording.
    pub supported: bool,
    /// What was found, in a fixed order.
    pub findings: Vec<Finding>,
    /// What had to be assumed to read the file, one sentence each.
    pub assumptions: Vec<String>,
    /// Channels that must not be used, though the recording can be: dead, implausible.
    pub unusable: Vec<String>,
}

impl Finding {
    pub(super) fn new(code: Code, channel: impl ToString, value: f64, unit: &str) -> Finding {
        Finding {
            code,
            channel: channel.to_string(),
            suspect: None,
            value: if value.is_finite() { value } else { 0.0 },
            unit: unit.to_owned(),
            detail: String::new(),
            refuses: false,
            from_s: None,
            to_s: None,
            share: None,
        }
    }

    pub(super) fn detail(self, detail: impl Into<String>) -> Finding {
        Finding {
            detail: detail.into(),
            ..self
        }
    }

    pub(super) fn suspecting(self, channel: Option<Channel>) -> Finding {
        Finding {
            suspect: channel.map(|channel| channel.to_string()),
            ..self
        }
    }

    pub(super) fn within(self, from_s: f64, to_s: f64) -> Finding {
        Finding {
            from_s: Some(from_s),
            to_s: Some(to_s),
            ..self
        }
    }

    pub(super) fn refusing(self) -> Finding {
        Finding {
            refuses: true,
            ..self
        }
    }
}

/// Decimals to which a number is rounded at most: ten to that power is one.
const MOST_DECIMALS: i32 = 300;

/// A number to so many significant digits, without powers of ten where it is near 1.
pub fn digits(x: f64, significant: i32) -> String {
    let decimals = significant - 1 - x.abs().max(f64::MIN_POSITIVE).log10().floor() as i32;
    let scale = 10_f64.powi(decimals.min(MOST_DECIMALS));
    let rounded = (x * scale).round() / scale;
    match rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs()) {
        true => format!("{rounded}"),
        false => format!("{rounded:e}"),
    }
}

/// How many of something there are, the word in the singular or with an s.
pub(super) fn count(many: usize, one: &str) -> String {
    match many {
        1 => format!("1 {one}"),
        _ => format!("{many} {one}s"),
    }
}

/// Channel names separated by blanks.
pub(super) fn names(channels: &[Channel]) -> String {
    let names: Vec<String> = channels.iter().map(Channel::to_string).collect();
    names.join(" ")
}

#[cfg(test)]
mod tests {
    use super::{count, digits};

    #[test]
    fn numbers_are_short() {
        let told = [817.2, 0.1192, 1.0, 0.002_004, 12_345.0, 3.2e-9].map(|x| digits(x, 3));
        assert_eq!(told, ["817", "0.119", "1", "0.002", "12300", "3.2e-9"]);
        assert_eq!([0.0, 1e-310].map(|x| digits(x, 3)), ["0", "0"]);
        assert_eq!(digits(4.999_999_999_998_863, 6), "5");
        assert_eq!([count(1, "gap"), count(3, "gap")], ["1 gap", "3 gaps"]);
    }
}
