//! Two programs change places, page by page. Each copy is finished before the next begins, and may be done twice.
//!
//! Forth, from the last page to the first: the old page goes one place beyond the waiting one's, then the waiting one takes
//! its place. Back, from the first to the last: the other way round. No copy overwrites what is still needed, and none
//! overwrites its own source.

use embedded_storage::nor_flash::NorFlash;

use crate::layout::{PAGE_BYTES, PROGRAM, WAITING};

/// Bytes that are copied at once.
const PIECE_BYTES: usize = 256;

/// From and to, bytes from the beginning of flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Copy {
    pub from: u32,
    pub to: u32,
}

/// Copies of an exchange of so many pages.
pub fn steps(pages: u8) -> u8 {
    2 * pages
}

/// Copy number `step` on the way forth.
pub fn forth(pages: u8, step: u8) -> Copy {
    let page = u32::from(pages) - 1 - u32::from(step / 2);
    match step % 2 {
        0 => Copy {
            from: program(page),
            to: waiting(page + 1),
        },
        _ => Copy {
            from: waiting(page),
            to: program(page),
        },
    }
}

/// Copy number `step` on the way back.
pub fn back(step: u8) -> Copy {
    let page = u32::from(step / 2);
    match step % 2 {
        0 => Copy {
            from: program(page),
            to: waiting(page),
        },
        _ => Copy {
            from: waiting(page + 1),
            to: program(page),
        },
    }
}

fn program(page: u32) -> u32 {
    PROGRAM + page * PAGE_BYTES
}

fn waiting(page: u32) -> u32 {
    WAITING + page * PAGE_BYTES
}

impl Copy {
    /// Erases the page and copies.
    pub fn run<F: NorFlash>(self, flash: &mut F) -> Result<(), F::Error> {
        flash.erase(self.to, self.to + PAGE_BYTES)?;
        let mut piece = [0; PIECE_BYTES];
        for at in (0..PAGE_BYTES).step_by(PIECE_BYTES) {
            flash.read(self.from + at, &mut piece)?;
            flash.write(self.to + at, &piece)?;
        }
        Ok(())
    }
}
