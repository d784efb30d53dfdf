//! Why windows of a replay were not judged, and which way the field turned: told apart by their type, read as words.

use std::fmt;

use monitor::NotJudged;
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::words;

/// Why a window was not judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unjudged {
    /// What the core says.
    ByCore(NotJudged),
    /// No motor file was given: residuals have no parameters, and the core was told that there is no speed.
    NoMotorFile,
}

impl fmt::Display for Unjudged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unjudged::ByCore(reason) => f.write_str(&words::not_judged(*reason)),
            Unjudged::NoMotorFile => f.write_str("no motor file was given (--motor M)"),
        }
    }
}

impl Serialize for Unjudged {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// How many windows one reason kept from being judged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NotJudgedShare {
    /// The reason.
    #[schemars(with = "String")]
    pub reason: Unjudged,
    /// Windows.
    pub windows: u64,
}

impl NotJudgedShare {
    /// Whether the motor was not running then, or only just supplied.
    pub(crate) fn is_idle(&self) -> bool {
        let Unjudged::ByCore(reason) = self.reason else {
            return false;
        };
        matches!(
            reason,
            NotJudged::NotLocked
                | NotJudged::Settling
                | NotJudged::Supply(_)
                | NotJudged::NoLoadCurrent
        )
    }
}

/// Reasons, counted.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reasons(Vec<NotJudgedShare>);

impl Reasons {
    pub(crate) fn add(&mut self, reason: NotJudged) {
        let reason = Unjudged::ByCore(reason);
        match self.0.iter_mut().find(|known| known.reason == reason) {
            Some(known) => known.windows += 1,
            None => self.0.push(NotJudgedShare { reason, windows: 1 }),
        }
    }

    /// Most frequent first; equals by their words.
    pub(crate) fn ranked(mut self) -> Vec<NotJudgedShare> {
        let order =
            |share: &NotJudgedShare| (std::cmp::Reverse(share.windows), share.reason.to_string());
        self.0.sort_by_cached_key(order);
        self.0
    }
}

/// How the field turned in the windows of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Direction {
    /// Phases a, b, c.
    Forwards,
    /// Phases a, c, b.
    Backwards,
    /// First one, then the other.
    Both,
}

impl Direction {
    /// Whether some windows were judged as the motor's mirror image.
    pub fn is_mirrored(self) -> bool {
        self != Direction::Forwards
    }
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Direction::Forwards => "the field turns forwards",
            Direction::Backwards => {
                "the field turns backwards, phases a, c, b: the motor was judged as its mirror image"
            }
            Direction::Both => {
                "the field turns in both directions: where it turns backwards the motor was judged as its mirror image"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_ranked_by_windows_and_then_by_words() {
        let mut reasons = Reasons::default();
        for reason in [NotJudged::Transient, NotJudged::Noise, NotJudged::Settling] {
            reasons.add(reason);
        }
        reasons.add(NotJudged::Settling);
        let ranked: Vec<_> = reasons.ranked().iter().map(|share| share.reason).collect();
        let expected = [NotJudged::Settling, NotJudged::Noise, NotJudged::Transient];
        assert_eq!(ranked, expected.map(Unjudged::ByCore));
    }
}
