//! A file as consecutive pieces: the next one is read when the one before is done.

use super::collector::Collector;
use super::raw::Piece;
use crate::read::plan::Plan;
use crate::read::table_file::TableFile;
use crate::read::text::source::Progress;
use recording::Error;

/// How much of a file is in memory at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::read) enum Extent {
    /// All of it; how much is bounded.
    Whole,
    /// So many rows, where more are to follow.
    Rows(usize),
}

/// Rows on either side of a piece by which its ends are converted as its middle is: an encoder's edges are counted over
/// 5 ms, delays and spikes reach over a few samples.
const MARGIN: usize = 4096;

/// The last piece is longer by this share rather than followed by a shorter one.
const LONGER: f64 = 1.0 / 30.0;

impl Extent {
    /// Rows beyond which a piece is given away.
    fn most(self) -> usize {
        match self {
            Extent::Whole => usize::MAX,
            Extent::Rows(rows) => rows + (LONGER * rows as f64) as usize,
        }
    }

    /// Rows that are in memory at once, as far as that is known; what is not used costs nothing.
    fn room(self) -> usize {
        match self {
            Extent::Whole => 0,
            Extent::Rows(_) => self.most() + 3 * MARGIN,
        }
    }
}

/// Reads the used columns of a file; `take` gets the pieces in their order and gives their memory back, and the last one comes
/// back when the file has been read.
///
/// # Errors
/// Whatever is wrong with a row, and what `take` returns.
pub(in crate::read) fn gather(
    file: &mut dyn TableFile,
    plan: &Plan,
    extent: Extent,
    progress: &mut dyn FnMut(Progress),
    take: &mut Take<'_>,
) -> Result<Piece, Error> {
    if extent == Extent::Whole {
        file.check_size()?;
    }
    let mut gathered = Gathered {
        collector: Collector::new(file.header(), plan, extent.room(), extent == Extent::Whole),
        extent,
        take,
    };
    let in_blocks = file.for_each_block(progress, &mut |block| {
        gathered.collector.take_block(block)?;
        gathered.give_away()
    })?;
    if !in_blocks {
        file.for_each_row(progress, &mut |row| {
            gathered.collector.take(row)?;
            gathered.give_away()
        })?;
    }
    let mut collector = gathered.collector;
    Ok(collector.give(collector.fresh(), MARGIN))
}

/// Takes a piece; what is left of it is memory to be filled again.
pub(in crate::read) type Take<'t> = dyn FnMut(Piece) -> Result<Vec<Vec<f64>>, Error> + 't;

struct Gathered<'t, 'u> {
    collector: Collector,
    extent: Extent,
    take: &'t mut Take<'u>,
}

impl Gathered<'_, '_> {
    fn give_away(&mut self) -> Result<(), Error> {
        match self.extent {
            Extent::Rows(rows) if self.collector.fresh() > self.extent.most() => {
                let buffers = (self.take)(self.collector.give(rows, MARGIN))?;
                self.collector
                    .go_on(buffers.into_iter(), self.extent.room());
                Ok(())
            }
            _ => Ok(()),
        }
    }
}
