//! The tray: one piece of a package, on its way from the line to the task that owns flash.

/// Bytes of a piece at most.
pub const PIECE_BYTES: usize = 240;
/// A piece begins at a multiple of this, which is what flash is written in.
pub const STEP_BYTES: u32 = 8;
/// Bytes that are written at once: 0.35 ms of a block's 3.2 ms.
pub const PORTION_BYTES: usize = 32;

/// Why a piece was not laid down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotLaid {
    /// The one before is still there, or nothing is received now: again later.
    Busy,
    /// Another piece is the next one.
    Gap,
    /// Too long, empty, or it does not begin at a multiple of [`STEP_BYTES`].
    Shape,
    /// The transfer has failed; another begins with its first piece.
    Failed,
}

/// Some bytes of a package, and where they go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Portion {
    /// From the beginning of the package.
    pub offset: u32,
    bytes: [u8; PORTION_BYTES],
    length: usize,
}

impl Portion {
    /// At most [`PORTION_BYTES`] bytes.
    pub fn new(offset: u32, bytes: &[u8]) -> Self {
        let mut portion = Portion {
            offset,
            bytes: [0xFF; PORTION_BYTES],
            length: bytes.len().min(PORTION_BYTES),
        };
        let places = portion.bytes.iter_mut();
        places.zip(bytes).for_each(|(place, byte)| *place = *byte);
        portion
    }

    /// Filled up to whole double words.
    pub fn padded(&self) -> &[u8] {
        let whole = self.length.next_multiple_of(STEP_BYTES as usize);
        self.bytes.get(..whole).unwrap_or_default()
    }

    /// Where the next one begins.
    pub fn end(&self) -> u32 {
        self.offset.saturating_add(self.length as u32)
    }
}

/// What became of what lies in the tray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Settled {
    /// It lies there on.
    NotYet,
    /// The portion is in flash, where so many bytes are now.
    Written(u32),
    /// The portion is not in flash, and none of this transfer will be.
    Failed,
}

/// Where the line lays a piece down.
#[derive(Clone, Debug)]
pub struct Tray {
    piece: [u8; PIECE_BYTES],
    offset: u32,
    length: usize,
    /// Bytes of the piece that are in flash.
    done: usize,
    /// Where the next piece begins.
    next: u32,
    open: bool,
    failed: bool,
}

impl Tray {
    /// Closed and empty.
    pub const fn closed() -> Self {
        Tray {
            piece: [0; PIECE_BYTES],
            offset: 0,
            length: 0,
            done: 0,
            next: 0,
            open: false,
            failed: false,
        }
    }

    /// Pieces are taken from now on, or not. What lies there stays.
    pub fn set_open(&mut self, open: bool) {
        self.open = open;
    }

    /// The line lays a piece down: the first one, which begins a transfer, the next one, or one again.
    ///
    /// # Errors
    /// Why it was not laid down.
    pub fn lay(&mut self, offset: u32, piece: &[u8]) -> Result<(), NotLaid> {
        if piece.is_empty() || !offset.is_multiple_of(STEP_BYTES) {
            return Err(NotLaid::Shape);
        }
        let places = self.piece.get_mut(..piece.len()).ok_or(NotLaid::Shape)?;
        if !self.open || self.length > 0 {
            return Err(NotLaid::Busy);
        }
        if self.failed && offset > 0 {
            return Err(NotLaid::Failed);
        }
        if offset > self.next {
            return Err(NotLaid::Gap);
        }
        places
            .iter_mut()
            .zip(piece)
            .for_each(|(to, from)| *to = *from);
        self.failed = false;
        (self.offset, self.length, self.done) = (offset, piece.len(), 0);
        Ok(())
    }

    /// What of the piece goes to flash next.
    pub fn portion(&self) -> Option<Portion> {
        let piece = self.piece.get(..self.length)?;
        let (_, left) = piece.split_at_checked(self.done)?;
        let offset = self.offset.saturating_add(self.done as u32);
        (!left.is_empty()).then(|| Portion::new(offset, left))
    }

