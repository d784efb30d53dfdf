//! From recordings and what is known of a motor to an answer on which a technician can act.

mod balance;
mod blind;
mod caveat;
mod checking;
mod clamp;
mod clamp_bars;
mod doubts;
mod knowledge;
mod reference;
mod severity;
mod told;

pub(crate) use balance::{Jump, LARGEST_CHANGE, jump, middle, strays_allowed};
pub use blind::{BlindSpot, blind_spots, channels_missing};
pub use checking::Checking;
pub use clamp::{ClampSignal, clamp_signals};
pub use clamp_bars::{BesideSupply, SupplySideband};
pub use doubts::{CheckDoubt, Doubting};
pub use knowledge::{Knowledge, Learnt, learn};
pub use reference::{Reference, begins_like};
pub use severity::Severity;
pub use told::{Told, two_digits};

use audit::Audit;
use motor::{FaultId, MotorFile};
use recording::Recording;
use schemars::JsonSchema;
use serde::Serialize;

use crate::speed::EstimatedSpeed;
use crate::{
    BeyondCalibration, MotionFault, MotionSummary, Timeline, Verdict, VerdictState,
    WindowOperation, WindowResiduals, causes, words,
};

/// What one recording says of a motor.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Checked {
    /// Audit of the recording.
    pub audit: Audit,
    /// What the recording comes to, at rest and in motion together.
    pub state: VerdictState,
    /// State and possible causes of the windows at rest.
    pub verdict: Verdict,
    /// What was judged while current, speed or supply changed.
    pub motion: MotionSummary,
    /// What does not fit a motor in good order although no lamp lights.
    pub doubts: Vec<CheckDoubt>,
    /// How bad the likeliest cause is, where its size is known.
    pub severity: Option<Severity>,
    /// What cause, phase and size rest on, where it is hardly known.
    pub caveat: Option<String>,
    /// What to do, in order.
    pub todo: Vec<String>,
    /// Windows judged, of all.
    pub windows: [u64; 2],
    /// Why windows were not judged.
    pub not_judged: Vec<String>,
    /// Smallest r1..r4 that would have lit a lamp, percent of their scales.
    pub visible_percent: Option<[f64; 4]>,
    /// The speed, where it was estimated.
    pub speed: Option<EstimatedSpeed>,
    /// The rotor bars in words.
    pub rotor: String,
    /// Negative over positive sequence of the currents, percent.
    pub current_unbalance_percent: Option<f64>,
    /// What single channels say, where there are no three of a kind.
    pub clamps: Vec<ClampSignal>,
    /// Judged windows beyond what the calibration, or the recording in good order, saw.
    pub beyond_calibration: BeyondCalibration,
    /// What cannot be seen.
    pub blind: Vec<BlindSpot>,
    /// State, cause, certainty and severity in words.
    pub told: Told,
    /// r1 to r4 of every window that has them.
    pub residuals: Vec<WindowResiduals>,
    /// Voltage, current, speed and unbalance of every window.
    pub operation: Vec<WindowOperation>,
}

impl Checked {
    /// Of a recording that the audit refuses no number is told: it would be another quantity than it says. What to do is the
    /// remedy of the audit.
    fn withdraw(&mut self) {
        (self.state, self.verdict.state) = (VerdictState::NotJudged, VerdictState::NotJudged);
        self.verdict.candidates.clear();
        self.verdict.tied = 0;
        self.verdict.separating_tests.clear();
        self.motion = MotionSummary::default();
        let refusals = self.audit.findings.iter().filter(|finding| finding.refuses);
        self.todo = refusals.map(|finding| finding.detail.clone()).collect();
        (self.doubts, self.not_judged) = (Vec::new(), Vec::new());
        (self.caveat, self.severity, self.speed) = (None, None, None);
        (self.visible_percent, self.current_unbalance_percent) = (None, None);
        let [judged, _] = &mut self.windows;
        *judged = 0;
        self.rotor = words::rotor(&Timeline::default().rotor());
        self.residuals.clear();
    }

    /// Whether no recording in good order was given yet.
    pub fn lacks_reference(&self) -> bool {
        self.blind.contains(&blind::NOT_CALIBRATED)
    }
}

/// Checks one recording against a motor.
///
/// # Errors
/// A motor file or a recording that the core cannot take, in words.
pub fn check(
    recorded: &Recording,
    motor: &MotorFile,
    progress: &mut dyn FnMut(usize),
) -> Result<Checked, String> {
    let mut checking = Checking::new(motor);
    checking.take(recorded, progress)?;
    Ok(checking.finish())
}

/// Steps for the causes that cannot be told apart, or what makes a dark answer worth more.
fn todo(
    motor: &MotorFile,
    state: VerdictState,
    verdict: &Verdict,
    motion: &MotionSummary,
    doubts: &[CheckDoubt],
) -> Vec<String> {
    let calibrated = motor.healthy.is_some();
    let tied = &verdict.candidates[..verdict.tied.min(verdict.candidates.len())];
    let in_motion = motion.alarms.iter().filter_map(|alarm| alarm.fault());
    let causes: Vec<FaultId> = match verdict.state {
        VerdictState::Fault => tied.iter().map(|candidate| candidate.fault).collect(),
        _ => in_motion.collect(),
    };
    let mut steps: Vec<String> = match state {
        VerdictState::Fault => {
            let remedies = doubts.iter().map(|doubt| doubt.remedy.clone());
            let tests = causes::todo(&causes, calibrated);
            tests
                .into_iter()
                .map(str::to_owned)
                .chain(remedies)
                .collect()
        }
        VerdictState::Healthy => Vec::new(),
        VerdictState::NotJudged if !motion.unexplained.is_empty() => {
            let first = motion.unexplained.iter().take(1);
            let step = |doubt: &MotionFault| {
                format!("find out what does not fit in motion: {}", doubt.doubt())
            };
            first.map(step).collect()
        }
        VerdictState::NotJudged if !doubts.is_empty() => {
            doubts.iter().map(|doubt| doubt.remedy.clone()).collect()
        }
        VerdictState::NotJudged => {
            vec!["record ten seconds of steady running with three voltages, three currents and, if there is one, the speed".to_owned()]
        }
    };
    if !calibrated {
        steps.push(
            "record ten seconds while the motor is known to be in good order, as a reference: smaller faults show then"
                .to_owned(),
        );
    }
    steps
}
