//! Sparkplug B, edge node: the gateway is the node, each motor a device (Eclipse Sparkplug 3.0.0).
//!
//! [`Node`] decides what is said; it has no input, no output and no clock. Bytes travel in `crate::mqtt`.

mod device;
mod host;
mod metrics;
mod node;
mod payload;
mod topic;
mod update;
mod value;

pub use metrics::{ALIASES, Group, OF_GATEWAY, OF_MOTOR};
pub use node::{Message, Node, Phase, Present, REBIRTH, Reaction};
pub use payload::{
    MAX_COMMAND_BYTES, Metric, Payload, PayloadError, PropertySet, PropertyValue, Wire,
};
pub use topic::{IdentifierError, Kind, NAMESPACE, Names, check_identifier, state_topic};
pub use update::{Update, alarm_values, info_values, link_values, of_entry, second_values};
pub use value::{Datatype, Definition, Value};
