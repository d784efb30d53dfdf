//! What the program says of itself: length and checksum, which tools/seal writes into the finished file, version and board.
// Constants that are changed in the finished file.
#![allow(unsafe_code)]

use update::layout;
use update::{BOARD_TYPE, SEAL_MAGIC, Version};

/// Not written yet.
const BLANK: u32 = 0xFFFF_FFFF;
/// Where the program begins, and where the two words lie that its checksum leaves out.
pub const PROGRAM: u32 = layout::FLASH_BASE + layout::PROGRAM;
pub const LEFT_OUT: core::ops::Range<u32> =
    PROGRAM + update::LEFT_OUT.start as u32..PROGRAM + update::LEFT_OUT.end as u32;

/// Behind the vector table (src/regions.x): magic, length, checksum, version, board. The loader reads it as `update::Seal` does.
#[used]
#[unsafe(link_section = ".seal")]
static SEAL: [u32; 5] = [
    SEAL_MAGIC,
    BLANK,
    BLANK,
    Version::parse(env!("CARGO_PKG_VERSION")).0,
    BOARD_TYPE,
];

/// Bytes of the program and their checksum; `None` where it was never sealed.
pub fn read() -> Option<(u32, u32)> {
    // Safety: a constant; read as it lies in flash, not as it was compiled.
    let [magic, length, checksum, ..] = unsafe { (&raw const SEAL).read_volatile() };
    (magic == SEAL_MAGIC && length != BLANK).then_some((length, checksum))
}
