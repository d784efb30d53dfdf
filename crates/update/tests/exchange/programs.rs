//! Programs and packages, made without the crate under test: the layout of the seal is written down here once more.

use update::{BOARD_TYPE, SecretKey, Version};

pub const OWNER: [u8; 32] = [7; 32];

/// What a program is made of.
#[derive(Clone, Copy)]
pub struct Recipe {
    pub length: usize,
    pub version: Version,
    pub board: u32,
    pub content: u8,
}

pub fn recipe(length: usize, content: u8) -> Recipe {
    Recipe {
        length,
        version: Version::parse("1.2.0"),
        board: BOARD_TYPE,
        content,
    }
}

/// A sealed program: a vector table that may be started, seal, content.
pub fn program(recipe: Recipe) -> Vec<u8> {
    let mut bytes: Vec<u8> = (0..recipe.length)
        .map(|k| (k as u8).wrapping_mul(31) ^ recipe.content)
        .collect();
    let mut word = |at: usize, value: u32| bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    word(0, 0x2000_5000);
    word(4, 0x0800_8201);
    word(0x1E0, 0x4C41_4553);
    word(0x1E4, recipe.length as u32);
    word(0x1EC, recipe.version.0);
    word(0x1F0, recipe.board);
    let covered = [&bytes[..0x1E4], &bytes[0x1EC..]].concat();
    let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&covered);
    bytes[0x1E8..0x1EC].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

/// Program and signature.
pub fn package(program: &[u8], seed: [u8; 32]) -> Vec<u8> {
    let signature = SecretKey::from_seed(seed).sign(program);
    [program, &signature].concat()
}
