//! What the loader does at each start, before any program runs.

use embedded_storage::nor_flash::NorFlash;

use crate::exchange::{self, Copy};
use crate::journal::{Journal, JournalError, State};
use crate::key::PublicKey;
use crate::layout::{
    FLASH_BASE, JOURNAL, PAGE_BYTES, PROGRAM, PROGRAM_PAGES, WAITING, WAITING_PAGES, pages,
};
use crate::package;
use crate::refusal::Refusal;
use crate::seal::Seal;

/// Where a program's stack may begin: within or at the end of the chip's RAM.
const RAM: core::ops::RangeInclusive<u32> = 0x2000_0008..=0x2002_0000;

/// Flash that can also be read in place.
pub trait MappedFlash: NorFlash {
    /// Bytes from place `from`, counted from the beginning of flash.
    fn bytes(&self, from: u32, length: u32) -> &[u8];
}

/// What the loader does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Start the program.
    Program,
    /// Flash failed within an exchange: neither program is whole, so start again and go on.
    Again,
    /// There is no program.
    NoProgram,
}

/// Checks, exchanges, brings back: whatever the journal says is due.
pub fn start<F: MappedFlash>(flash: &mut F, key: &PublicKey) -> Next {
    let Ok(mut journal) = Journal::open(flash, JOURNAL) else {
        return Next::Again;
    };
    let done = advance(flash, &mut journal, key);
    match (done, journal.state()) {
        (Err(_), State::Exchanging { .. } | State::Reverting { .. }) => Next::Again,
        _ if has_program(flash) => Next::Program,
        _ => Next::NoProgram,
    }
}

fn advance<F: MappedFlash>(
    flash: &mut F,
    journal: &mut Journal,
    key: &PublicKey,
) -> Result<(), JournalError> {
    if journal.state() == State::Requested {
        let decided = decide(flash, key);
        journal.write(flash, decided)?;
    }
    if let State::OnTrial { pages } = journal.state() {
        journal.write(flash, State::Reverting { pages, step: 0 })?;
    }
    exchange_forth(flash, journal)?;
    exchange_back(flash, journal)?;
    if let State::Installed { pages } = journal.state() {
        journal.write(flash, State::OnTrial { pages })?;
    }
    Ok(())
}

/// Whether the program that waits is taken.
fn decide<F: MappedFlash>(flash: &F, key: &PublicKey) -> State {
    let running = Seal::read(flash.bytes(PROGRAM, PROGRAM_PAGES * PAGE_BYTES)).ok();
    let package = flash.bytes(WAITING, WAITING_PAGES * PAGE_BYTES);
    match package::check(package, running, key) {
        Ok(seal) => {
            // Without a seal the one that runs may be as long as any.
            let most = PROGRAM_PAGES * PAGE_BYTES;
            let old = running.map_or(most, |running| running.length);
            let pages = pages(seal.length.max(old)) as u8;
            State::Exchanging { pages, step: 0 }
        }
        Err(refusal) => State::Refused(refusal),
    }
}

fn exchange_forth<F: MappedFlash>(
    flash: &mut F,
    journal: &mut Journal,
) -> Result<(), JournalError> {
    while let State::Exchanging { pages, step } = journal.state() {
        if step < exchange::steps(pages) {
            copy(flash, exchange::forth(pages, step))?;
            let step = step + 1;
            journal.write(flash, State::Exchanging { pages, step })?;
        } else if is_whole(flash) {
            journal.write(flash, State::Installed { pages })?;
        } else {
            journal.write(flash, State::Reverting { pages, step: 0 })?;
        }
    }
    Ok(())
}

fn exchange_back<F: MappedFlash>(flash: &mut F, journal: &mut Journal) -> Result<(), JournalError> {
    while let State::Reverting { pages, step } = journal.state() {
        if step < exchange::steps(pages) {
            copy(flash, exchange::back(step))?;
            let step = step + 1;
            journal.write(flash, State::Reverting { pages, step })?;
        } else {
            journal.write(flash, State::Reverted)?;
        }
    }
    Ok(())
}

fn copy<F: NorFlash>(flash: &mut F, copy: Copy) -> Result<(), JournalError> {
    copy.run(flash).map_err(|_| JournalError::Flash)
}

/// Whether the program in its place is the one that was sealed.
fn is_whole<F: MappedFlash>(flash: &F) -> bool {
    let program = flash.bytes(PROGRAM, PROGRAM_PAGES * PAGE_BYTES);
    let checked: Result<(), Refusal> = Seal::read(program).and_then(|seal| seal.check(program));
    checked.is_ok()
}

/// Whether the first two words are a stack and a beginning: not an erased page, nor something else.
fn has_program<F: MappedFlash>(flash: &F) -> bool {
    let (words, _) = flash.bytes(PROGRAM, 8).as_chunks::<4>();
    let [stack, reset] = words else {
        return false;
    };
    let (stack, reset) = (u32::from_le_bytes(*stack), u32::from_le_bytes(*reset));
    let first = FLASH_BASE + PROGRAM;
    let program = first..first + PROGRAM_PAGES * PAGE_BYTES;
    RAM.contains(&stack) && stack.is_multiple_of(8) && program.contains(&reset) && reset % 2 == 1
}
