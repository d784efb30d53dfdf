//! Length and checksum of the program, which tools/seal writes into the finished file.
// Constants that are changed in the finished file.
#![allow(unsafe_code)]

/// What the seal's first word says, written at all.
const MAGIC: u32 = 0x4C41_4553;
/// Not written yet.
const BLANK: u32 = 0xFFFF_FFFF;
/// Where the program begins, and where the two words lie that its checksum leaves out.
pub const PROGRAM: u32 = 0x0800_0000;
pub const LEFT_OUT: core::ops::Range<u32> = PROGRAM + 0x1E4..PROGRAM + 0x1EC;

/// Behind the vector table (memory.x).
#[repr(C)]
struct Seal {
    magic: u32,
    length: u32,
    checksum: u32,
}

#[used]
#[unsafe(link_section = ".seal")]
static SEAL: Seal = Seal {
    magic: MAGIC,
    length: BLANK,
    checksum: BLANK,
};

/// Bytes of the program and their checksum; `None` where it was never sealed.
pub fn read() -> Option<(u32, u32)> {
    // Safety: a constant; read as it lies in flash, not as it was compiled.
    let seal = unsafe { (&raw const SEAL).read_volatile() };
    (seal.magic == MAGIC && seal.length != BLANK).then_some((seal.length, seal.checksum))
}
