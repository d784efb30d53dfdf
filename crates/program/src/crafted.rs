//! Programs for tests: sealed bytes, and ELF files with them.

use update::layout::{FLASH_BASE, PROGRAM};
use update::{BOARD_TYPE, SEAL_MAGIC, SEAL_OFFSET, Version};

/// A sealed program of so many bytes, version 1.2.3.
pub fn program(length: usize) -> Vec<u8> {
    program_of(length, "1.2.3")
}

/// A sealed program that a loader would start.
pub fn program_of(length: usize, version: &str) -> Vec<u8> {
    let version = Version::parse(version).0;
    let mut program: Vec<u8> = (0..length)
        .map(|k| (k * k % 253) as u8 ^ version as u8)
        .collect();
    // Stack and beginning.
    set(&mut program, 0, &[0x2001_0000, FIRST + 0x201]);
    let words = [SEAL_MAGIC, length as u32, 0, version, BOARD_TYPE];
    set(&mut program, SEAL_OFFSET, &words);
    let checksum = crc32(&[&program[..SEAL_OFFSET + 4], &program[SEAL_OFFSET + 12..]].concat());
    set(&mut program, SEAL_OFFSET + 8, &[checksum]);
    program
}

/// Words from a place on.
pub fn set(bytes: &mut [u8], at: usize, words: &[u32]) {
    for (k, word) in words.iter().enumerate() {
        bytes[at + 4 * k..at + 4 * k + 4].copy_from_slice(&word.to_le_bytes());
    }
}

/// Bit by bit, as the standard draws it.
fn crc32(bytes: &[u8]) -> u32 {
    let bits = |crc: u32, _| crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
    !bytes
        .iter()
        .fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), bits))
}

/// Kind of a part, where it runs, where it lies in flash, its bytes.
pub type Part<'a> = (u32, u32, u32, &'a [u8]);
/// Loaded into memory.
pub const LOAD: u32 = 1;
/// Where programs begin.
pub const FIRST: u32 = FLASH_BASE + PROGRAM;

/// An ELF file for ARM with these parts.
pub fn elf(parts: &[Part<'_>]) -> Vec<u8> {
    let (head, entry) = (52, 32);
    let mut file = vec![0; head + entry * parts.len()];
    file[..7].copy_from_slice(b"\x7fELF\x01\x01\x01");
    // Executable, ARM, version.
    set(&mut file, 16, &[2 | 40 << 16, 1]);
    set(&mut file, 28, &[head as u32]);
    set(
        &mut file,
        40,
        &[head as u32 | (entry as u32) << 16, parts.len() as u32],
    );
    for (k, (kind, runs, lies, bytes)) in parts.iter().enumerate() {
        let (at, size) = (file.len() as u32, bytes.len() as u32);
        set(
            &mut file,
            head + entry * k,
            &[*kind, at, *runs, *lies, size, size, 5, 4],
        );
        file.extend(*bytes);
    }
    file
}
