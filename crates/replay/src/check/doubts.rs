//! What contradicts a motor in good order although no lamp lights: then the answer is not "in good order".

mod lit;

use audit::{Code, Finding};
use monitor::{MonitorConfig, Report};
use motor::MotorFile;
use schemars::JsonSchema;
use serde::Serialize;

use super::balance::{Balance, Jump};
use crate::calibrate::COPPER_PER_KELVIN;
use crate::rotor::RotorSummary;
use crate::{MotionSummary, NotJudgedShare, Timeline, VerdictState};
use lit::Lit;

/// Something that does not fit a motor in good order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct CheckDoubt {
    /// What does not fit.
    pub seen: String,
    /// What settles it.
    pub remedy: String,
}

/// Gathers over the windows of a recording what contradicts a motor in good order.
pub struct Doubting {
    /// Zero sequences and unbalance of the motor in good order are known, and the lamps hold them.
    calibrated: bool,
    /// Rise of the resistances that the calibration foresees, a share.
    foreseen_rise: Option<f64>,
    balance: Balance,
    lit: Lit,
}

impl Doubting {
    /// Before the first window.
    pub fn new(motor: &MotorFile) -> Doubting {
        let healthy = motor.healthy.as_ref();
        Doubting {
            calibrated: healthy.is_some(),
            foreseen_rise: healthy.map(|healthy| healthy.heating_percent / 100.0),
            balance: Balance::default(),
            lit: Lit::default(),
        }
    }

    /// Adds a window that ended at time `t`, s.
    pub fn add(&mut self, t: f64, report: &Report, config: &MonitorConfig) {
        self.balance.add(t, report, config);
        self.lit.add(report);
    }

    /// What does not fit, and the recording's state with it: with a doubt a dark answer is no answer.
    pub fn finish(
        &self,
        timeline: &Timeline,
        motion: &MotionSummary,
        state: VerdictState,
        findings: &[Finding],
    ) -> (VerdictState, Vec<CheckDoubt>) {
        let jump = self.balance.jump().filter(|_| !self.calibrated);
        let mut found = doubts(findings, &timeline.rotor(), jump, self.calibrated);
        if state != VerdictState::Fault {
            let few = timeline.too_few(motion);
            let reasons = reasons(timeline);
            found.extend(few.and_then(|few| hardly_judged(few, &reasons)));
            found.extend(timeline.visible_percent().and_then(hardly_visible));
            let rise = timeline.resistance_rise().zip(self.foreseen_rise);
            let hot = rise.and_then(|(rise, foreseen)| beyond_heat(rise, foreseen));
            // What is beyond heat lights lamps, too, and says why.
            let lit = || self.calibrated.then(|| self.lit.doubt()).flatten();
            found.extend(hot.or_else(lit));
        }
        match state {
            VerdictState::Healthy if !found.is_empty() => (VerdictState::NotJudged, found),
            state => (state, found),
        }
    }
}

/// Why windows were not judged, with how many.
pub(super) fn reasons(timeline: &Timeline) -> Vec<String> {
    let share = |share: &NotJudgedShare| match share.windows {
        1 => format!("{}: 1 window", share.reason),
        many => format!("{}: {many} windows", share.reason),
    };
    timeline.not_judged.iter().map(share).collect()
}

/// Zero sequence from which on a channel that it names is as far off as no sensor in good order is, percent of the positive
/// sequence: a gain that is 10 % wrong.
const WRONG_GAIN_PERCENT: f64 = 100.0 / 30.0;

/// What does not fit; `calibrated`: the zero sequences of the motor in good order are known, and the lamps hold them.
fn doubts(
    findings: &[Finding],
    rotor: &RotorSummary,
    jump: Option<Jump>,
    calibrated: bool,
) -> Vec<CheckDoubt> {
    let channels = findings
        .iter()
        .filter(|finding| is_doubt(finding, calibrated))
        .map(|finding| CheckDoubt {
            seen: format!(
                "the audit finds that the channel {} cannot be trusted",
                channel(finding)
            ),
            remedy: format!("check the channel {}: {}", channel(finding), finding.detail),
        });
    let samples = findings.iter().filter_map(lost_samples);
    let clock = findings.iter().filter_map(wrong_clock);
    clock
        .chain(channels)
        .chain(samples)
        .chain(jump.map(changed))
        .chain(bars(rotor))
        .collect()
}

