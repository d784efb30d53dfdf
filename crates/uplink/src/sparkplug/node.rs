//! The edge node: what it says, when, and what it does with what it is told. No input, no output, no clock.

use std::collections::{BTreeMap, VecDeque};

use super::device::{Teller, stamp};
use super::host::{Host, Turn};
use super::metrics::{Group, OF_GATEWAY, OF_MOTOR};
use super::payload::{Metric, Payload, Wire};
use super::topic::{Kind, Names, state_topic};
use super::update::Update;
use super::value::{Datatype, Definition, Value};

/// Name of the metric by which a host application asks for births.
pub const REBIRTH: &str = "Node Control/Rebirth";

const BD_SEQ: Definition = Definition {
    name: "bdSeq",
    datatype: Datatype::Int64,
    unit: "",
    meaning: "number of the session; the same in birth and death",
};
/// Alias of `bdSeq`: of the gateway's block, before its own metrics.
const BD_SEQ_ALIAS: u64 = 0;
const REBIRTH_METRIC: Definition = Definition {
    name: REBIRTH,
    datatype: Datatype::Boolean,
    unit: "",
    meaning: "written true: all births again",
};
/// Places of `Gateway/RefusedCommands` and `Gateway/ForeignBirths` in their group.
const REFUSED: usize = 2;
const FOREIGN: usize = 3;
/// Most own births that are awaited back from the broker.
const MOST_ECHOES: usize = 16;
/// Most metrics of the past in one message: some 100 seconds of a motor, 40 kB.
const MOST_PAST: usize = 2_400;

/// A message to the broker. None is ever retained.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Its topic.
    pub topic: String,
    /// Its payload.
    pub payload: Vec<u8>,
    /// Whether it is sent with QoS 1 (deaths of the node); others with QoS 0, as the specification asks.
    pub at_least_once: bool,
}

/// What a message from the broker asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Reaction {
    /// Nothing.
    None,
    /// All births, with the present state.
    Birth,
    /// Tell the death, disconnect, and connect again.
    Leave,
    /// Tell this.
    Tell(Message),
}

/// Where a session is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// No session.
    Offline,
    /// Connected; the primary host is not there.
    Waiting,
    /// Births were told.
    Online,
}

/// A motor as it is now, for births.
#[derive(Clone, Debug, PartialEq)]
pub struct Present {
    /// Its identifier.
    pub device: String,
    /// Whether its board answers; `None`: nobody said.
    pub up: Option<bool>,
    /// Its values.
    pub values: Vec<Update>,
}

struct Device {
    teller: Teller,
    up: Option<bool>,
    born: bool,
}

/// An edge node with its devices.
pub struct Node {
    names: Names,
    primary_host: Option<String>,
    host: Host,
    phase: Phase,
    seq: u8,
    bd_seq: u8,
    gateway: Teller,
    version: String,
    refused: u64,
    /// Own births of this session that the broker has not handed back yet.
    echoes: VecDeque<Vec<u8>>,
    foreign: u64,
    devices: BTreeMap<String, Device>,
    blocks: u64,
}

impl Node {
    /// A node without a session. `bd_seq` is that of its first session.
    pub fn new(names: Names, primary_host: Option<String>, bd_seq: u8, version: &str) -> Node {
        Node {
            names,
            primary_host,
            host: Host::default(),
            phase: Phase::Offline,
            seq: 0,
            // `connect` goes on by one.
            bd_seq: bd_seq.wrapping_sub(1),
            gateway: Teller::new(&OF_GATEWAY, 0),
            version: version.to_owned(),
            refused: 0,
            echoes: VecDeque::new(),
            foreign: 0,
            devices: BTreeMap::new(),
            blocks: 1,
        }
    }

    /// Where the session is.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// Number of this session, 0 to 255.
    pub fn bd_seq(&self) -> u8 {
        self.bd_seq
    }

    /// Commands that were refused: writes to anything but [`REBIRTH`], and what is no command.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Births under this node's name that it has not said: another gateway has the same name, or somebody plays old births again.
    pub fn foreign_births(&self) -> u64 {
        self.foreign
    }

    /// A new session begins: the will that goes with its CONNECT.
    pub fn connect(&mut self, now_ms: i64) -> Message {
        self.end();
        self.bd_seq = self.bd_seq.wrapping_add(1);
        self.echoes.clear();
        self.death(now_ms)
    }

    /// Topics to subscribe to, with QoS 1, before anything is said.
    pub fn subscriptions(&self) -> Vec<String> {
        let mut topics = vec![
            self.names.of_node(Kind::NCommand),
            self.names.of_device(Kind::DCommand, "+"),
            self.names.of_node(Kind::NBirth),
        ];
        topics.extend(self.primary_host.as_deref().map(state_topic));
        topics
    }

    /// The broker has taken the subscriptions.
    pub fn subscribed(&mut self) -> Reaction {
        self.phase = Phase::Waiting;
        if self.primary_host.is_none() || self.host.is_online() {
            return Reaction::Birth;
        }
        Reaction::None
    }

