//! What a person asks for, and what is answered.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::alarms::AlarmAnswer;
use crate::alarm::Action;
use crate::users::{AuditLine, Role};

/// What a person does to an alarm.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "action", rename_all = "snake_case", deny_unknown_fields)]
pub enum ActionRequest {
    /// Takes note.
    Acknowledge {
        /// Why, or what is done about it.
        #[serde(default)]
        why: String,
    },
    /// Sets the alarm aside until a time.
    Shelve {
        /// Why: asked for.
        why: String,
        /// End, Unix ms.
        until_unix_ms: i64,
    },
    /// Ends the shelf.
    Unshelve {
        /// Why.
        #[serde(default)]
        why: String,
    },
    /// Sets the alarm aside while the motor is out of service.
    Suppress {
        /// Why: asked for.
        why: String,
    },
    /// Ends that.
    Unsuppress {
        /// Why.
        #[serde(default)]
        why: String,
    },
}

impl ActionRequest {
    /// The action, why, and the role that may do it.
    pub fn parts(&self) -> (Action, &str, Role) {
        match self {
            Self::Acknowledge { why } => (Action::Acknowledge, why, Role::Acknowledge),
            Self::Shelve { why, until_unix_ms } => (
                Action::Shelve {
                    until_ms: *until_unix_ms,
                },
                why,
                Role::Acknowledge,
            ),
            Self::Unshelve { why } => (Action::Unshelve, why, Role::Acknowledge),
            Self::Suppress { why } => (Action::Suppress, why, Role::Configure),
            Self::Unsuppress { why } => (Action::Unsuppress, why, Role::Configure),
        }
    }
}

/// What became of an action.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ActionAnswer {
    /// Whether something changed; `false`: it was so already.
    pub changed: bool,
    /// The alarm after it; null: it is normal, and nothing changed.
    pub alarm: Option<AlarmAnswer>,
}

/// Lines of the trail, newest first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AuditAnswer {
    /// The lines.
    pub lines: Vec<AuditLine>,
    /// Whether there are more than were asked for.
    pub more: bool,
}

/// Why something is refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Refusal {
    /// What is wrong.
    pub error: String,
    /// What to do about it.
    pub remedy: String,
}
