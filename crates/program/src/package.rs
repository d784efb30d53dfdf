//! Packages: a program and the signature behind it, as they go over the line.

use std::path::Path;

use update::{BOARD_TYPE, PublicKey, Refusal, SIGNATURE_BYTES, Seal, SecretKey};

use crate::error::{self, Error};
use crate::key_file::{Half, KeyFile};

/// A program whose seal holds, for this board, with a signature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    bytes: Vec<u8>,
    seal: Seal,
}

impl Package {
    /// Signs a program.
    ///
    /// # Errors
    /// It is no sealed program for this board.
    pub fn sign(program: Vec<u8>, key: &SecretKey) -> Result<Self, Refusal> {
        let seal = Seal::read(&program)?;
        let signature = key.sign(&program);
        let mut bytes = program;
        bytes.extend(signature);
        Package::of_bytes(bytes, seal)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, is no package, damaged, or for another board.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let bytes = error::read(file, "name a package that `drivemon board package` made")?;
        let package = Seal::read(&bytes).and_then(|seal| Package::of_bytes(bytes, seal));
        package.map_err(|refusal| match refusal {
            Refusal::Checksum | Refusal::Incomplete => Error::new(
                file,
                format!("is damaged: {refusal}"),
                "copy it again, or make it again with `drivemon board package`",
            ),
            Refusal::Board => Error::new(
                file,
                "is a program for another board",
                "name a package for the STM32G474RE of docs/wiring.md",
            ),
            _ => Error::new(
                file,
                "is no package of a program",
                "make one with `drivemon board package ELF --key FILE -o FILE.dmu`",
            ),
        })
    }

    fn of_bytes(bytes: Vec<u8>, seal: Seal) -> Result<Self, Refusal> {
        if seal.board != BOARD_TYPE {
            return Err(Refusal::Board);
        }
        // Exactly the program and its signature: one byte more is another file.
        if bytes.len() != seal.length as usize + SIGNATURE_BYTES {
            return Err(Refusal::Incomplete);
        }
        seal.check(&bytes)?;
        Ok(Package { bytes, seal })
    }

    /// What goes over the line and into a file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What the program says of itself.
    pub fn seal(&self) -> Seal {
        self.seal
    }

    /// Whether the signature was made with the secret half of `key`.
    pub fn is_signed_with(&self, key: &PublicKey) -> bool {
        let (program, signature) = self.bytes.split_at(self.seal.length as usize);
        let signature = signature.first_chunk::<SIGNATURE_BYTES>();
        signature.is_some_and(|signature| key.verify(program, signature).is_ok())
    }

    /// Whether it was signed with the demo key, which everybody has.
    pub fn is_demo(&self) -> bool {
        self.is_signed_with(&KeyFile::demo(Half::Public).public())
    }
}

#[cfg(test)]
mod tests;