    /// The session ended, by either side.
    pub fn end(&mut self) {
        self.phase = Phase::Offline;
        self.host.forget();
        for device in self.devices.values_mut() {
            device.born = false;
        }
    }

    /// The death of this session, before an intended disconnect.
    pub fn death(&self, now_ms: i64) -> Message {
        let bd_seq = Value::Large(u64::from(self.bd_seq));
        let metric = Metric {
            alias: None,
            ..BD_SEQ.born(None, stamp(now_ms), Some(&bd_seq))
        };
        let payload = Payload {
            timestamp: Some(stamp(now_ms)),
            metrics: vec![metric],
            ..Payload::default()
        };
        Message {
            topic: self.names.of_node(Kind::NDeath),
            payload: payload.to_bytes(),
            at_least_once: true,
        }
    }

    /// All births: of the node, and of each device whose board answers.
    pub fn birth(&mut self, now_ms: i64, plant: Vec<Update>, motors: Vec<Present>) -> Vec<Message> {
        self.phase = Phase::Online;
        self.seq = 0;
        self.gateway.renew(now_ms, plant);
        self.gateway.keep(Update {
            group: Group::Gateway,
            time_ms: now_ms,
            values: vec![
                Some(Value::Text(self.version.clone())),
                Some(Value::Large(motors.len() as u64)),
                Some(Value::Large(self.refused)),
                Some(Value::Large(self.foreign)),
            ],
        });
        let birth = self.node_birth(now_ms);
        self.await_echo(&birth);
        let mut messages = vec![birth];
        for motor in motors {
            let device = self.device(&motor.device);
            device.up = motor.up;
            device.born = false;
            device.teller.renew(now_ms, motor.values);
            if motor.up == Some(true) {
                messages.push(self.device_birth(&motor.device, now_ms));
            }
        }
        messages
    }

    fn node_birth(&mut self, now_ms: i64) -> Message {
        let at_ms = stamp(now_ms);
        let bd_seq = Value::Large(u64::from(self.bd_seq));
        let mut metrics = vec![
            BD_SEQ.born(Some(BD_SEQ_ALIAS), at_ms, Some(&bd_seq)),
            REBIRTH_METRIC.born(None, at_ms, Some(&Value::Boolean(false))),
        ];
        metrics.extend(self.gateway.birth(now_ms));
        let topic = self.names.of_node(Kind::NBirth);
        self.message(topic, now_ms, metrics)
    }

    fn device_birth(&mut self, id: &str, now_ms: i64) -> Message {
        let device = self.device(id);
        device.born = true;
        let metrics = device.teller.birth(now_ms);
        let topic = self.names.of_device(Kind::DBirth, id);
        self.message(topic, now_ms, metrics)
    }

    fn device_death(&mut self, id: &str, now_ms: i64) -> Message {
        self.device(id).born = false;
        let topic = self.names.of_device(Kind::DDeath, id);
        self.message(topic, now_ms, Vec::new())
    }

    fn device_data(&mut self, id: &str, now_ms: i64, metrics: Vec<Metric>) -> Message {
        let topic = self.names.of_device(Kind::DData, id);
        self.message(topic, now_ms, metrics)
    }

    /// A message with the next sequence number: 0 to 255, and 0 again.
    fn message(&mut self, topic: String, now_ms: i64, metrics: Vec<Metric>) -> Message {
        let payload = Payload {
            timestamp: Some(stamp(now_ms)),
            metrics,
            seq: Some(u64::from(self.seq)),
            ..Payload::default()
        };
        self.seq = self.seq.wrapping_add(1);
        Message {
            topic,
            payload: payload.to_bytes(),
            at_least_once: false,
        }
    }

    fn device(&mut self, id: &str) -> &mut Device {
        let blocks = &mut self.blocks;
        self.devices.entry(id.to_owned()).or_insert_with(|| {
            let teller = Teller::new(&OF_MOTOR, *blocks);
            *blocks += 1;
            Device {
                teller,
                up: None,
                born: false,
            }
        })
    }

    /// What entries of the store become, in their order; `None` is the plant as a whole. Nothing unless births were told.
    pub fn tell(&mut self, now_ms: i64, entries: Vec<(Option<String>, Update)>) -> Vec<Message> {
        if self.phase != Phase::Online {
            return Vec::new();
        }
        let mut out = Batch::default();
        for (device, update) in entries {
            match device {
                None => self.tell_of_plant(now_ms, update, &mut out),
                Some(id) => self.tell_of_motor(now_ms, &id, update, &mut out),
            }
        }
        for id in out.past.keys().cloned().collect::<Vec<_>>() {
            self.flush(now_ms, &id, &mut out);
        }
        self.end_visits(now_ms, &mut out.messages);
        out.messages
    }

    fn tell_of_plant(&mut self, now_ms: i64, update: Update, out: &mut Batch) {
        let metrics = if self.gateway.is_past(&update) {
            self.gateway.past(&update)
        } else {
            self.gateway.data(update)
        };
        let topic = self.names.of_node(Kind::NData);
        out.messages.push(self.message(topic, now_ms, metrics));
    }

