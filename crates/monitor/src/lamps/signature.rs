//! The fault signature matrix (Table 1) and the probability of each fault (seventh and eighth stage).

use crate::model::residuals::RESIDUALS;
use motor::FaultId;

/// Number of rows.
pub const FAULTS: usize = 9;

/// Table 1 of the paper: which of r1..r4 each fault lights, in the order of the catalogue.
pub const TABLE_1: [(FaultId, [bool; RESIDUALS]); FAULTS] = table_1();

const fn table_1() -> [(FaultId, [bool; RESIDUALS]); FAULTS] {
    let mut table = [(FaultId::Unknown, [false; RESIDUALS]); FAULTS];
    let (mut row, mut k) = (0, 0);
    while k < FaultId::ALL.len() {
        if let Some(pattern) = FaultId::ALL[k].published_pattern() {
            table[row] = (FaultId::ALL[k], pattern);
            row += 1;
        }
        k += 1;
    }
    assert!(row == FAULTS, "a row of Table 1 is missing");
    table
}

/// Probability of each row of Table 1 and of "none of them"; the sum is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidates {
    /// In the order of [`TABLE_1`]. Rows with the same pattern always get the same probability.
    pub faults: [f32; FAULTS],
    /// That the pattern belongs to no row.
    pub unknown: f32,
}

/// Share of "none of the rows" that lights all four: a motor file that is not this motor's, several faults, or a fault that the table
/// does not hold (broken bars, shorted turns). The rest is one of the sixteen patterns, each as likely.
const ALL_LIT: f32 = 0.5;
const ANY_PATTERN: f32 = (1.0 - ALL_LIT) / 16.0;
/// Chance that a residual at its threshold is on.
const HALF: f32 = 0.5;

impl Candidates {
    /// From residuals normalised so that 1 is the threshold. All rows are held equally likely beforehand.
    ///
    /// A row's likelihood is the product over the residuals of the chance that each is on or off as
    /// the row wants; a residual near its threshold counts half for either. r3 and r4 are combinations of r1 and r2 (theory, after (37)): where
    /// r2 alone departs they follow from it, and whether they reach thresholds of their own says nothing.
    pub fn from_normalised(normalised: &[f32; RESIDUALS]) -> Self {
        let mut on = normalised.map(chance_on);
        let [r1, r2, r3, r4] = &mut on;
        if *r1 < HALF && *r2 > HALF {
            (*r3, *r4) = (1.0, 1.0);
        }
        let mut candidates = Candidates {
            faults: [0.0; FAULTS],
            unknown: ALL_LIT * likelihood_of(&[true; RESIDUALS], &on) + ANY_PATTERN,
        };
        for (likelihood, (_, pattern)) in candidates.faults.iter_mut().zip(&TABLE_1) {
            *likelihood = likelihood_of(pattern, &on);
        }
        candidates.normalise()
    }

    fn normalise(mut self) -> Self {
        let sum: f32 = self.faults.iter().sum::<f32>() + self.unknown;
        for probability in &mut self.faults {
            *probability /= sum;
        }
        self.unknown /= sum;
        self
    }

    /// Whether the instrument is a likelier cause than the motor.
    pub fn points_to_sensor(&self) -> bool {
        let mut sensor = 0.0;
        let mut motor = self.unknown;
        for (probability, (fault, _)) in self.faults.iter().zip(&TABLE_1) {
            if fault.is_sensor() {
                sensor += probability;
            } else {
                motor += probability;
            }
        }
        sensor > motor
    }
}

fn likelihood_of(pattern: &[bool; RESIDUALS], on: &[f32; RESIDUALS]) -> f32 {
    pattern.iter().zip(on).fold(1.0, |product, (&wanted, &on)| {
        product * if wanted { on } else { 1.0 - on }
    })
}

