//! Programs as packages, and how a master sends one over the board's line.

use std::path::Path;

use board::crc32;
use board::modbus::{MOST_PROGRAM_WORDS, PROGRAM_FILE, UNLOCK_KEY};
use update::layout::{FLASH_BASE, PAGE_BYTES, PROGRAM, PROGRAM_PAGES};
use update::{Seal, SecretKey, Version};
use virtual_board::VirtualBoard;

use super::master::{Master, UNIT, ask, bytes, sealed as sealed_request};

/// Where the seal lies in a program: written down here once more.
pub const SEAL: usize = 0x1E0;

pub fn put(program: &mut [u8], at: usize, word: u32) {
    program[at..at + 4].copy_from_slice(&word.to_le_bytes());
}

/// The program with length and checksum of its bytes in its seal.
pub fn sealed(mut program: Vec<u8>) -> Vec<u8> {
    let length = program.len() as u32;
    put(&mut program, SEAL + 4, length);
    let covered = [&program[..SEAL + 4], &program[SEAL + 12..]].concat();
    put(&mut program, SEAL + 8, crc32(&covered));
    program
}

/// The program with another version.
pub fn with_version(mut program: Vec<u8>, version: &str) -> Vec<u8> {
    put(&mut program, SEAL + 12, Version::parse(version).0);
    sealed(program)
}

/// Program and its signature with the demo key.
pub fn package(program: &[u8]) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../keys/demo.key");
    let text = std::fs::read_to_string(path).expect("the demo key");
    let digits = text.lines().last().expect("a line of digits");
    let digit = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).expect("digits");
    let seed = std::array::from_fn(|k| digit(2 * k));
    signed(program, seed)
}

/// Program and its signature with any key.
pub fn signed(program: &[u8], seed: [u8; 32]) -> Vec<u8> {
    let signature = SecretKey::from_seed(seed).sign(program);
    [program, &signature].concat()
}

/// Everything that belongs to the program in flash.
pub fn area(board: &mut VirtualBoard) -> Vec<u8> {
    let size = (PROGRAM_PAGES * PAGE_BYTES) as usize;
    board.read_flash(FLASH_BASE + PROGRAM, size).expect("flash")
}

/// The program in flash, as long as its seal says.
pub fn installed(board: &mut VirtualBoard) -> Vec<u8> {
    let mut program = area(board);
    let seal = Seal::read(&program).expect("a sealed program");
    program.truncate(seal.length as usize);
    program
}

/// A piece of a package as function 21 has it: in file 4, or in file 5 from 128 KiB on.
pub fn request(from: usize, piece: &[u8]) -> Vec<u8> {
    let mut request = vec![UNIT, 21, 7 + piece.len() as u8, 6];
    let file = PROGRAM_FILE + (from >> 17) as u16;
    for word in [file, (from % (1 << 17) / 2) as u16, piece.len() as u16 / 2] {
        request.extend(word.to_be_bytes());
    }
    sealed_request(&[&request, piece].concat())
}

/// The code of the exception; 0 where the request came back.
pub fn offer(board: &mut VirtualBoard, from: usize, piece: &[u8]) -> u8 {
    let request = request(from, piece);
    let answer = bytes(&ask(board, &request));
    if answer == request {
        return 0;
    }
    assert_eq!(answer[..2], [UNIT, 0x95], "{answer:02x?}");
    answer[2]
}

/// Sends all of it as a master does that repeats a piece for which the board is busy; how often it was.
pub fn send(board: &mut VirtualBoard, package: &[u8]) -> u32 {
    assert!(Master::new(UNIT).write(board, 0, UNLOCK_KEY));
    let (mut from, mut busy) = (0, 0);
    while from < package.len() {
        let file_end = (from / (1 << 17) + 1) << 17;
        let end = (from + 2 * usize::from(MOST_PROGRAM_WORDS))
            .min(package.len())
            .min(file_end);
        match offer(board, from, &package[from..end]) {
            0 => from = end,
            6 => busy += 1,
            code => panic!("exception {code} at {from}"),
        }
        assert!(busy < 100, "always busy");
    }
    board.run(0.1).expect("a run");
    busy
}
