//! Recordings to compare and explain: short ones are kept, of long ones stretches.

use std::path::Path;

use discovery::{Budget, Choice, Excerpt, Gathering, Given, Survey};
use motor::MotorFile;
use recording::{Recording, Source};

use crate::cli::arguments::input::InputArgs;
use crate::cli::printing::failure::Failure;
use crate::cli::printing::output::DASH;

/// Longest recording that is taken as a whole, s: what is taken of longer ones needs less memory.
const LONGEST_S: f64 = 40.0;

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
    let mut look = Look {
        first: None,
        pieces: 0,
        begin_s: 0.0,
        end_s: 0.0,
        has_unknown_scale: false,
        survey: Survey::new(motor, budget),
    };
    let table = input.read_in_pieces(path, "reading", &mut |piece| {
        look.take(piece);
        Ok(())
    })?;
    if let Some(table) = table {
        return Ok(Given::Source(Source::LoadTable(table)));
    }
    if look.is_long() {
        let excerpt = gathered(path, input, look.choice())?;
        return Ok(Given::Excerpt(excerpt));
    }
    match look.first.filter(|_| look.pieces == 1) {
        Some(first) => Ok(Given::Source(Source::Recording(first))),
        None => {
            let whole = formats::read_any(path, &input.mapping()?, &mut |_| {});
            Ok(Given::Source(whole?))
        }
    }
}

/// A recording that is being read for the first time.
struct Look {
    /// The first piece, as long as it is the only one.
    first: Option<Recording>,
    pieces: usize,
    begin_s: f64,
    end_s: f64,
    /// Its scale is fitted to all of the recording.
    has_unknown_scale: bool,
    survey: Survey,
}

impl Look {
    fn take(&mut self, piece: Recording) {
        let t = piece.t();
        if self.pieces == 0 {
            self.begin_s = t[0];
        }
        self.end_s = t[t.len() - 1];
        self.pieces += 1;
        self.has_unknown_scale |= piece.unknown_speed_scale.is_some();
        if self.pieces == 1 {
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

    fn is_long(&self) -> bool {
        self.end_s - self.begin_s > LONGEST_S && !self.has_unknown_scale
    }

    fn choice(mut self) -> Choice {
        self.survey_first();
        self.survey.choose()
    }
}

/// Reads what was chosen.
fn gathered(path: &Path, input: &InputArgs, choice: Choice) -> Result<Excerpt, Failure> {
    let mut gathering = Gathering::new(choice);
    let mut take = |piece: Recording| gathering.take(&piece);
    let mapping = input.mapping()?;
    formats::read_in_pieces(path, &mapping, formats::PIECE_ROWS, &mut |_| {}, &mut take)?;
    Ok(gathering.finish())
}
