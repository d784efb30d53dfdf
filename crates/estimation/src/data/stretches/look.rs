//! The first reading of a recording of unknown length.

use motor::MotorFile;
use recording::{Follows, Recording};

use super::chosen::Budget;
use super::excerpt::{Choice, Survey};

/// Longest recording that is taken as a whole, s: what is taken of longer ones needs less memory.
const LONGEST_S: f64 = 40.0;

/// A recording that is being read for the first time, piece by piece.
pub struct FirstLook {
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
            pieces: 0,
            span: [0.0; 2],
            has_unknown_scale: false,
            survey: Survey::new(motor, budget),
        }
    }

    /// Takes the next piece.
    pub fn take(&mut self, piece: &Recording, follows: Follows) {
        let t = piece.t();
        self.span = match self.pieces {
            0 => [t[0], t[t.len() - 1]],
            _ => [self.span[0], t[t.len() - 1]],
        };
        self.pieces += 1;
        self.has_unknown_scale |= piece.unknown_speed_scale.is_some();
        // Most recordings are short, and audited when they are asked about.
        if self.pieces > 1 || follows == Follows::Piece {
            self.survey.take(piece);
        }
    }

    /// What there is to do; `last` is the last piece that was taken.
    pub fn finish(mut self, last: Recording) -> Seen {
        let is_whole = self.pieces == 1;
        if self.span[1] - self.span[0] > LONGEST_S && !self.has_unknown_scale {
            if is_whole {
                self.survey.take(&last);
            }
            return Seen::Long(Box::new(self.survey.choose()));
        }
        match is_whole {
            true => Seen::Whole(Box::new(last)),
            false => Seen::Pieces,
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
        let last = pieces.len() - 1;
        for (k, piece) in pieces.iter().enumerate() {
            let follows = if k == last {
                Follows::Nothing
            } else {
                Follows::Piece
            };
            look.take(piece, follows);
        }
        look.finish(pieces[last].clone())
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
