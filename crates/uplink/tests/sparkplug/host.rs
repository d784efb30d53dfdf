//! A host application as the specification describes it: it takes messages in their order and complains about what may not be.

use std::collections::BTreeMap;

use prost::Message as _;
use uplink::sparkplug::{Message, Metric, Payload, Wire};

/// A value with its time.
pub type Known = (u64, Option<Wire>);

/// What a host knows of a node or a device.
#[derive(Default)]
pub struct Thing {
    pub alive: bool,
    names: BTreeMap<u64, String>,
    pub values: BTreeMap<String, Known>,
    /// Values of the past, in the order in which they came.
    pub history: Vec<(String, Known)>,
    /// Live values as they came, with all that was known then.
    pub live: Vec<BTreeMap<String, Known>>,
}

#[derive(Default)]
pub struct Host {
    pub node: Thing,
    pub devices: BTreeMap<String, Thing>,
    next_seq: Option<u64>,
    pub will: Option<u64>,
    pub births: u32,
}

fn long(metric: &Metric) -> u64 {
    match metric.value {
        Some(Wire::Long(value)) => value,
        _ => panic!("no long value: {metric:?}"),
    }
}

impl Thing {
    fn birth(&mut self, metrics: &[Metric], without_alias: &[&str]) {
        self.alive = true;
        self.names.clear();
        self.values.clear();
        for metric in metrics {
            let name = metric.name.clone().expect("a birth names its metrics");
            assert!(
                metric.datatype.is_some() && metric.timestamp.is_some(),
                "{name}"
            );
            assert_eq!(
                metric.value.is_none(),
                metric.is_null == Some(true),
                "{name}"
            );
            assert_ne!(metric.is_historical, Some(true), "{name}");
            if without_alias.contains(&name.as_str()) {
                assert_eq!(metric.alias, None, "{name}");
            } else {
                let alias = metric.alias.expect("an alias");
                assert!(
                    self.names.insert(alias, name.clone()).is_none(),
                    "{alias} twice"
                );
            }
            let known = (metric.timestamp.unwrap_or(0), metric.value.clone());
            assert!(
                self.values.insert(name.clone(), known).is_none(),
                "{name} twice"
            );
        }
    }

    fn data(&mut self, metrics: &[Metric]) {
        assert!(self.alive, "data of what is not alive");
        let mut live = false;
        for metric in metrics {
            assert!(metric.name.is_none() && metric.datatype.is_none());
            let alias = metric.alias.expect("an alias");
            let name = self
                .names
                .get(&alias)
                .expect("an alias of the birth")
                .clone();
            let known = (metric.timestamp.expect("a time"), metric.value.clone());
            if metric.is_historical == Some(true) {
                self.history.push((name, known));
            } else {
                live = true;
                self.values.insert(name, known);
            }
        }
        if live {
            self.live.push(self.values.clone());
        }
    }
}

impl Host {
    /// The broker tells the will, or the node its death.
    pub fn death(&mut self, message: &Message) {
        let payload = Payload::decode(message.payload.as_slice()).expect("a payload");
        assert_eq!(payload.seq, None);
        assert_eq!(payload.metrics.len(), 1);
        assert_eq!(payload.metrics[0].name.as_deref(), Some("bdSeq"));
        assert_eq!(Some(long(&payload.metrics[0])), self.will);
        self.node.alive = false;
        self.devices
            .values_mut()
            .for_each(|device| device.alive = false);
    }

    /// A CONNECT with its will.
    pub fn connect(&mut self, will: &Message) {
        assert_eq!(will.topic, "spBv1.0/plant/NDEATH/gateway");
        assert!(will.at_least_once);
        let payload = Payload::decode(will.payload.as_slice()).expect("a payload");
        let number = long(&payload.metrics[0]);
        if let Some(before) = self.will {
            assert_eq!(
                number,
                (before + 1) % 256,
                "bdSeq goes on by one with each CONNECT"
            );
        }
        self.will = Some(number);
        self.next_seq = None;
    }

    pub fn take(&mut self, message: &Message) {
        assert!(!message.at_least_once, "{}: QoS 0", message.topic);
        let payload = Payload::decode(message.payload.as_slice()).expect("a payload");
        assert!(payload.timestamp.is_some());
        let parts: Vec<&str> = message.topic.split('/').collect();
        assert_eq!(
            (parts[0], parts[1], parts[3]),
            ("spBv1.0", "plant", "gateway")
        );
        let seq = payload.seq.expect("every message but a death has a number");
        if parts[2] == "NBIRTH" {
            assert_eq!(seq, 0);
        } else {
            assert_eq!(Some(seq), self.next_seq, "{}", message.topic);
        }
        self.next_seq = Some((seq + 1) % 256);
        match (parts[2], parts.get(4)) {
            ("NBIRTH", None) => self.node_birth(&payload.metrics),
            ("NDATA", None) => self.node.data(&payload.metrics),
            ("DBIRTH", Some(id)) => {
                assert!(self.node.alive, "a device before its node");
                let device = self.devices.entry((*id).to_owned()).or_default();
                device.birth(&payload.metrics, &[]);
            }
            ("DDATA", Some(id)) => self
                .devices
                .get_mut(*id)
                .expect("born")
                .data(&payload.metrics),
            ("DDEATH", Some(id)) => {
                let device = self.devices.get_mut(*id).expect("born");
                assert!(device.alive, "dead already");
                device.alive = false;
            }
            other => panic!("{other:?} is no message of an edge node"),
        }
        self.no_alias_twice();
    }

    fn node_birth(&mut self, metrics: &[Metric]) {
        self.births += 1;
        self.devices
            .values_mut()
            .for_each(|device| device.alive = false);
        self.node.birth(metrics, &["Node Control/Rebirth"]);
        let bd_seq = self.node.values["bdSeq"].1.clone();
        assert_eq!(bd_seq, self.will.map(Wire::Long), "bdSeq of birth and will");
        let rebirth = self.node.values["Node Control/Rebirth"].1.clone();
        assert_eq!(rebirth, Some(Wire::Boolean(false)));
    }

    fn no_alias_twice(&self) {
        let things = self.devices.values().chain([&self.node]);
        let mut all: Vec<u64> = things
            .filter(|thing| thing.alive)
            .flat_map(|thing| thing.names.keys().copied())
            .collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count, "an alias of two metrics");
    }
}