fn is_doubt(finding: &Finding, calibrated: bool) -> bool {
    let throughout = finding.from_s.is_none() && finding.to_s.is_none();
    throughout
        && match finding.code {
            Code::SpeedImplausible => true,
            Code::ZeroSequence => {
                !calibrated && finding.suspect.is_some() && finding.value > WRONG_GAIN_PERCENT
            }
            _ => false,
        }
}

fn channel(finding: &Finding) -> &str {
    finding.suspect.as_deref().unwrap_or(&finding.channel)
}

/// Too little was judged for a dark answer; `None` where nothing was, which is an answer of its own.
fn hardly_judged([judged, running]: [u64; 2], reasons: &[String]) -> Option<CheckDoubt> {
    let why = reasons
        .first()
        .map_or(String::new(), |why| format!(" ({why})"));
    (judged > 0).then(|| CheckDoubt {
        seen: format!(
            "{judged} of {running} windows of the running motor could be judged: what the others hold is not known{why}"
        ),
        remedy: "record ten seconds while load and supply are steady; where they never are, calibrate the motor (--healthy): it is then \
                 judged in motion, too"
            .to_owned(),
    })
}

/// Share of the rise that a calibration foresees beyond which it is not taken for heat: a quarter more than a window is wrong by.
const BEYOND_HEAT: f64 = 1.25;

/// Resistances that are further from the calibration than temperature takes them: `rise` is a share, as `foreseen`.
fn beyond_heat(rise: f64, foreseen: f64) -> Option<CheckDoubt> {
    let kelvin = |share: f64| share.abs() / COPPER_PER_KELVIN;
    let (side, warmer) = match rise > 0.0 {
        true => ("above", "warmer"),
        false => ("below", "colder"),
    };
    (rise.abs() > BEYOND_HEAT * foreseen).then(|| CheckDoubt {
        seen: format!(
            "the resistances stand {:.0} % {side} those of the calibration, as if the windings were {:.0} K {warmer}; {:.0} K were foreseen",
            100.0 * rise.abs(),
            kelvin(rise),
            kelvin(foreseen)
        ),
        remedy: "measure the windings' temperature, or their resistance at standstill: where they are not as hot, a resistance of the stator or of the \
                 cage has changed before the recording began"
            .to_owned(),
    })
}

/// What the lamps could have shown, percent of their scales, is larger than whatever a motor that still runs has.
fn hardly_visible(visible_percent: [f64; 4]) -> Option<CheckDoubt> {
    let least = visible_percent.into_iter().fold(f64::INFINITY, f64::min);
    (least >= 100.0).then(|| CheckDoubt {
        seen: format!(
            "no residual below {least:.0} % of its scale would have lit a lamp: what is known of the motor does not carry an answer at this load, \
             voltage and frequency"
        ),
        remedy: "compare the recording's voltage, frequency and current with the plate; give a plate with all its values, or a recording of the \
                 motor in good order (--healthy)"
            .to_owned(),
    })
}

/// Samples that are missing here and there: every phase behind them is another one.
fn lost_samples(finding: &Finding) -> Option<CheckDoubt> {
    let is_doubt = finding.code == Code::LostSamples && !finding.refuses;
    is_doubt.then(|| CheckDoubt {
        seen: format!(
            "the audit finds {:.0} places where samples are missing",
            finding.value
        ),
        remedy: format!("record without lost samples: {}", finding.detail),
    })
}

/// A supply at a frequency that the plate excludes at this voltage.
fn wrong_clock(finding: &Finding) -> Option<CheckDoubt> {
    let is_doubt = finding.code == Code::SupplyFrequency && finding.channel == "t";
    is_doubt.then(|| CheckDoubt {
        seen: format!(
            "the supply has {:.1} Hz by the sampling rate as it was read, at a voltage that does not go with it",
            finding.value
        ),
        remedy: format!("check the sampling rate: {}", finding.detail),
    })
}

fn changed(jump: Jump) -> CheckDoubt {
    CheckDoubt {
        seen: format!(
            "the unbalance of the currents changes by {:.1} % of the rated current from {:.2} s on, and the voltages do not explain it: a phase of the \
             motor or a current sensor is not what it was",
            100.0 * jump.share,
            jump.t
        ),
        remedy: "measure the windings' resistances phase by phase, and clamp a second ammeter around each lead; a recording in good order (--healthy) \
                 tells which"
            .to_owned(),
    }
}

