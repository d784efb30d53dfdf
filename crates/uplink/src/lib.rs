//! What a plant tells others: Sparkplug B over MQTT, metrics of Prometheus, registers of Modbus TCP.
//!
//! [`mqtt::run`] and [`modbus::run`] run beside the gateway and read its store; [`metrics::router`] is a route for a server. What an
//! edge node of Sparkplug says is decided without a network:
//!
//! ```
//! use uplink::sparkplug::{Names, Node, Reaction};
//!
//! let names = Names::new("Hall 3", "gateway-1").unwrap();
//! let mut node = Node::new(names, None, 0, "1.0");
//! let will = node.connect(1_790_000_000_000);
//! assert_eq!(will.topic, "spBv1.0/Hall 3/NDEATH/gateway-1");
//! assert_eq!(node.subscribed(), Reaction::Birth);
//! let births = node.birth(1_790_000_000_000, Vec::new(), Vec::new());
//! assert_eq!(births[0].topic, "spBv1.0/Hall 3/NBIRTH/gateway-1");
//! ```

pub mod metrics;
pub mod modbus;
pub mod mqtt;
pub mod sparkplug;
