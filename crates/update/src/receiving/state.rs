//! How an update stands, as the registers number it.

/// How the update of the program stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u16)]
pub enum UpdateState {
    /// None.
    #[default]
    None = 0,
    /// Pieces of a program were received.
    Receiving = 1,
    /// What was received is being checked.
    Checking = 2,
    /// The loader was asked; the board starts again.
    Asked = 3,
    /// The program that runs is new and has not confirmed itself.
    OnTrial = 4,
    /// The program that runs has confirmed itself.
    Confirmed = 5,
    /// The new program did not confirm itself, and the one before runs again.
    BroughtBack = 6,
    /// The program that was received is not taken.
    Refused = 7,
}

impl UpdateState {
    /// All of them, in the order of their numbers.
    pub const ALL: [UpdateState; 8] = [
        UpdateState::None,
        UpdateState::Receiving,
        UpdateState::Checking,
        UpdateState::Asked,
        UpdateState::OnTrial,
        UpdateState::Confirmed,
        UpdateState::BroughtBack,
        UpdateState::Refused,
    ];

    /// In words.
    pub fn label(self) -> &'static str {
        match self {
            UpdateState::None => "no update",
            UpdateState::Receiving => "receiving a program",
            UpdateState::Checking => "checking it",
            UpdateState::Asked => "starting again to install it",
            UpdateState::OnTrial => "new program on trial",
            UpdateState::Confirmed => "new program confirmed",
            UpdateState::BroughtBack => "program before it brought back",
            UpdateState::Refused => "refused",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_has_its_own_number() {
        for (k, state) in UpdateState::ALL.into_iter().enumerate() {
            assert_eq!(state as usize, k);
        }
    }
}
