//! Recordings that cannot be judged.

/// Why a recording cannot be judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsupported {
    /// What is missing or wrong.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl Unsupported {
    pub(crate) fn new(reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
            remedy: remedy.into(),
        }
    }
}