    fn tell_of_motor(&mut self, now_ms: i64, id: &str, update: Update, out: &mut Batch) {
        if !self.device(id).born {
            out.messages.push(self.device_birth(id, now_ms));
        }
        let device = self.device(id);
        if device.teller.is_past(&update) {
            let past = out.past.entry(id.to_owned()).or_default();
            past.extend(device.teller.past(&update));
            if past.len() >= MOST_PAST {
                self.flush(now_ms, id, out);
            }
            return;
        }
        match (update.group, update.values.first()) {
            (Group::Link, Some(Some(Value::Boolean(up)))) => device.up = Some(*up),
            (Group::Second, _) => _ = device.up.get_or_insert(true),
            _ => {}
        }
        let metrics = device.teller.data(update);
        self.flush(now_ms, id, out);
        out.messages.push(self.device_data(id, now_ms, metrics));
        if self.device(id).up == Some(false) {
            out.messages.push(self.device_death(id, now_ms));
        }
    }

    /// Sends what was collected of a device's past.
    fn flush(&mut self, now_ms: i64, id: &str, out: &mut Batch) {
        if let Some(metrics) = out.past.remove(id) {
            out.messages.push(self.device_data(id, now_ms, metrics));
        }
    }

    /// Devices whose boards do not answer were born for their past only.
    fn end_visits(&mut self, now_ms: i64, messages: &mut Vec<Message>) {
        let visits = self
            .devices
            .iter()
            .filter(|(_, d)| d.born && d.up != Some(true));
        let ids: Vec<String> = visits.map(|(id, _)| id.clone()).collect();
        for id in ids {
            messages.push(self.device_death(&id, now_ms));
        }
    }

    /// Takes a message from the broker.
    pub fn take(&mut self, now_ms: i64, topic: &str, payload: &[u8]) -> Reaction {
        if self.primary_host.as_deref().map(state_topic).as_deref() == Some(topic) {
            return self.take_state(payload);
        }
        let rebirth = if topic == self.names.of_node(Kind::NCommand) {
            self.take_command(payload)
        } else if topic == self.names.of_node(Kind::NBirth) {
            self.take_birth(payload);
            false
        } else {
            self.refused += self.names.commanded(topic).map_or(0, |_| writes(payload));
            false
        };
        match (self.phase, rebirth) {
            (Phase::Online, true) => Reaction::Birth,
            (Phase::Online, false) => self.told_strangers(now_ms),
            _ => Reaction::None,
        }
    }

    fn take_state(&mut self, payload: &[u8]) -> Reaction {
        match (self.host.take(payload), self.phase) {
            (Turn::Came, Phase::Waiting) => Reaction::Birth,
            (Turn::Went, Phase::Online) => Reaction::Leave,
            _ => Reaction::None,
        }
    }

    /// Whether a command asks for births; everything else in it is refused.
    fn take_command(&mut self, payload: &[u8]) -> bool {
        let Ok(payload) = Payload::from_bytes(payload) else {
            self.refused += 1;
            return false;
        };
        let (births, others): (Vec<_>, Vec<_>) = payload.metrics.iter().partition(|m| asks(m));
        self.refused += others.len() as u64;
        !births.is_empty()
    }

    /// The broker hands back what is said on the own topic.
    fn await_echo(&mut self, birth: &Message) {
        if self.echoes.len() == MOST_ECHOES {
            self.echoes.pop_front();
        }
        self.echoes.push_back(birth.payload.clone());
    }

    /// A birth of this node: the own one once, or a stranger's.
    fn take_birth(&mut self, payload: &[u8]) {
        match self.echoes.iter().position(|own| own == payload) {
            Some(place) => drop(self.echoes.remove(place)),
            None => self.foreign += 1,
        }
    }

    /// Tells the counts of what strangers did, where they changed.
    fn told_strangers(&mut self, now_ms: i64) -> Reaction {
        let counts = [(REFUSED, self.refused), (FOREIGN, self.foreign)];
        let mut metrics = Vec::new();
        for (place, count) in counts {
            let value = Value::Large(count);
            if self.gateway.value(Group::Gateway, place) != Some(&value) {
                metrics.push(self.gateway.change(Group::Gateway, place, now_ms, value));
            }
        }
        if metrics.is_empty() {
            return Reaction::None;
        }
        let topic = self.names.of_node(Kind::NData);
        Reaction::Tell(self.message(topic, now_ms, metrics))
    }
}

fn asks(metric: &Metric) -> bool {
    metric.name.as_deref() == Some(REBIRTH) && metric.value == Some(Wire::Boolean(true))
}

/// How many writes a command holds; what is no command counts as one.
fn writes(payload: &[u8]) -> u64 {
    Payload::from_bytes(payload).map_or(1, |payload| payload.metrics.len().max(1) as u64)
}

/// Messages of one call, and what is collected of each device's past.
#[derive(Default)]
struct Batch {
    messages: Vec<Message>,
    past: BTreeMap<String, Vec<Metric>>,
}
