//! The two halves of a key (Ed25519, RFC 8032).

use crate::refusal::Refusal;

/// Bytes of a signature.
pub const SIGNATURE_BYTES: usize = 64;

/// What a loader checks signatures with. Everybody may know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PublicKey(pub [u8; 32]);

impl PublicKey {
    /// Whether `signature` was made of `message` with the secret half.
    ///
    /// # Errors
    /// [`Refusal::Signature`].
    pub fn verify(&self, message: &[u8], signature: &[u8; SIGNATURE_BYTES]) -> Result<(), Refusal> {
        let key = salty::PublicKey::try_from(&self.0).map_err(|_| Refusal::Signature)?;
        let verified = key.verify(message, &salty::Signature::from(signature));
        verified.map_err(|_| Refusal::Signature)
    }
}

/// What programs are signed with. It stays with its owner.
pub struct SecretKey(salty::Keypair);

impl SecretKey {
    /// From 32 random bytes.
    pub fn from_seed(seed: [u8; 32]) -> Self {
        SecretKey(salty::Keypair::from(&seed))
    }

    /// The half that the loader gets.
    pub fn public(&self) -> PublicKey {
        PublicKey(*self.0.public.as_bytes())
    }

    /// Signs a message.
    pub fn sign(&self, message: &[u8]) -> [u8; SIGNATURE_BYTES] {
        self.0.sign(message).to_bytes()
    }
}
