//! Reads `[sensors.chain]`.

use super::{Carrier, ChannelChain, Inl, InlShape, Reference, SignalChain};
use document::{Bounds, Section, Value};

const TIME_CONSTANT: Bounds = Bounds::above(0.0, 10_000.0, "us").hint("78 is 78 microseconds");
const CORNER: Bounds = Bounds::between(10.0, 1e6, "Hz");
const DELAY: Bounds = Bounds::between(0.0, 1000.0, "us")
    .hint("only differences between channels matter: add the same to all of them");
const PERCENT: Bounds = Bounds::between(-50.0, 50.0, "percent");
const VOLTAGE: Bounds = Bounds::between(-1e6, 1e6, "V");
const CURRENT: Bounds = Bounds::between(-1e6, 1e6, "A");
const RIPPLE_VOLTAGE: Bounds = Bounds::between(0.0, 1e6, "V");
const RIPPLE_CURRENT: Bounds = Bounds::between(0.0, 1e6, "A");
const CARRIER: Bounds = Bounds::between(0.0, 1e6, "Hz");
const CROSSTALK: Bounds = Bounds::between(0.0, 10.0, "percent");
const INL: Bounds = Bounds::between(0.0, 64.0, "LSB");
const REFERENCE: Bounds = Bounds::between(-20.0, 20.0, "percent");
const CONVERSIONS: Bounds = Bounds::between(1.0, 16.0, "conversions").hint("the board adds 16");
/// A day at this is far beyond any converter; together with the length of the experiment it is checked again.
const DRIFT: Bounds = Bounds::between(-10.0, 10.0, "percent per second");
/// Beyond this the reference is not wrong but gone.
const LARGEST_REFERENCE_ERROR: f64 = 0.5;

const SHAPES: [(&str, InlShape); 3] = [
    ("bow", InlShape::Bow),
    ("cubic", InlShape::Cubic),
    ("bits", InlShape::Bits),
];
const REFERENCES: [(&str, bool); 2] = [("absolute", false), ("ratiometric", true)];

/// The keys of one group of three channels.
struct Group {
    filter_us: &'static str,
    filter_hz: &'static str,
    delay_us: &'static str,
    gain: &'static str,
    offset: &'static str,
    offset_bounds: Bounds,
    reference: &'static str,
}

const VOLTAGES: Group = Group {
    filter_us: "voltage_filter_us",
    filter_hz: "voltage_filter_hz",
    delay_us: "voltage_delay_us",
    gain: "voltage_gain_error_percent",
    offset: "voltage_offset_volt",
    offset_bounds: VOLTAGE,
    reference: "voltage_reference",
};

const CURRENTS: Group = Group {
    filter_us: "current_filter_us",
    filter_hz: "current_filter_hz",
    delay_us: "current_delay_us",
    gain: "current_gain_error_percent",
    offset: "current_offset_amp",
    offset_bounds: CURRENT,
    reference: "current_reference",
};

/// The chain of a `[sensors]` section; `None` inside where there is none. `bits` is the converter's resolution.
pub(crate) fn read(
    sensors: &Section<'_>,
    duration_s: Option<f64>,
    bits: Option<u32>,
) -> Option<Option<SignalChain>> {
    let Some(section) = sensors.optional_section("chain")? else {
        return Some(None);
    };
    let chain = read_values(&section);
    if let Some(chain) = &chain {
        check_reference(&section, &chain.reference, duration_s);
        check_conversions(&section, chain.conversions, bits);
    }
    section.finish();
    chain.map(Some)
}

fn read_values(section: &Section<'_>) -> Option<SignalChain> {
    let voltages = group(section, &VOLTAGES);
    let currents = group(section, &CURRENTS);
    let carrier = carrier(section);
    let crosstalk = section.number_or("crosstalk_percent", &CROSSTALK, 0.0);
    let lsb = section.number_or("inl_lsb", &INL, 0.0);
    let shape = section.choice_or("inl_shape", &SHAPES, InlShape::Bow);
    let error = section.number_or("reference_error_percent", &REFERENCE, 0.0);
    let drift = section.number_or("reference_drift_percent_per_s", &DRIFT, 0.0);
    let conversions = section.integer_or("conversions_per_sample", &CONVERSIONS, 1);
    let [a, b, c] = voltages?;
    let [d, e, f] = currents?;
    Some(SignalChain {
        channels: [a, b, c, d, e, f],
        carrier: carrier?,
        crosstalk: crosstalk? / 100.0,
        inl: Inl {
            lsb: lsb?,
            shape: shape?,
        },
        reference: Reference {
            error: error? / 100.0,
            drift_per_s: drift? / 100.0,
        },
        conversions: conversions?,
    })
}

