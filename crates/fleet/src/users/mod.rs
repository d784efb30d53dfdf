//! Who may do what in a plant, and the trail of what was done.

mod token;

use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub(crate) use token::{hash_of, new_token};

/// What a user may do; each role may do what those before it may.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// See states, trends and alarms.
    See,
    /// Acknowledge, shelve and unshelve alarms.
    Acknowledge,
    /// Suppress alarms, make and end users.
    Configure,
}

impl Role {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Role::See => "see",
            Role::Acknowledge => "acknowledge",
            Role::Configure => "configure",
        }
    }
}

/// A word that is no role.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0:?} is no role: use see, acknowledge or configure")]
pub struct RoleError(String);

impl FromStr for Role {
    type Err = RoleError;

    fn from_str(text: &str) -> Result<Self, RoleError> {
        let all = [Role::See, Role::Acknowledge, Role::Configure];
        let found = all.into_iter().find(|role| role.word() == text);
        found.ok_or_else(|| RoleError(text.to_owned()))
    }
}

/// A user.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct User {
    /// Name, 1 to 64 characters.
    pub name: String,
    /// What the user may do.
    pub role: Role,
    /// When the user was made, Unix ms.
    pub made_unix_ms: i64,
    /// Since when the user's token no longer holds, Unix ms.
    pub ended_unix_ms: Option<i64>,
}

/// One line of the trail.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AuditLine {
    /// When, Unix ms.
    pub time_unix_ms: i64,
    /// Who; empty: nobody who is known.
    pub user: String,
    /// What ("acknowledge", "shelve", "user add").
    pub action: String,
    /// On what ("alarm 17", "user eva").
    pub subject: String,
    /// Why, as the user said.
    pub why: String,
    /// What became of it ("done", "refused: wrong role").
    pub outcome: String,
    /// Where it came from, network address.
    pub address: String,
}
