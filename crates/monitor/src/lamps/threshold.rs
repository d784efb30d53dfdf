//! Threshold comparators with persistence and hysteresis (the instrument's sixth stage).

/// When a lamp goes on and off. Residuals arrive normalised: 1 is the threshold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparatorConfig {
    /// Consecutive judged windows that must agree before the lamp changes, >= 1.
    pub persistence: u8,
    /// Level, as a share of the threshold, below which a lit lamp may go out, in (0, 1].
    pub hysteresis: f32,
}

/// One comparator's memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ComparatorState {
    lit: bool,
    disagreeing: u8,
}

impl ComparatorState {
    /// Whether the lamp is lit.
    pub fn is_lit(&self) -> bool {
        self.lit
    }
}

impl ComparatorConfig {
    /// Takes one normalised residual; a value that is not a number leaves the state as it is.
    pub fn update(&self, state: &mut ComparatorState, normalised: f32) -> bool {
        let level = if state.lit { self.hysteresis } else { 1.0 };
        let above = normalised.abs() >= level;
        if normalised.is_nan() || above == state.lit {
            state.disagreeing = 0;
            return state.lit;
        }
        state.disagreeing = state.disagreeing.saturating_add(1);
        if state.disagreeing >= self.persistence {
            *state = ComparatorState {
                lit: above,
                disagreeing: 0,
            };
        }
        state.lit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIG: ComparatorConfig = ComparatorConfig {
        persistence: 3,
        hysteresis: 0.8,
    };

    fn run(values: &[f32]) -> Vec<bool> {
        let mut state = ComparatorState::default();
        values
            .iter()
            .map(|&value| CONFIG.update(&mut state, value))
            .collect()
    }

    #[test]
    fn a_short_excursion_lights_nothing() {
        assert_eq!(run(&[2.0, -2.0, 0.0, 2.0, 2.0]), [false; 5]);
    }

    #[test]
    fn a_lasting_excursion_of_either_sign_lights_at_the_third_window() {
        assert_eq!(run(&[1.0, -2.0, 1.5, 0.0]), [false, false, true, true]);
    }

    #[test]
    fn a_lit_lamp_stays_between_hysteresis_and_threshold() {
        assert!(run(&[2.0, 2.0, 2.0, 0.9, 0.9, 0.9, 0.9])[6]);
        assert!(!run(&[2.0, 2.0, 2.0, 0.7, 0.7, 0.7])[5]);
    }

    #[test]
    fn not_a_number_changes_nothing() {
        assert_eq!(run(&[2.0, 2.0, f32::NAN, 2.0]), [false; 4]);
        assert!(run(&[2.0, 2.0, 2.0, f32::NAN])[3]);
    }
}
