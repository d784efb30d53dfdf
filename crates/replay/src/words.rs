//! What the core's findings are called in front of people.

use crate::{RotorCage, RotorSummary};
use monitor::{NotJudged, Reason, SensorFinding, Sidebands, SupplyFinding};
use motion::NotInMotion;

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
        NotJudged::Held => {
            "the shaft is held or slow, at a slip that no load brings; only a calibrated motor is judged there".to_owned()
        }
        NotJudged::Reversing => {
            "the shaft turns against the field: braking or reversing".to_owned()
        }
    }
}

/// What an alarm in motion is that no fault explains, and what to do.
pub const UNEXPLAINED: &str = "a larger fault, a speed channel that lags, or an effect that the motor file lacks; \
     compare the recording with the model (drivemon compare), or record the shaft without a filter";

/// What a board says of what it calls no fault.
pub const SOMETHING_IN_MOTION: &str = "something came in motion that no fault of a size that occurs explains, or that was never seen in good order";

/// Why an alarm in motion is no FAULT of a motor that was calibrated at rest alone.
pub const NEVER_SEEN_IN_MOTION: &str = "the motor in good order was never seen in motion: its file may lack an effect. \
     Calibrate it on a recording with a start and load steps as well";

/// Why a cycle was not judged in motion.
pub fn not_in_motion(reason: NotInMotion) -> &'static str {
    match reason {
        NotInMotion::Missing => "a voltage, a current, the speed or the torque is missing",
        NotInMotion::Clipped => "a channel clipped, and the rotor flux remembers it",
        NotInMotion::NoSupply => "no periodic supply between 5 and 100 Hz",
        NotInMotion::NoCurrent => "the motor draws no current",
        NotInMotion::FluxUnknown => {
            "the rotor flux is not known yet: first cycles, or a start on a turning shaft"
        }
        NotInMotion::AgainstField => "the shaft turns against the field, or did so shortly ago",
    }
}

/// The reason that a board's frame gives by its number; `None` for a judged window.
pub fn reason(number: u8) -> Option<String> {
    let Some(reason) = Reason::from_number(number) else {
        return (number != 0).then(|| "a reason that this version does not know".to_owned());
    };
    Some(match reason {
        Reason::NotLocked => not_judged(NotJudged::NotLocked),
        Reason::Settling => not_judged(NotJudged::Settling),
        Reason::Clipped => not_judged(NotJudged::Clipped),
        Reason::Invalid => not_judged(NotJudged::Invalid),
        Reason::NoVoltages => not_judged(NotJudged::NoVoltages),
        Reason::NoCurrents => not_judged(NotJudged::NoCurrents),
        Reason::NoSpeed => not_judged(NotJudged::NoSpeed),
        // The frame does not say which finding.
        Reason::Supply => "the supply is missing".to_owned(),
        Reason::Sensor => "a sensor is dead or contradicts the others".to_owned(),
        Reason::Transient => not_judged(NotJudged::Transient),
        Reason::NoLoadCurrent => not_judged(NotJudged::NoLoadCurrent),
        Reason::Reversing => not_judged(NotJudged::Reversing),
        Reason::Noise => not_judged(NotJudged::Noise),
        Reason::Held => not_judged(NotJudged::Held),
        Reason::Instrument => "the board doubts its own converters or their supply".to_owned(),
        Reason::DoesNotFit => SOMETHING_IN_MOTION.to_owned(),
    })
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
    let answer = match summary.state {
        RotorCage::NotTested => return rotor_not_tested(summary.swinging_blocks),
        RotorCage::Whole => "whole",
        RotorCage::Doubtful => "doubtful",
        RotorCage::Broken => "broken",
    };
    let (Some(lower), Some(upper)) = (
        summary.lower_sideband_percent,
        summary.upper_sideband_percent,
    ) else {
        return format!("rotor bars {answer}");
    };
    let blocks = blocks(summary.blocks);
    format!(
        "rotor bars {answer}: sidebands at twice the slip frequency {lower:.2} and {upper:.2} % of the active current in {blocks}{} \
         (doubtful from {:.2} %, broken from {:.2} %){}",
        since_calibration(summary),
        summary.doubtful_from_percent,
        summary.broken_from_percent,
        advice(summary)
    )
}

fn blocks(count: u64) -> String {
    match count {
        1 => "1 block".to_owned(),
        n => format!("{n} blocks"),
    }
}

fn rotor_not_tested(swinging: u64) -> String {
    if swinging > 0 {
        return format!(
            "rotor bars not tested: in {} the load swings at twice the slip frequency, as broken bars would make it; record at another load",
            blocks(swinging)
        );
    }
    format!(
        "rotor bars not tested: that takes speed, a fifth of the rated current as active current, a slip below {:.0} %, and \
         two turns of the slip without a load step",
        100.0 * Sidebands::LARGEST_SLIP
    )
}

/// The lower sideband beside what it was at calibration.
fn since_calibration(summary: &RotorSummary) -> String {
    match (summary.growth(), summary.at_calibration_percent) {
        (Some(growth), _) => format!(", {growth:.1} times what it was at calibration"),
        (None, Some(before)) => format!(", at calibration {before:.2} %"),
        (None, None) => String::new(),
    }
}

/// What settles a doubt.
fn advice(summary: &RotorSummary) -> &'static str {
    match (summary.state, summary.at_calibration_percent) {
        (RotorCage::Doubtful, None) => {
            "; that is more than most whole cages leave: compare with a motor of the same type, or calibrate this one and watch the \
             sideband grow"
        }
        (RotorCage::Doubtful, Some(_)) => {
            "; that is more than at calibration: record again soon, at the same load"
        }
        _ => "",
    }
}
