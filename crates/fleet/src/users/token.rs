//! Tokens: 256 random bits, of which only a hash is kept.

use std::fmt::Write;

use sha2::{Digest, Sha256};

/// What a token begins with: scanners of leaked secrets find it by that.
const PREFIX: &str = "dmt_";

/// A new token.
///
/// # Errors
/// The system has no random numbers.
pub(crate) fn new_token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 32];
    getrandom::fill(&mut bytes)?;
    let mut token = PREFIX.to_owned();
    for byte in bytes {
        // Writing into a string does not fail.
        let _ = write!(token, "{byte:02x}");
    }
    Ok(token)
}

/// What is kept of a token. One round is enough: 256 random bits cannot be guessed, unlike a password.
pub(crate) fn hash_of(token: &str) -> [u8; 32] {
    Sha256::digest(token.as_bytes()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_sha_256() {
        // FIPS 180-4, example "abc".
        let expected = [0xba, 0x78, 0x16, 0xbf, 0x8f, 0x01, 0xcf, 0xea];
        assert_eq!(hash_of("abc")[..8], expected);
    }

    #[test]
    fn tokens_differ() {
        let (one, other) = (new_token().unwrap(), new_token().unwrap());
        assert_ne!(one, other);
        assert_eq!(one.len(), PREFIX.len() + 64);
    }
}