/// `x^8/(1 + x^8)`: one half at the threshold, 96 % at 1.5 and 4 % at 0.67 thresholds, no exponential.
/// A residual that says nothing (NaN) is one half: it weighs no row against another.
fn chance_on(normalised: f32) -> f32 {
    if normalised.is_nan() {
        return 0.5;
    }
    let x = normalised.abs().min(16.0);
    let x2 = x * x;
    let x8 = x2 * x2 * x2 * x2;
    x8 / (1.0 + x8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probability(normalised: [f32; 4], fault: FaultId) -> f32 {
        let candidates = Candidates::from_normalised(&normalised);
        TABLE_1
            .iter()
            .zip(candidates.faults)
            .find(|((row, _), _)| *row == fault)
            .map_or(f32::NAN, |(_, probability)| probability)
    }

    #[test]
    fn every_row_is_most_probable_for_its_own_pattern_and_ties_are_equal() {
        for (fault, pattern) in TABLE_1 {
            let normalised = pattern.map(|on| if on { 3.0 } else { 0.1 });
            let candidates = Candidates::from_normalised(&normalised);
            let own = probability(normalised, fault);
            for ((_, other), p) in TABLE_1.iter().zip(candidates.faults) {
                assert!(if *other == pattern {
                    p == own
                } else {
                    p < 0.01 * own
                });
            }
        }
    }

    #[test]
    fn stator_and_rotor_resistance_are_an_honest_tie() {
        let p = probability([3.0, 0.0, 0.1, 3.0], FaultId::StatorResistance);
        assert!((0.45..0.5).contains(&p), "{p}");
    }

    #[test]
    fn a_pattern_of_no_row_is_unknown() {
        let candidates = Candidates::from_normalised(&[0.0, 0.0, 5.0, 0.0]);
        assert!(candidates.unknown > 0.99);
    }

    /// Thresholds of a motor that is known by its plate: r3 and r4 follow r2 and do not reach their own.
    #[test]
    fn a_torque_that_is_missing_is_friction_whether_or_not_r3_and_r4_light() {
        for [r3, r4] in [[0.3, 0.03], [3.0, 0.1], [3.0, 3.0]] {
            for fault in [FaultId::Friction, FaultId::LoadFriction] {
                let p = probability([0.05, 1.5, r3, r4], fault);
                assert!(p > 0.45, "{fault} {r3} {r4}: {p}");
            }
        }
    }

    #[test]
    fn probabilities_sum_to_one_for_any_size() {
        for x in [0.0, 0.5, 1.0, 2.0, 1e6, f32::INFINITY] {
            let candidates = Candidates::from_normalised(&[x, -x, x / 2.0, 0.0]);
            let sum: f32 = candidates.faults.iter().sum::<f32>() + candidates.unknown;
            assert!((sum - 1.0).abs() < 1e-5, "{x}: {sum}"); // ten f32 additions
        }
    }

    #[test]
    fn residuals_that_say_nothing_leave_all_rows_with_the_same_r1_equal() {
        let p = |fault| probability([3.0, f32::NAN, f32::NAN, f32::NAN], fault);
        assert_eq!(p(FaultId::StatorResistance), p(FaultId::SpeedSensor));
        assert!(p(FaultId::Friction) < 0.01 * p(FaultId::SpeedSensor));
    }

    #[test]
    fn sensor_rows_point_to_the_sensor() {
        assert!(Candidates::from_normalised(&[3.0, 3.0, 3.0, 0.0]).points_to_sensor());
        assert!(!Candidates::from_normalised(&[0.0, 3.0, 3.0, 3.0]).points_to_sensor());
        // L_s and the voltage sensor tie: not pointed at the sensor alone.
        assert!(!Candidates::from_normalised(&[3.0, 0.0, 3.0, 3.0]).points_to_sensor());
    }

    /// Table 1 as printed: the columns are r1 to r4, `I` is a lamp that is on.
    #[test]
    fn rows_and_names_are_those_of_the_paper() {
        let printed = [
            ("Rs", "I00I", false),
            ("Rr", "I00I", false),
            ("Ls", "I0II", false),
            ("Lr", "IIII", false),
            ("B", "0III", false),
            ("Bl", "0III", false),
            ("Iq", "III0", true),
            ("Vq", "I0II", true),
            ("wr", "II0I", true),
        ];
        for ((fault, pattern), (name, row, is_sensor)) in TABLE_1.into_iter().zip(printed) {
            let lamps: String = pattern
                .map(|on| if on { 'I' } else { '0' })
                .into_iter()
                .collect();
            assert_eq!(
                (fault.name(), lamps.as_str(), fault.is_sensor()),
                (name, row, is_sensor)
            );
        }
    }

    /// One residual at its threshold, the others far from theirs: the rows that differ in it alone share half and half.
    #[test]
    fn a_residual_at_its_threshold_counts_half_for_either() {
        // `R_s` and `R_r` (I00I) against `L_s` and `V_q` (I0II): each row has a likelihood of one half, "none" 1/32.
        let candidates = Candidates::from_normalised(&[9.0, 0.0, 1.0, 9.0]);
        let expected = 0.5 / (4.0 * 0.5 + 1.0 / 32.0);
        for place in [0, 1, 2, 7] {
            assert!(
                (candidates.faults[place] - expected).abs() < 1e-4,
                "{candidates:?}"
            );
        }
        assert!((candidates.unknown - expected / 16.0).abs() < 1e-4);
    }

    /// A wrong motor file lights all four as the rotor's inductance does.
    #[test]
    fn all_four_lit_is_a_tie_with_none_of_the_rows() {
        let candidates = Candidates::from_normalised(&[5.0, -4.0, 9.0, 3.0]);
        let inductance = probability([5.0, -4.0, 9.0, 3.0], FaultId::RotorInductance);
        let ratio = inductance / candidates.unknown;
        assert!((ratio - 1.0 / (0.5 + 1.0 / 32.0)).abs() < 1e-3, "{ratio}");
        assert!(ratio < crate::TIE_RATIO);
    }

    /// `x^8/(1 + x^8)`: 96 per cent at one and a half thresholds, 4 at two thirds.
    #[test]
    fn the_chance_of_being_on_follows_the_size() {
        for (x, chance) in [
            (1.5, 0.9624),
            (1.0 / 1.5, 0.0376),
            (-1.5, 0.9624),
            (0.0, 0.0),
            (1e9, 1.0),
        ] {
            assert!((chance_on(x) - chance).abs() < 1e-4, "{x}");
        }
        assert_eq!(chance_on(f32::NAN), 0.5);
    }
}
