//! Who a person is to a plant, and what that person may do.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What a person may do. Each role may do what those before it may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// See motors, alarms and history.
    See,
    /// Acknowledge and shelve alarms.
    Acknowledge,
    /// Take motors out of service, and read the audit trail.
    Configure,
}

impl Role {
    /// All of them, the least first.
    pub const ALL: [Role; 3] = [Role::See, Role::Acknowledge, Role::Configure];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Role::See => "see",
            Role::Acknowledge => "acknowledge",
            Role::Configure => "configure",
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Role {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Role::ALL.into_iter().find(|role| role.name() == text);
        found
            .ok_or_else(|| format!("\"{text}\" is not a role: write see, acknowledge or configure"))
    }
}

/// A person who is known to a plant.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct User {
    /// Name, as it stands in the audit trail.
    pub name: String,
    /// What the person may do.
    pub role: Role,
}
