//! What recordings of a motor in good order teach before others are checked.

use discovery::{Error, IdentifyReport};
use motor::MotorFile;
use recording::{Recording, Source};
use schemars::JsonSchema;
use serde::Serialize;

use crate::calibrate::{Surroundings, calibrate};
use crate::speed::with_estimated_speed;

/// How well a motor is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Knowledge {
    /// By its motor file or its plate alone.
    AsGiven,
    /// Parameters learnt from healthy recordings.
    Identified,
    /// Calibrated: healthy statistics, phases and sizes are told.
    Calibrated,
}

/// A motor with what its healthy recordings taught.
#[derive(Clone, Debug)]
pub struct Learnt {
    /// The motor as it is known now.
    pub motor: MotorFile,
    /// How well.
    pub knowledge: Knowledge,
    /// The parameters found, where they were looked for.
    pub identified: Option<IdentifyReport>,
    /// Why a step was not possible.
    pub notes: Vec<String>,
}

/// Within this much of the noise the model fits the healthy motor.
const FITS: f64 = 1.5;

/// Identifies the parameters, then calibrates. A step that the recordings do not allow is told and left out.
pub fn learn(
    motor: &MotorFile,
    healthy: &[&Recording],
    progress: &mut discovery::Progress<'_>,
) -> Learnt {
    let mut learnt = Learnt {
        motor: motor.clone(),
        knowledge: Knowledge::AsGiven,
        identified: None,
        notes: Vec::new(),
    };
    if healthy.is_empty() {
        return learnt;
    }
    if motor.uncertainty.is_some() && healthy.iter().all(|recording| recording.speed().is_some()) {
        learnt.identify(healthy, progress);
    }
    learnt.calibrate(healthy);
    learnt
}

impl Learnt {
    fn identify(&mut self, healthy: &[&Recording], progress: &mut discovery::Progress<'_>) {
        let owned = healthy.iter().copied().cloned();
        let sources: Vec<Source> = owned.map(Source::Recording).collect();
        match discovery::identify(&sources, &self.motor, progress) {
            Ok((report, motor)) => {
                let error = report.after.held_out_error_over_noise;
                if error > FITS {
                    // Its parameters stand for what it misses: a confident wrong answer.
                    self.notes.push(format!(
                        "parameters not learnt: the model misses something of the healthy motor ({error:.1} times the noise); \
                         drivemon explain says what"
                    ));
                } else {
                    (self.motor, self.knowledge) = (motor, Knowledge::Identified);
                    self.identified = Some(report);
                }
            }
            Err(error) => self.note("parameters not learnt", &error),
        }
    }

    fn note(&mut self, what: &str, error: &Error) {
        self.notes.push(format!("{what}: {error}"));
    }

    /// Without an encoder the speed is estimated here as it will be when the motor is checked.
    fn calibrate(&mut self, healthy: &[&Recording]) {
        let with_speed = |recording: &&Recording| {
            with_estimated_speed(recording, &self.motor)
                .map_or_else(|| Recording::clone(recording), |(with_speed, _)| with_speed)
        };
        let healthy: Vec<Recording> = healthy.iter().map(with_speed).collect();
        match calibrate(&self.motor, &healthy, &Surroundings::default()) {
            Ok(calibrated) => {
                (self.motor, self.knowledge) = (calibrated.motor, Knowledge::Calibrated);
            }
            Err(refusal) => self.notes.push(format!("not calibrated: {refusal}")),
        }
    }
}
