//! What a command may print to.

/// Where lines go.
#[derive(Clone, Copy)]
pub struct Terminal {
    /// Results.
    pub say: fn(&str),
    /// What happens meanwhile.
    pub complain: fn(&str),
}
