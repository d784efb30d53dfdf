//! Why an answer is missing.

use std::time::Duration;

/// Exceptions of the protocol that a gateway acts on.
const FUNCTION: u8 = 1;
const ADDRESS: u8 = 2;
const BUSY: u8 = 6;

/// Why an answer is missing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum BusError {
    /// The link itself: nobody on it can be asked.
    #[error("{0}")]
    Link(String),
    /// Nothing came from this board.
    #[error("no answer from unit {unit} within {} s: is it powered, and is this its address?", within.as_secs_f64())]
    Silent {
        /// Who was asked.
        unit: u8,
        /// For how long.
        within: Duration,
    },
    /// Something came that is no answer.
    #[error("the answer of unit {0} is damaged or of another device")]
    Damaged(u8),
    /// The board refuses.
    #[error("unit {unit} refuses function {function} with exception {code}{}", remedy(*code))]
    Refused {
        /// Who was asked.
        unit: u8,
        /// For what.
        function: u8,
        /// The protocol's number.
        code: u8,
    },
}

fn remedy(code: u8) -> &'static str {
    match code {
        ADDRESS => {
            ": its program does not keep seconds yet, or it is another device; flash it with the program of this version"
        }
        0x0A | 0x0B => {
            ": the converter before it gets no answer; is the board powered, and is this its address?"
        }
        _ => "",
    }
}

impl BusError {
    /// Whether the board only asks to be asked again later.
    pub fn is_busy(&self) -> bool {
        matches!(self, BusError::Refused { code: BUSY, .. })
    }

    /// Whether the board does not know what it was asked for.
    pub fn is_unknown(&self) -> bool {
        matches!(
            self,
            BusError::Refused {
                code: FUNCTION | ADDRESS,
                ..
            }
        )
    }

    /// Whether nobody else on the link can be asked either.
    pub fn is_of_link(&self) -> bool {
        matches!(self, BusError::Link(_))
    }
}
