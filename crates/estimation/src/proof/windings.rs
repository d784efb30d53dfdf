//! By how much the windings' resistances differ in the recordings that prove.

use crate::data::study::{Study, Trial};
use crate::data::subject::Warmth;
use crate::fit::uncertainty::coordinate_error;
use crate::model::prior::RESISTANCES;
use crate::proof::off::SIGNIFICANT;
use schemars::JsonSchema;
use serde::Serialize;

/// Windings warm together, though not alike: their changes (logarithms) differ by no more than this share of the larger one ...
const UNLIKE: f64 = 0.5;
/// ... and a dozen kelvin.
const APART: f64 = 0.05;

/// Resistances that a recording which proves asks for, against those of the fitted one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct WindingsReport {
    /// Which of the recordings that prove, from 1.
    pub proof: usize,
    /// Change of the stator's resistance, percent.
    pub stator_resistance_change_percent: f64,
    /// Change of the rotor's resistance, percent.
    pub rotor_resistance_change_percent: f64,
    /// Whether another temperature makes both.
    pub is_temperature: bool,
}

impl WindingsReport {
    /// `errors`: standard errors of the fitted resistances.
    fn of(proof: usize, [stator, rotor]: Warmth, errors: [f64; 2]) -> Self {
        let known_to = SIGNIFICANT * errors[0].hypot(errors[1]);
        let most = UNLIKE * stator.abs().max(rotor.abs()) + APART + known_to;
        Self {
            proof,
            stator_resistance_change_percent: 100.0 * stator.exp_m1(),
            rotor_resistance_change_percent: 100.0 * rotor.exp_m1(),
            is_temperature: (stator - rotor).abs() < most,
        }
    }

    fn told(&self, of: &str) -> String {
        let [stator, rotor] = [
            self.stator_resistance_change_percent,
            self.rotor_resistance_change_percent,
        ];
        let changes = format!("stator resistance {stator:+.1} %, rotor resistance {rotor:+.1} %");
        let warmth = match stator + rotor > 0.0 {
            true => "warmer",
            false => "colder",
        };
        match self.is_temperature {
            true => format!(" The motor was {warmth} in {of} ({changes})."),
            false => format!(
                " Resistances are others in {of} ({changes}); a temperature changes both, so something else was changed between the recordings."
            ),
        }
    }
}

/// The same in words.
pub fn told(all: &[WindingsReport]) -> String {
    let one = |windings: &WindingsReport| match all.len() {
        1 if windings.proof == 1 => windings.told("the recording that proves"),
        _ => windings.told(&format!("proving recording {}", windings.proof)),
    };
    all.iter().map(one).collect()
}

impl Study {
    /// Recordings that prove in which the windings' resistances differ beyond the errors of the fitted ones.
    pub fn windings(&self, trial: &Trial) -> Vec<WindingsReport> {
        let covariance = self.covariance(trial);
        let error = |k: usize| match trial.fit.free.contains(&k) {
            true => coordinate_error(trial, covariance, k),
            false => 0.0,
        };
        let errors = RESISTANCES.map(error);
        let differs = |warmth: &Warmth| {
            let mut changes = warmth.iter().zip(errors);
            changes.any(|(change, error)| change.abs() > SIGNIFICANT * error)
        };
        let all = trial.warmth.iter().enumerate();
        let far = all.filter(|(_, warmth)| differs(warmth));
        far.map(|(k, warmth)| WindingsReport::of(k + 1, *warmth, errors))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;

    fn of(warmth: &[Warmth], error: f64) -> Vec<WindingsReport> {
        let study = specimen::study(1.0, |_| 1.0);
        let mut trial = specimen::moved(&study, &[], &[], error);
        trial.warmth = warmth.to_vec();
        study.windings(&trial)
    }

    #[test]
    fn a_motor_is_warmer_where_both_resistances_rise() {
        let warm = of(&[[0.1, 0.12]], 0.01);
        assert!(warm[0].is_temperature && warm[0].proof == 1);
        assert!((warm[0].stator_resistance_change_percent - 10.517).abs() < 1e-3);
        assert_eq!(
            told(&warm),
            " The motor was warmer in the recording that proves (stator resistance +10.5 %, rotor resistance +12.7 %)."
        );
        assert!(told(&of(&[[-0.1, -0.05]], 0.01)).contains("colder"));
    }

    #[test]
    fn one_resistance_without_the_other_is_no_temperature() {
        for warmth in [[0.0, 0.2], [0.2, 0.0], [0.05, -0.05]] {
            let windings = of(&[warmth], 0.001);
            assert!(!windings[0].is_temperature && told(&windings).contains("something else"));
        }
        for warmth in [[0.0, 0.08], [0.1, 0.2], [0.1, 0.02]] {
            assert!(of(&[warmth], 0.001)[0].is_temperature, "{warmth:?}");
        }
        // A resistance that the fitted recording hardly tells.
        assert!(of(&[[0.0, 0.2]], 0.02)[0].is_temperature);
    }

    #[test]
    fn what_the_fitted_recording_leaves_open_is_not_told() {
        assert!(of(&[[0.0, 0.0]], 0.0).is_empty());
        assert!(of(&[[0.1, 0.1]], 0.04).is_empty());
        let both = of(&[[0.0, 0.0], [0.1, 0.1], [0.2, 0.2]], 0.01);
        assert_eq!(both.iter().map(|w| w.proof).collect::<Vec<_>>(), [2, 3]);
        assert!(
            told(&both).contains("in proving recording 2 (")
                && told(&both).contains("recording 3 (")
        );
    }
}
