//! Recordings to learn from: short ones are kept, long ones are read again each time that they are asked for.

use std::path::{Path, PathBuf};

use discovery::{Budget, Given};
use motor::MotorFile;
use recording::{Error, Follows, Mapping, Recording, Source};
use replay::calibrate::{Pieces, Refusal};
use replay::check::Reference;

use crate::cli::arguments::input::InputArgs;
use crate::cli::arguments::long::stretches;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::DASH;

/// One recording.
pub enum HealthyRecording {
    /// In memory, where it is no longer than a piece.
    Kept(Recording),
    /// On the disk.
    Long(LongRecording),
}

/// A recording that does not fit into a piece.
pub struct LongRecording {
    path: PathBuf,
    mapping: Mapping,
    /// Its first two samples.
    head: Recording,
    samples: usize,
}

impl HealthyRecording {
    /// Reads it once, to its end; `remedy` is told of a load table, which has no waveforms to learn from.
    ///
    /// # Errors
    /// Whatever is wrong with flags, file or sidecar; a load table; a long recording that cannot be read twice.
    pub fn read(path: &Path, input: &InputArgs, remedy: &str) -> Result<HealthyRecording, Failure> {
        let (mut head, mut pieces, mut samples) = (None, 0, 0);
        let read = input.read_in_pieces(path, "reading", &mut |piece, follows| {
            pieces += 1;
            samples += piece.len();
            // Of several the first tells the name.
            if (pieces, follows) == (1, Follows::Piece) {
                head = Some(piece.slice(0..2)?.with_t_sample(piece.t_sample()));
            }
            Ok(())
        })?;
        let shown = path.display();
        let Source::Recording(last) = read else {
            return Err(Failure::Usage(format!("{shown}: a load table {remedy}")));
        };
        let Some(head) = head else {
            return Ok(HealthyRecording::Kept(last));
        };
        if path.as_os_str() == DASH || !path.is_file() {
            return Err(Failure::Usage(format!(
                "{shown}: a recording this long is read several times, and standard input comes once; name a file"
            )));
        }
        Ok(HealthyRecording::Long(LongRecording {
            path: path.to_owned(),
            mapping: input.mapping()?,
            head,
            samples,
        }))
    }
}

impl Pieces for HealthyRecording {
    fn name(&self) -> &str {
        match self {
            HealthyRecording::Kept(recording) => recording.name(),
            HealthyRecording::Long(long) => long.head.name(),
        }
    }

    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal> {
        match self {
            HealthyRecording::Kept(recording) => take(recording),
            HealthyRecording::Long(long) => long.each(take),
        }
    }
}

impl Reference for HealthyRecording {
    fn head(&self) -> &Recording {
        match self {
            HealthyRecording::Kept(recording) => recording,
            HealthyRecording::Long(long) => &long.head,
        }
    }

    fn samples(&self) -> usize {
        match self {
            HealthyRecording::Kept(recording) => recording.len(),
            HealthyRecording::Long(long) => long.samples,
        }
    }

    fn given(&self, motor: &MotorFile, alone: bool) -> Result<Given, Error> {
        match self {
            HealthyRecording::Kept(recording) => recording.given(motor, alone),
            HealthyRecording::Long(long) => {
                stretches(&long.path, &long.mapping, motor, Budget::fitted(alone))
            }
        }
    }
}

impl LongRecording {
    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal> {
        let name = self.head.name();
        let mut refused = Ok(());
        let mut give = |piece: &Recording, _| {
            refused = take(piece);
            // Ends the reading; `refused` is what is told.
            match refused {
                Ok(()) => Ok(()),
                Err(_) => Err(Error::bad(name, "was refused", "see above")),
            }
        };
        let rows = formats::PIECE_ROWS;
        let read = formats::read_in_pieces(&self.path, &self.mapping, rows, &mut |_| {}, &mut give);
        refused?;
        read.map(drop)
            .map_err(|error| Refusal::new(name, error.to_string()))
    }
}