/// Sidebands as large as broken bars make them, in fewer blocks than it takes to say so.
fn bars(rotor: &RotorSummary) -> Option<CheckDoubt> {
    let lower = rotor.lower_sideband_percent?;
    rotor.is_suspected().then(|| CheckDoubt {
        seen: format!(
            "the sidebands at twice the slip frequency ({lower:.1} % of the active current) are as large as broken rotor bars make them (from {:.1} % on), \
             in fewer blocks than it takes to be sure",
            rotor.broken_from_percent
        ),
        remedy: "record at least twenty seconds at this load: broken rotor bars are then told from a load that swings".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotor::RotorCage;

    fn rotor(state: RotorCage, lower: f64) -> RotorSummary {
        RotorSummary {
            state,
            blocks: 2,
            swinging_blocks: 0,
            lower_sideband_percent: Some(lower),
            upper_sideband_percent: Some(lower),
            beside_percent: Some(0.1),
            doubtful_from_percent: 0.5,
            broken_from_percent: 1.25,
            at_calibration_percent: None,
            broken: false,
        }
    }

    #[test]
    fn sidebands_of_broken_bars_in_few_blocks_are_a_doubt_and_small_ones_are_none() {
        let of = |state, lower| doubts(&[], &rotor(state, lower), None, false).len();
        assert_eq!(of(RotorCage::Doubtful, 8.7), 1);
        assert_eq!(of(RotorCage::Doubtful, 0.8), 0);
        assert_eq!(of(RotorCage::Whole, 0.3), 0);
    }

    #[test]
    fn what_shows_nothing_below_its_scale_and_what_was_hardly_judged_are_doubts() {
        assert_eq!(hardly_visible([99.0, 400.0, 300.0, 200.0]), None);
        let blind = hardly_visible([230.0, 400.0, 300.0, 231.0]).expect("a doubt");
        assert!(blind.seen.contains("below 230 %"), "{blind:?}");
        let reasons = ["transient: 1080 windows".to_owned()];
        let few = hardly_judged([113, 1193], &reasons).expect("a doubt");
        assert!(
            few.seen.contains("113 of 1193") && few.seen.contains("1080"),
            "{few:?}"
        );
        assert_eq!(hardly_judged([0, 1193], &reasons), None);
    }

    /// 75 K are foreseen: 29 % of copper's resistance. What a hot day adds is heat, what twice as much says is not.
    #[test]
    fn resistances_beyond_what_temperature_does_are_a_doubt() {
        let foreseen = 75.0 * COPPER_PER_KELVIN;
        assert_eq!(beyond_heat(0.33, foreseen), None);
        assert_eq!(beyond_heat(-0.33, foreseen), None);
        let seen = |rise| beyond_heat(rise, foreseen).map(|doubt| doubt.seen);
        let hot = seen(0.585).expect("a doubt");
        assert!(
            hot.contains("58 % above") && hot.contains("149 K warmer; 75 K"),
            "{hot}"
        );
        let cold = seen(-0.39).expect("a doubt");
        assert!(cold.contains("99 K colder"), "{cold}");
    }

    #[test]
    fn a_channel_that_the_audit_finds_far_off_is_a_doubt() {
        let finding = |code, suspect: Option<&str>, value, to_s| Finding {
            code,
            channel: "va vb vc".to_owned(),
            suspect: suspect.map(str::to_owned),
            value,
            unit: "%".to_owned(),
            detail: "seen".to_owned(),
            refuses: false,
            from_s: None,
            to_s,
            share: None,
        };
        let none = rotor(RotorCage::NotTested, 0.0);
        let of = |finding, calibrated| doubts(&[finding], &none, None, calibrated);
        let gain = finding(Code::ZeroSequence, Some("va"), 9.1, None);
        assert!(of(gain.clone(), false)[0].remedy.contains("va"));
        assert!(of(gain, true).is_empty(), "its evidence holds it");
        let displaced = finding(Code::ZeroSequence, None, 9.1, None);
        assert!(of(displaced, false).is_empty());
        let small = finding(Code::ZeroSequence, Some("va"), 2.0, None);
        assert!(of(small, false).is_empty());
        let lost = finding(Code::LostSamples, None, 3.0, None);
        assert!(of(lost, true)[0].seen.contains("3 places"));
        let mut clock = finding(Code::SupplyFrequency, None, 40.0, None);
        assert!(of(clock.clone(), true).is_empty(), "an inverter");
        clock.channel = "t".to_owned();
        assert!(of(clock, true)[0].seen.contains("40.0 Hz"));
        let speed = finding(Code::SpeedImplausible, None, -2.1, None);
        assert_eq!(of(speed, true).len(), 1);
        let for_a_while = finding(Code::SpeedImplausible, None, -2.1, Some(1.0));
        assert!(of(for_a_while, true).is_empty());
    }
}
