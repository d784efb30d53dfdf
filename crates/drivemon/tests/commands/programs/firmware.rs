//! A program that is sealed as the firmware is, and its ELF file.

use program::{BOARD_TYPE, Version};

/// Where programs lie, and their seal in them.
const FIRST: u32 = 0x0800_8000;
const SEAL: usize = 0x1E0;

fn set(bytes: &mut [u8], at: usize, words: &[u32]) {
    let places = bytes[at..].chunks_exact_mut(4);
    places
        .zip(words)
        .for_each(|(place, word)| place.copy_from_slice(&word.to_le_bytes()));
}

/// CRC-32, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let bits = |crc: u32, _| crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
    !bytes
        .iter()
        .fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), bits))
}

/// A program of some kilobytes.
pub fn program(version: &str) -> Vec<u8> {
    let mut program: Vec<u8> = (0..5_001_u32).map(|k| (k % 253) as u8).collect();
    let length = program.len() as u32;
    let version = Version::parse(version).0;
    set(
        &mut program,
        SEAL,
        &[0x4C41_4553, length, 0, version, BOARD_TYPE],
    );
    let counted = [&program[..SEAL + 4], &program[SEAL + 12..]].concat();
    set(&mut program, SEAL + 8, &[crc32(&counted)]);
    program
}

/// One part that is loaded where it runs.
pub fn elf(program: &[u8]) -> Vec<u8> {
    let mut file = vec![0; 84];
    file[..7].copy_from_slice(b"\x7fELF\x01\x01\x01");
    set(&mut file, 16, &[2 | 40 << 16, 1]);
    set(&mut file, 28, &[52]);
    set(&mut file, 40, &[52 | 32 << 16, 1]);
    let size = program.len() as u32;
    set(&mut file, 52, &[1, 84, FIRST, FIRST, size, size, 5, 4]);
    file.extend(program);
    file
}
