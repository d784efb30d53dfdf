//! Recordings of the motor in good order, of any length.

use discovery::Given;
use motor::MotorFile;
use recording::{Error, Recording, Source};

use crate::calibrate::{Pieces, Refusal};
use crate::speed::with_estimated_speed;

/// A recording of the motor in good order: one that is in memory, or one that is read again each time that it is asked for.
pub trait Reference: Pieces {
    /// All of it where it is in memory, else its first samples.
    fn head(&self) -> &Recording;

    /// Samples of all of it.
    fn samples(&self) -> usize;

    /// What a fit takes of it: all, or stretches; `alone`: no other recording proves.
    ///
    /// # Errors
    /// A file that can be read no more.
    fn given(&self, motor: &MotorFile, alone: bool) -> Result<Given, Error>;
}

impl Reference for Recording {
    fn head(&self) -> &Recording {
        self
    }

    fn samples(&self) -> usize {
        self.len()
    }

    fn given(&self, _motor: &MotorFile, _alone: bool) -> Result<Given, Error> {
        Ok(Given::Source(Source::Recording(self.clone())))
    }
}

/// Whether a recording that begins with a piece begins as a reference does.
pub fn begins_like(reference: &dyn Reference, piece: &Recording) -> bool {
    let head = reference.head();
    if head.len() >= piece.len() {
        return head == piece;
    }
    let begin = piece.slice(0..head.len());
    begin.is_ok_and(|begin| begin.with_t_sample(head.t_sample()) == *head)
}

/// A reference with the speed as it will be estimated when the motor is checked, where it has none.
pub(super) struct WithSpeed<'r> {
    reference: &'r dyn Reference,
    motor: &'r MotorFile,
    /// All of it, where that is in memory: estimated once.
    whole: Option<Recording>,
}

impl<'r> WithSpeed<'r> {
    pub fn new(reference: &'r dyn Reference, motor: &'r MotorFile) -> WithSpeed<'r> {
        let head = reference.head();
        let is_whole = head.len() == reference.samples();
        let estimated = is_whole.then(|| with_estimated_speed(head, motor));
        WithSpeed {
            reference,
            motor,
            whole: estimated.flatten().map(|(with_speed, _)| with_speed),
        }
    }
}

impl Pieces for WithSpeed<'_> {
    fn name(&self) -> &str {
        self.reference.name()
    }

    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal> {
        let head = self.reference.head();
        match &self.whole {
            Some(whole) => take(whole),
            None if head.len() == self.reference.samples() => take(head),
            None => self.reference.each(&mut |piece| {
                let estimated = with_estimated_speed(piece, self.motor);
                take(estimated.as_ref().map_or(piece, |(shown, _)| shown))
            }),
        }
    }
}
