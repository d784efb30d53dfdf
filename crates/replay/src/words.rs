//! What the core's findings are called in front of people.

use crate::RotorSummary;
use monitor::{NotJudged, SensorFinding, Sidebands, SupplyFinding};

/// Why a window was not judged, with what to do about it.
pub fn not_judged(reason: NotJudged) -> String {
    match reason {
        NotJudged::NotLocked => "no periodic supply between 5 and 100 Hz".to_owned(),
        NotJudged::Settling => "the first cycles after the supply was found".to_owned(),
        NotJudged::Clipped => "a channel clips: choose a larger full scale".to_owned(),
        NotJudged::Invalid => "samples that are no numbers, or that stand still".to_owned(),
        NotJudged::NoVoltages => "voltages are not recorded".to_owned(),
        NotJudged::NoCurrents => "currents are not recorded".to_owned(),
        NotJudged::NoSpeed => "speed is not recorded".to_owned(),
        NotJudged::Supply(finding) => supply(finding).to_owned(),
        NotJudged::Sensor(finding) => sensor(finding),
        NotJudged::Transient => "transient: current or speed are changing".to_owned(),
        NotJudged::NoLoadCurrent => "the motor draws no current".to_owned(),
        NotJudged::Noise => "noise hides what the lamps are to show".to_owned(),
        NotJudged::Reversing => {
            "the shaft turns against the field: braking or reversing".to_owned()
        }
    }
}

/// How a field that does not only turn forwards is told.
pub fn direction(name: &str) -> &'static str {
    match name {
        "backwards" => {
            "the field turns backwards, phases a, c, b: the motor was judged as its mirror image"
        }
        "both" => {
            "the field turns in both directions: where it turns backwards the motor was judged as its mirror image"
        }
        _ => "the field turns forwards",
    }
}

/// The reason that a board's frame gives by its number; `None` for a judged window.
pub fn reason(number: u8) -> Option<String> {
    let words = match number {
        0 => return None,
        1 => not_judged(NotJudged::NotLocked),
        2 => not_judged(NotJudged::Settling),
        3 => not_judged(NotJudged::Clipped),
        4 => not_judged(NotJudged::Invalid),
        5 => not_judged(NotJudged::NoVoltages),
        6 => not_judged(NotJudged::NoCurrents),
        7 => not_judged(NotJudged::NoSpeed),
        8 => "the supply is missing".to_owned(),
        9 => "a sensor is dead or contradicts the others".to_owned(),
        10 => not_judged(NotJudged::Transient),
        11 => not_judged(NotJudged::NoLoadCurrent),
        12 => not_judged(NotJudged::Reversing),
        13 => not_judged(NotJudged::Noise),
        _ => "a reason that this version does not know".to_owned(),
    };
    Some(words)
}

/// A finding about the supply.
pub fn supply(finding: SupplyFinding) -> &'static str {
    match finding {
        SupplyFinding::Lost => "no supply",
        SupplyFinding::Voltage => "supply voltage outside 75..120 % of rated",
        SupplyFinding::Unbalance => "supply unbalance above 3 %",
    }
}

/// A finding about a sensor.
pub fn sensor(finding: SensorFinding) -> String {
    match finding {
        SensorFinding::DeadVoltage(phase) => format!("voltage sensor {} is dead", phase.letter()),
        SensorFinding::DeadCurrent(phase) => format!("current sensor {} is dead", phase.letter()),
        SensorFinding::VoltagesMissing => "all voltage sensors are dead".to_owned(),
        SensorFinding::CurrentSum => "the phase currents do not add up to zero".to_owned(),
        SensorFinding::SpeedImplausible => "the speed contradicts voltages and currents".to_owned(),
    }
}

/// What the sidebands of the current say about the rotor's bars.
pub fn rotor(summary: &RotorSummary) -> String {
    match (
        summary.lower_sideband_percent,
        summary.upper_sideband_percent,
    ) {
        (Some(lower), Some(upper)) => format!(
            "rotor bars {}: sidebands at twice the slip frequency {lower:.2} and {upper:.2} % of the active current in {} {} \
             (broken from {} %)",
            if summary.broken { "broken" } else { "whole" },
            summary.blocks,
            if summary.blocks == 1 {
                "block"
            } else {
                "blocks"
            },
            summary.broken_from_percent
        ),
        _ => format!(
            "rotor bars not tested: that takes speed, a fifth of the rated current as active current, a slip below {:.0} %, and \
             two turns of the slip without a load step",
            100.0 * Sidebands::LARGEST_SLIP
        ),
    }
}

/// A row of Table 1, or a cause that only a calibrated motor shows, in plain words.
pub fn fault(name: &str) -> &'static str {
    match name {
        "Rs" => "stator resistance",
        "Rr" => "rotor resistance",
        "Ls" => "stator inductance",
        "Lr" => "rotor inductance",
        "B" => "friction of the motor",
        "Bl" => "friction of the load",
        "Iq" => "current sensor",
        "Vq" => "voltage sensor",
        "wr" => "speed sensor",
        "Lm" => "magnetizing inductance",
        "leakage" => "leakage inductance",
        "turns" => "shorted turns",
        "bars" => "broken rotor bars",
        _ => "none of the faults in the table",
    }
}

/// The measurement that would prove or clear one cause; `None` for what is in no table.
pub fn proof(name: &str) -> Option<&'static str> {
    Some(match name {
        "Rs" => "measure the windings' DC resistance, phase by phase",
        "Rr" => {
            "record without load: the rotor's resistance no longer shows, a wrong speed still does"
        }
        "wr" => "hold a strobe or a second tachometer to the shaft",
        "Lm" => "record without load, where the magnetizing inductance alone decides the current",
        "Ls" | "Lr" | "leakage" => {
            "record near rated load, where leakage weighs most, and without load, where it weighs least"
        }
        "B" | "Bl" => {
            "let the motor coast down with the load uncoupled: what slows it then is its own friction"
        }
        "Iq" => "clamp a second ammeter around each lead",
        "Vq" => "hold a second voltmeter to the terminals",
        "turns" => "compare the windings' resistances and inductances phase by phase, at rest",
        "bars" => {
            "record at another load: the sidebands of broken bars move with the slip, those of a swinging load do not"
        }
        _ => return None,
    })
}
