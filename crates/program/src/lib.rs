//! The board's program on a computer: its ELF file, keys, signed packages, and its way over the line.
//!
//! ```
//! use program::{Half, KeyFile};
//! // The demo key, which everybody has: for trying, and never silently.
//! assert!(KeyFile::demo(Half::Secret).is_demo());
//! ```

#[cfg(test)]
mod crafted;
mod elf;
mod error;
pub mod flashing;
mod key_file;
mod package;
mod places;
pub mod sending;

pub use elf::read_elf;
pub use error::Error;
pub use key_file::{Half, KeyFile, new_key};
pub use package::Package;
pub use places::Places;
pub use update::{BOARD_TYPE, Refusal, Seal, SecretKey, Version};