fn group(section: &Section<'_>, keys: &Group) -> Option<[ChannelChain; 3]> {
    let filter = filter(section, keys);
    let delay = one_or_three(section, keys.delay_us, &DELAY);
    let gain = one_or_three(section, keys.gain, &PERCENT);
    let offset = one_or_three(section, keys.offset, &keys.offset_bounds);
    let ratiometric = section.choice_or(keys.reference, &REFERENCES, false);
    let (filter, delay, gain, offset) = (filter?, delay?, gain?, offset?);
    let ratiometric = ratiometric?;
    Some(std::array::from_fn(|k| ChannelChain {
        time_constants_s: filter[k],
        delay_s: 1e-6 * delay[k],
        gain_error: gain[k] / 100.0,
        offset: offset[k],
        ratiometric,
    }))
}

/// Time constants of the three channels, s: two for the whole group, or a corner for it or for each.
fn filter(section: &Section<'_>, keys: &Group) -> Option<[[f64; 2]; 3]> {
    if section.has(keys.filter_us) && section.has(keys.filter_hz) {
        let message = format!("{} is given as well: keep one of the two", keys.filter_hz);
        section.report(keys.filter_us, message);
    }
    let constants = section.list(keys.filter_us, &TIME_CONSTANT);
    // Asked for in any case, so that errors can name the key.
    let corners = one_or_three(section, keys.filter_hz, &CORNER);
    let corners = corners.map(|corners| section.has(keys.filter_hz).then_some(corners));
    let of_corner = |hertz: f64| [1.0 / (std::f64::consts::TAU * hertz), 0.0];
    match (corners?, constants?.as_slice()) {
        (Some(corners), _) => Some(corners.map(of_corner)),
        (None, []) => Some([[0.0; 2]; 3]),
        (None, [first]) => Some([[1e-6 * first, 0.0]; 3]),
        (None, [first, second]) => Some([[1e-6 * first, 1e-6 * second]; 3]),
        (None, more) => {
            let message = format!("has {} values: write one or two in brackets", more.len());
            section.report(keys.filter_us, message);
            None
        }
    }
}

fn carrier(section: &Section<'_>) -> Option<Carrier> {
    let frequency = section.number_or("carrier_hz", &CARRIER, 0.0);
    let voltage = section.number_or("carrier_ripple_volt", &RIPPLE_VOLTAGE, 0.0);
    let current = section.number_or("carrier_ripple_amp", &RIPPLE_CURRENT, 0.0);
    let carrier = Carrier {
        frequency_hz: frequency?,
        voltage_volt: voltage?,
        current_amp: current?,
    };
    let ripple = carrier.voltage_volt != 0.0 || carrier.current_amp != 0.0;
    if ripple && carrier.frequency_hz == 0.0 {
        let key = ["carrier_ripple_volt", "carrier_ripple_amp"]
            .into_iter()
            .find(|key| section.has(key));
        let message = "has no frequency: add carrier_hz, the switching frequency of the inverter";
        section.report(key.unwrap_or("carrier_hz"), message);
    }
    Some(carrier)
}

/// A number for all three phases, or three in brackets.
fn one_or_three(section: &Section<'_>, key: &str, bounds: &Bounds) -> Option<[f64; 3]> {
    let is_list =
        |entry: &&document::Entry| entry.key == key && matches!(entry.value, Value::Array(_));
    match section.entries().iter().find(is_list) {
        Some(_) => Some(section.optional_numbers(key, bounds)?.unwrap_or([0.0; 3])),
        None => Some([section.number_or(key, bounds, 0.0)?; 3]),
    }
}

/// The sum of all codes is the core's code of 16 bits.
fn check_conversions(section: &Section<'_>, conversions: u32, bits: Option<u32>) {
    let Some(bits) = bits else {
        return;
    };
    if conversions << bits > 1 << 16 {
        section.report(
            "conversions_per_sample",
            format!(
                "{conversions} codes of {bits} bits are more than 16 bits hold: write at most {}, or lower adc_bits",
                (1_u32 << 16) >> bits
            ),
        );
    }
}

fn check_reference(section: &Section<'_>, reference: &Reference, duration_s: Option<f64>) {
    let end = reference.error + reference.drift_per_s * duration_s.unwrap_or(0.0);
    if end.abs() > LARGEST_REFERENCE_ERROR {
        section.report(
            "reference_drift_percent_per_s",
            format!(
                "leaves the reference {:.0} % off at the end: at most {:.0} %, lower it",
                100.0 * end,
                100.0 * LARGEST_REFERENCE_ERROR
            ),
        );
    }
}