    /// Follows what became of the portion.
    pub fn follow(&mut self, settled: Settled) {
        match settled {
            Settled::NotYet => {}
            Settled::Written(received) => self.settle(received),
            Settled::Failed => self.fail(),
        }
    }

    /// The portion is in flash, where so many bytes are now.
    pub fn settle(&mut self, received: u32) {
        self.done += PORTION_BYTES;
        if self.done >= self.length {
            self.length = 0;
            self.next = received;
        }
    }

    /// The portion is not in flash, and none of this transfer will be.
    pub fn fail(&mut self) {
        (self.failed, self.length, self.next) = (true, 0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Everything that lies there, portion by portion, as it goes to flash.
    fn emptied(tray: &mut Tray) -> (u32, Vec<u8>) {
        let (first, mut bytes) = (tray.portion().expect("a piece").offset, Vec::new());
        while let Some(portion) = tray.portion() {
            assert_eq!(portion.offset, first + bytes.len() as u32);
            bytes.extend_from_slice(portion.padded());
            tray.settle(portion.end());
        }
        (first, bytes)
    }

    #[test]
    fn a_piece_comes_out_as_it_went_in_filled_up_to_whole_double_words() {
        let piece: Vec<u8> = (1..=PIECE_BYTES as u8).collect();
        for length in [2, 8, 30, 32, 34, 239, PIECE_BYTES] {
            let mut tray = Tray::closed();
            tray.set_open(true);
            assert_eq!(tray.lay(0, &piece[..length]), Ok(()));
            let mut expected = piece[..length].to_vec();
            expected.resize(length.next_multiple_of(8), 0xFF);
            assert_eq!(emptied(&mut tray), (0, expected), "{length}");
        }
    }

    #[test]
    fn one_piece_at_a_time_and_only_where_the_last_one_ended_or_before() {
        let mut tray = Tray::closed();
        assert_eq!(tray.lay(0, &[1; 16]), Err(NotLaid::Busy), "closed");
        tray.set_open(true);
        assert_eq!(tray.lay(16, &[1; 16]), Err(NotLaid::Gap), "no beginning");
        assert_eq!(tray.lay(0, &[1; 16]), Ok(()));
        assert_eq!(tray.lay(16, &[1; 16]), Err(NotLaid::Busy), "one lies there");
        emptied(&mut tray);
        assert_eq!(tray.lay(24, &[1; 16]), Err(NotLaid::Gap));
        assert_eq!(tray.lay(16, &[1; 16]), Ok(()));
        emptied(&mut tray);
        assert_eq!(tray.lay(16, &[1; 16]), Ok(()), "again");
        emptied(&mut tray);
        assert_eq!(tray.lay(0, &[1; 16]), Ok(()), "anew");
    }

    #[test]
    fn shapes_that_flash_cannot_hold_are_refused() {
        let mut tray = Tray::closed();
        tray.set_open(true);
        assert_eq!(tray.lay(0, &[]), Err(NotLaid::Shape));
        assert_eq!(tray.lay(0, &[0; PIECE_BYTES + 1]), Err(NotLaid::Shape));
        assert_eq!(tray.lay(4, &[0; 8]), Err(NotLaid::Shape));
        assert_eq!(tray.portion(), None);
    }

    #[test]
    fn behind_a_failure_only_a_first_piece_is_taken() {
        let mut tray = Tray::closed();
        tray.set_open(true);
        tray.lay(0, &[1; 64]).expect("a place");
        tray.fail();
        assert_eq!(tray.portion(), None);
        assert_eq!(tray.lay(64, &[1; 8]), Err(NotLaid::Failed));
        assert_eq!(tray.lay(0, &[1; 8]), Ok(()));
        tray.set_open(false);
        assert!(tray.portion().is_some(), "what lies there stays");
        emptied(&mut tray);
        assert_eq!(tray.lay(8, &[1; 8]), Err(NotLaid::Busy));
    }
}
