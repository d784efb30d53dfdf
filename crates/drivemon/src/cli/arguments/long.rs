//! Recordings to compare and explain: short ones are kept, of long ones stretches.

use std::path::Path;

use discovery::{Budget, FirstLook, Gathering, Given, Seen};
use motor::MotorFile;
use recording::{Recording, Source};

use crate::cli::arguments::input::InputArgs;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::DASH;

/// Reads a recording or a load table. A file is read twice where it is long: once to look at all of it, once to take the
/// stretches that were chosen.
///
/// # Errors
/// Whatever is wrong with flags, file or sidecar.
pub fn given(
    path: &Path,
    input: &InputArgs,
    motor: &MotorFile,
    budget: Budget,
) -> Result<Given, Failure> {
    // Standard input comes once.
    if path.as_os_str() == DASH || !path.is_file() {
        return Ok(Given::Source(input.read(path)?));
    }
    let mut look = FirstLook::new(motor, budget);
    let table = input.read_in_pieces(path, "reading", &mut |piece| {
        look.take(piece);
        Ok(())
    })?;
    if let Some(table) = table {
        return Ok(Given::Source(Source::LoadTable(table)));
    }
    let mapping = input.mapping()?;
    let quiet = &mut |_| {};
    Ok(match look.finish() {
        Seen::Whole(recording) => Given::Source(Source::Recording(*recording)),
        Seen::Pieces => Given::Source(formats::read_any(path, &mapping, quiet)?),
        Seen::Long(choice) => {
            let mut gathering = Gathering::new(*choice);
            let take = &mut |piece: Recording| gathering.take(&piece);
            formats::read_in_pieces(path, &mapping, formats::PIECE_ROWS, quiet, take)?;
            Given::Excerpt(gathering.finish())
        }
    })
}
