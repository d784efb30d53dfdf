//! What recordings of a motor in good order teach before others are checked.

use discovery::{Given, IdentifiedParameter, IdentifyReport, Sources};
use motor::InMotion;
use motor::MotorFile;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Display;

use super::reference::{Reference, WithSpeed};
use crate::calibrate::{Pieces, Surroundings, calibrate_pieces};

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
    healthy: &[&dyn Reference],
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
    if motor.uncertainty.is_some() && healthy.iter().all(|one| one.head().speed().is_some()) {
        learnt.identify(healthy, progress);
    }
    learnt.calibrate(healthy);
    learnt
}

/// A parameter further from its plate's than this, in standard deviations of what motors of such plates have, is no motor's.
const MOST_DEVIATIONS: f64 = 3.0;

/// The parameter by which the recordings contradict the motor file, in words.
fn beyond_belief(motor: &MotorFile, parameters: &[IdentifiedParameter]) -> Option<String> {
    let known = motor.uncertainty.as_ref()?;
    let found = parameters.iter().find(|found| {
        let deviation = known.log_deviation(&found.name);
        let off = (found.value / found.believed).ln().abs();
        found.told && deviation.is_some_and(|deviation| off > MOST_DEVIATIONS * deviation)
    })?;
    Some(format!(
        "{} would have to be {:.3e} {} where the motor file says {:.3e}, further off than motors of such plates are; check plate, \
         connection and scales of the sensors",
        found.name, found.value, found.unit, found.believed
    ))
}

impl Learnt {
    fn identify(&mut self, healthy: &[&dyn Reference], progress: &mut discovery::Progress<'_>) {
        let given = healthy
            .iter()
            .map(|one| one.given(&self.motor, healthy.len() == 1));
        let given: Vec<Given> = match given.collect() {
            Ok(given) => given,
            Err(error) => return self.note("parameters not learnt", &error),
        };
        match discovery::identify(Sources::Given(&given), &self.motor, progress) {
            Ok((report, motor)) => {
                let error = report.after.held_out_error_over_noise;
                if let Some(beyond) = beyond_belief(&self.motor, &report.parameters) {
                    self.notes.push(format!("parameters not learnt: {beyond}"));
                } else if error > FITS {
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

    fn note(&mut self, what: &str, error: &dyn Display) {
        self.notes.push(format!("{what}: {error}"));
    }

    /// Without an encoder the speed is estimated here as it will be when the motor is checked.
    fn calibrate(&mut self, references: &[&dyn Reference]) {
        let believed = self.motor.clone();
        let healthy = references.iter().map(|one| WithSpeed::new(*one, &believed));
        let healthy: Vec<WithSpeed<'_>> = healthy.collect();
        let healthy: Vec<&dyn Pieces> = healthy.iter().map(|one| one as _).collect();
        match calibrate_pieces(&believed, &healthy, &Surroundings::default()) {
            Ok(calibrated) => {
                (self.motor, self.knowledge) = (calibrated.motor, Knowledge::Calibrated);
                self.forget_motion_of_estimates(references);
            }
            Err(refusal) => self.notes.push(format!("not calibrated: {refusal}")),
        }
    }

    /// An estimated speed is too slow to follow a motor in motion: how it seemed to move says nothing.
    fn forget_motion_of_estimates(&mut self, references: &[&dyn Reference]) {
        let is_estimated = references.iter().any(|one| one.head().speed().is_none());
        if let Some(healthy) = self.motor.healthy.as_mut().filter(|_| is_estimated) {
            healthy.in_motion = InMotion::Unseen;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motor::motor_file::{ParameterInterval, Uncertainty};

    /// An interval of a factor of two to both sides has a standard deviation of `ln 4/3.92 = 0.354`: three of them are a factor of 2.9.
    #[test]
    fn a_parameter_far_beyond_its_plate_is_told_and_an_untold_one_is_not() {
        let mut motor = MotorFile::read("../../motors/peer-2k2.toml").expect("it ships");
        let name = "stator_resistance_ohm".to_owned();
        let found = |value: f64, told: bool| IdentifiedParameter {
            name: name.clone(),
            unit: "ohm".to_owned(),
            believed: 2.0,
            value,
            low: 0.97 * value,
            high: 1.03 * value,
            told,
            would_tell: None,
        };
        assert_eq!(beyond_belief(&motor, &[found(9.0, true)]), None);
        motor.uncertainty = Some(Uncertainty {
            intervals: vec![ParameterInterval {
                key: name.clone(),
                low: 1.0,
                high: 4.0,
            }],
            correlations: Vec::new(),
        });
        for (value, told, is_beyond) in [
            (5.6, true, false),
            (6.0, true, true),
            (0.6, true, true),
            (6.0, false, false),
        ] {
            let said = beyond_belief(&motor, &[found(value, told)]);
            assert_eq!(said.is_some(), is_beyond, "{value}: {said:?}");
        }
    }
}
