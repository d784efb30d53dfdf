//! Who lies where in flash; bytes from its beginning, 0x0800_0000. memory.x and tools/seal say the same.

/// Where flash is read.
pub const FLASH_BASE: u32 = 0x0800_0000;
/// Bytes of a page.
pub const PAGE_BYTES: u32 = 2048;
/// Bytes of a bank; the two can be read and written independently.
pub const BANK_BYTES: u32 = 256 * 1024;
/// Bytes for the loader, which lies at the beginning and is never exchanged.
pub const LOADER_BYTES: u32 = 12 * PAGE_BYTES;
/// The journal of updates.
pub const JOURNAL: u32 = LOADER_BYTES;
/// Pages of the journal.
pub const JOURNAL_PAGES: u32 = 2;
/// The program.
pub const PROGRAM: u32 = 16 * PAGE_BYTES;
/// Pages of the program at most.
pub const PROGRAM_PAGES: u32 = 108;
/// Where the new program waits, in the other bank: the running one is not held up while it is written.
pub const WAITING: u32 = BANK_BYTES;
/// Pages there: one more than the program has, for the exchange.
pub const WAITING_PAGES: u32 = PROGRAM_PAGES + 1;

const _: () = assert!(JOURNAL + JOURNAL_PAGES * PAGE_BYTES <= PROGRAM);
const _: () = assert!(PROGRAM + PROGRAM_PAGES * PAGE_BYTES <= BANK_BYTES);

/// Pages that so many bytes take.
pub const fn pages(bytes: u32) -> u32 {
    bytes.div_ceil(PAGE_BYTES)
}
