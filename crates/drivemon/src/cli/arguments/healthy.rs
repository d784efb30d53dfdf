//! Recordings to learn from: short ones are kept, long ones are read again each time that they are asked for.

use std::path::{Path, PathBuf};

use recording::{Mapping, Recording};
use replay::calibrate::{Pieces, Refusal};

use crate::cli::arguments::input::InputArgs;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::DASH;

/// One recording.
pub enum HealthyRecording {
    /// In memory, where it is no longer than a piece.
    Kept(Recording),
    /// On the disk.
    Long {
        /// The file.
        path: PathBuf,
        /// What messages call it.
        name: String,
        /// How it is read.
        mapping: Mapping,
    },
}

impl HealthyRecording {
    /// Reads it once, to its end.
    ///
    /// # Errors
    /// Whatever is wrong with flags, file or sidecar; a load table; a long recording that cannot be read twice.
    pub fn read(path: &Path, input: &InputArgs) -> Result<HealthyRecording, Failure> {
        let (mut first, mut pieces) = (None, 0);
        let table = input.read_in_pieces(path, "reading", &mut |piece| {
            pieces += 1;
            // Of several the first tells the name.
            first = match first.take() {
                None => Some(piece),
                Some(first) => Some(Recording::cut(first, 0..2)?),
            };
            Ok(())
        })?;
        let shown = path.display();
        let Some(first) = first.filter(|_| table.is_none()) else {
            return Err(Failure::Usage(format!(
                "{shown}: a load table has no waveforms to calibrate from; its parameters come from `drivemon explain`"
            )));
        };
        match pieces {
            1 => Ok(HealthyRecording::Kept(first)),
            _ if path.as_os_str() == DASH || !path.is_file() => Err(Failure::Usage(format!(
                "{shown}: a recording this long is read several times, and standard input comes once; name a file"
            ))),
            _ => Ok(HealthyRecording::Long {
                path: path.to_owned(),
                name: first.name().to_owned(),
                mapping: input.mapping()?,
            }),
        }
    }
}

impl Pieces for HealthyRecording {
    fn name(&self) -> &str {
        match self {
            HealthyRecording::Kept(recording) => recording.name(),
            HealthyRecording::Long { name, .. } => name,
        }
    }

    fn each(&self, take: &mut dyn FnMut(&Recording) -> Result<(), Refusal>) -> Result<(), Refusal> {
        let (path, name, mapping) = match self {
            HealthyRecording::Kept(recording) => return take(recording),
            HealthyRecording::Long {
                path,
                name,
                mapping,
            } => (path, name, mapping),
        };
        let mut refused = Ok(());
        let mut give = |piece: Recording| {
            refused = take(&piece);
            // Ends the reading; `refused` is what is told.
            match refused {
                Ok(()) => Ok(()),
                Err(_) => Err(recording::Error::bad(name, "was refused", "see above")),
            }
        };
        let rows = formats::PIECE_ROWS;
        let read = formats::read_in_pieces(path, mapping, rows, &mut |_| {}, &mut give);
        refused?;
        read.map(drop)
            .map_err(|error| Refusal::new(name, error.to_string()))
    }
}
