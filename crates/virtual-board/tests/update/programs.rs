//! Programs to be exchanged, what the loader's program does about them, and what the journal says.

use std::convert::Infallible;

use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use monitor::RawSample;
use rand::{RngCore, SeedableRng};
use rand_pcg::Pcg32;
use update::layout::{
    FLASH_BASE, JOURNAL, PAGE_BYTES, PROGRAM, PROGRAM_PAGES, WAITING, WAITING_PAGES,
};
use update::{BOARD_TYPE, Journal, State, Version};
use virtual_board::{Inputs, VirtualBoard};

use super::common::packages::{SEAL, put, sealed};

/// First word of a seal, written down here once more.
const MAGIC: u32 = 0x4C41_4553;

/// Behind the vector table and the seal.
const BEGINNING: usize = 0x200;
const FLASH_BYTES: usize = 512 * 1024;

/// Nothing moves.
pub struct Still;

impl Inputs for Still {
    fn at(&mut self, _: u64) -> RawSample {
        RawSample::default()
    }
}

/// A program of random bytes but for its beginning, which leaves `mark` in RAM and feeds the watchdog for ever.
pub fn marking(length: usize, version: &str, mark: u32) -> Vec<u8> {
    let mut program = vec![0; length];
    Pcg32::seed_from_u64(u64::from(mark)).fill_bytes(&mut program);
    put(&mut program, 0, 0x2000_5000);
    put(&mut program, 4, FLASH_BASE + PROGRAM + BEGINNING as u32 + 1);
    put(&mut program, SEAL, MAGIC);
    put(&mut program, SEAL + 12, Version::parse(version).0);
    put(&mut program, SEAL + 16, BOARD_TYPE);
    // ldr r0, r1; str r1, [r0]; ldr r2, r3; str r3, [r2] for ever; then the four words.
    let code: [u16; 8] = [
        0x4804, 0x4905, 0x6001, 0x4A05, 0x4B05, 0x6013, 0xE7FD, 0xBF00,
    ];
    for (at, half) in (BEGINNING..).step_by(2).zip(code) {
        program[at..at + 2].copy_from_slice(&half.to_le_bytes());
    }
    let words = [super::MARK_AT, mark, 0x4000_3000, 0xAAAA];
    for (at, word) in (BEGINNING + 0x14..).step_by(4).zip(words) {
        put(&mut program, at, word);
    }
    sealed(program)
}

/// The program for another board.
pub fn with_board(mut program: Vec<u8>, board: u32) -> Vec<u8> {
    put(&mut program, SEAL + 16, board);
    sealed(program)
}

/// Puts a program in its place as a programmer does.
pub fn install(board: &mut VirtualBoard, program: &[u8]) {
    put_into(board, PROGRAM, PROGRAM_PAGES, program);
}

/// Puts a package into its place of waiting and asks for it.
pub fn request(board: &mut VirtualBoard, package: &[u8]) {
    put_into(board, WAITING, WAITING_PAGES, package);
    write_journal(board, State::Requested);
}

fn put_into(board: &mut VirtualBoard, place: u32, pages: u32, bytes: &[u8]) {
    let mut all = vec![0xFF; (pages * PAGE_BYTES) as usize];
    all[..bytes.len()].copy_from_slice(bytes);
    board.flash(FLASH_BASE + place, &all).expect("flash");
}

/// What the journal says.
pub fn state(board: &mut VirtualBoard) -> State {
    let mut image = Image::of(board);
    let journal = Journal::open(&mut image, JOURNAL).expect("a journal");
    journal.state()
}

/// Writes into the journal as the program does.
pub fn write_journal(board: &mut VirtualBoard, state: State) {
    let mut image = Image::of(board);
    let mut journal = Journal::open(&mut image, JOURNAL).expect("a journal");
    journal.write(&mut image, state).expect("a place");
    let pages = &image.0[JOURNAL as usize..PROGRAM as usize];
    board.flash(FLASH_BASE + JOURNAL, pages).expect("flash");
}

/// A copy of the chip's flash that can be written.
struct Image(Vec<u8>);

impl Image {
    fn of(board: &mut VirtualBoard) -> Self {
        Image(board.read_flash(FLASH_BASE, FLASH_BYTES).expect("flash"))
    }
}

impl ErrorType for Image {
    type Error = Infallible;
}

impl ReadNorFlash for Image {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.0[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Image {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        self.0[from as usize..to as usize].fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        let from = offset as usize;
        self.0[from..from + bytes.len()].copy_from_slice(bytes);
        Ok(())
    }
}
