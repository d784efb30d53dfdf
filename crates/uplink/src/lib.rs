//! What a plant tells others: Sparkplug B over MQTT, metrics of Prometheus, registers of Modbus TCP.

pub mod metrics;
pub mod modbus;
pub mod mqtt;
pub mod sparkplug;
