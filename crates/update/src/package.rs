//! What goes over the line: the program, then its signature.

use crate::key::{PublicKey, SIGNATURE_BYTES};
use crate::refusal::Refusal;
use crate::seal::Seal;

/// Checks everything: seal, board, version, checksum, signature. `package` may be longer; `running` is the seal of the
/// program that runs, where it has one.
///
/// # Errors
/// Why the program is not taken.
pub fn check(package: &[u8], running: Option<Seal>, key: &PublicKey) -> Result<Seal, Refusal> {
    let seal = Seal::read(package)?;
    seal.may_follow(running)?;
    let whole = package.split_at_checked(seal.length as usize);
    let (program, rest) = whole.ok_or(Refusal::Incomplete)?;
    let signature = rest.first_chunk::<SIGNATURE_BYTES>();
    seal.check(program)?;
    key.verify(program, signature.ok_or(Refusal::Incomplete)?)?;
    Ok(seal)
}
