//! Recordings to compare and explain: short ones are kept, of long ones stretches.

use std::path::Path;

use discovery::{Budget, FirstLook, Gathering, Given, Seen};
use motor::MotorFile;
use recording::{Error, Mapping, Recording, Source};

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
    let read = input.read_in_pieces(path, "reading", &mut |piece, follows| {
        look.take(piece, follows);
        Ok(())
    })?;
    match read {
        Source::Recording(last) => Ok(again(path, &input.mapping()?, look.finish(last))?),
        table @ Source::LoadTable(_) => Ok(Given::Source(table)),
    }
}

/// The same of a recording that was read before: nothing is told of it again.
///
/// # Errors
/// A file that can be read no more.
pub fn stretches(
    path: &Path,
    mapping: &Mapping,
    motor: &MotorFile,
    budget: Budget,
) -> Result<Given, Error> {
    let mut look = FirstLook::new(motor, budget);
    let take = &mut |piece: &Recording, follows| {
        look.take(piece, follows);
        Ok::<(), Error>(())
    };
    let read = formats::read_in_pieces(path, mapping, formats::PIECE_ROWS, &mut |_| {}, take)?;
    match read {
        Source::Recording(last) => again(path, mapping, look.finish(last)),
        table @ Source::LoadTable(_) => Ok(Given::Source(table)),
    }
}

/// What the first reading left open.
fn again(path: &Path, mapping: &Mapping, seen: Seen) -> Result<Given, Error> {
    let quiet = &mut |_| {};
    Ok(match seen {
        Seen::Whole(recording) => Given::Source(Source::Recording(*recording)),
        Seen::Pieces => Given::Source(formats::read_any(path, mapping, quiet)?),
        Seen::Long(choice) => {
            let mut gathering = Gathering::new(*choice);
            let take = &mut |piece: &Recording, _| gathering.take(piece);
            formats::read_in_pieces(path, mapping, formats::PIECE_ROWS, quiet, take)?;
            Given::Excerpt(gathering.finish())
        }
    })
}
