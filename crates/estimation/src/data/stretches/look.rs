//! The first reading of a recording of unknown length.

use motor::MotorFile;
use recording::Recording;

use super::chosen::Budget;
use super::excerpt::{Choice, Survey};

/// Longest recording that is taken as a whole, s: what is taken of longer ones needs less memory.
const LONGEST_S: f64 = 40.0;

/// A recording that is being read for the first time, piece by piece.
pub struct FirstLook {
    /// The first piece, as long as it is the only one.
    first: Option<Recording>,
    pieces: usize,
    span: [f64; 2],
    /// Its scale is fitted to all of the recording.
    has_unknown_scale: bool,
    survey: Survey,
}

/// What there is to do after the first reading.
pub enum Seen {
    /// Nothing: this is all of it.
    Whole(Box<Recording>),
    /// Read it again, as a whole.
    Pieces,
    /// Read it again, and take what was chosen.
    Long(Box<Choice>),
}

impl FirstLook {
    /// Before the first piece.
    pub fn new(motor: &MotorFile, budget: Budget) -> Self {
        Self {
            first: None,
            pieces: 0,
            span: [0.0; 2],
            has_unknown_scale: false,
            survey: Survey::new(motor, budget),
        }
    }

    /// Takes the next piece.
    pub fn take(&mut self, piece: Recording) {
        let t = piece.t();
        self.span = match self.pieces {
            0 => [t[0], t[t.len() - 1]],
            _ => [self.span[0], t[t.len() - 1]],
        };
        self.pieces += 1;
        self.has_unknown_scale |= piece.unknown_speed_scale.is_some();
        if self.pieces == 1 {
            // Most recordings are short, and audited when they are asked about.
            self.first = Some(piece);
            return;
        }
        self.survey_first();
        self.survey.take(&piece);
    }

    fn survey_first(&mut self) {
        if let Some(first) = self.first.take() {
            self.survey.take(&first);
        }
    }

    /// What there is to do; pieces must have been taken.
    pub fn finish(mut self) -> Seen {
        if self.span[1] - self.span[0] > LONGEST_S && !self.has_unknown_scale {
            self.survey_first();
            return Seen::Long(Box::new(self.survey.choose()));
        }
        match self.first {
            Some(first) => Seen::Whole(Box::new(first)),
            None => Seen::Pieces,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen;

    fn seen(pieces: Vec<Recording>) -> Seen {
        let motor = specimen::motor("");
        let mut look = FirstLook::new(&motor, Budget::compared(true));
        pieces.into_iter().for_each(|piece| look.take(piece));
        look.finish()
    }

    fn halves(whole: &Recording) -> Vec<Recording> {
        let half = whole.len() / 2;
        let part = |range| whole.slice(range).expect("a half");
        vec![part(0..half), part(half..whole.len())]
    }

    #[test]
    fn a_short_recording_is_kept_and_a_long_one_is_read_again() {
        let short = specimen::recording(2.0, |_| 1.0);
        let kept = seen(vec![short.clone()]);
        assert!(matches!(kept, Seen::Whole(kept) if *kept == short));
        assert!(matches!(seen(halves(&short)), Seen::Pieces));
        let long = specimen::recording(41.0, |_| 1.0);
        assert!(matches!(seen(halves(&long)), Seen::Long(_)));
        assert!(matches!(seen(vec![long]), Seen::Long(_)));
    }

    /// Its least slip is that of all of it.
    #[test]
    fn an_unknown_scale_needs_all_of_the_recording() {
        let unknown = specimen::unknown_speed(41.0, 0.4);
        assert!(matches!(seen(halves(&unknown)), Seen::Pieces));
    }
}
