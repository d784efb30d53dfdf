//! How a program reaches a board over its line.
//!
//! The running program receives the new one into the other bank of flash, its place of waiting, and asks for it. At the next
//! start the loader checks its signature and exchanges both page by page. The new program is on trial: it confirms itself,
//! or the next start brings the old one back. A journal of single double words, each with its checksum, says at any moment
//! how far that is, so that power may fail at every one of them.
//!
//! ```
//! use update::{SecretKey, Version};
//!
//! let owner = SecretKey::from_seed([7; 32]);
//! let signature = owner.sign(b"a program");
//! assert!(owner.public().verify(b"a program", &signature).is_ok());
//! assert!(owner.public().verify(b"another", &signature).is_err());
//! assert!(Version::parse("1.10.0") > Version::parse("1.9.2"));
//! ```
#![cfg_attr(not(test), no_std)]

mod exchange;
mod journal;
mod key;
pub mod layout;
mod loader;
pub mod package;
mod receiving;
mod refusal;
mod seal;

pub use journal::{Journal, JournalError, State};
pub use key::{PublicKey, SIGNATURE_BYTES, SecretKey};
pub use loader::{MappedFlash, Next, start};
pub use receiving::background::BackgroundFlash;
pub use receiving::state::UpdateState;
pub use receiving::tray::{
    NotLaid, PIECE_BYTES, PORTION_BYTES, Portion, STEP_BYTES, Settled, Tray,
};
pub use receiving::updater::{Due, News, Updater};
pub use receiving::waiting::{Checked, Taken, Waiting};
pub use refusal::Refusal;
pub use seal::{BOARD_TYPE, LEFT_OUT, SEAL_BYTES, SEAL_MAGIC, SEAL_OFFSET, Seal, Tally, Version};
