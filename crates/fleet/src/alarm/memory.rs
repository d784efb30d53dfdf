//! What a desk knows beside its alarms.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::change::AlarmCause;
use super::flood::Flood;
use super::read::Details;
use crate::motor::MotorId;

/// A condition whose delay runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Pending {
    pub motor: MotorId,
    pub cause: AlarmCause,
    pub on: bool,
    pub since_ms: i64,
    pub details: Details,
}

/// What a desk knows beside its alarms: running delays, recent alarms. It is stored with every change.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// Number of the newest alarm.
    pub(super) last: u64,
    #[serde(with = "listed")]
    pub(super) pending: BTreeMap<(MotorId, AlarmCause), Pending>,
    pub(super) flood: Flood,
}

/// A map whose keys are no text, as a list.
mod listed {
    use super::{AlarmCause, BTreeMap, MotorId, Pending};
    use serde::{Deserialize, Deserializer, Serializer};

    type Map = BTreeMap<(MotorId, AlarmCause), Pending>;

    pub fn serialize<S: Serializer>(map: &Map, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(map.values())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Map, D::Error> {
        let list = Vec::<Pending>::deserialize(deserializer)?;
        Ok(list
            .into_iter()
            .map(|p| ((p.motor.clone(), p.cause), p))
            .collect())
    }
}
