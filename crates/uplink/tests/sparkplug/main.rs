//! The edge node under any order of what can happen to it, seen by a host application that is not ours.

mod broker;
mod document;
mod host;

use std::collections::BTreeMap;

use fleet::{BoardEvent, Entry, Link, Second};
use host::Host;
use proptest::prelude::*;
use uplink::sparkplug::{
    Group, Message, Metric, Names, Node, Payload, Phase, Present, REBIRTH, Reaction, Update, Wire,
    link_values, of_entry, second_values,
};

/// What can happen.
#[derive(Clone, Debug)]
enum Happening {
    Second { motor: u8, speed: u8 },
    Event { motor: u8 },
    Link { motor: u8, up: bool },
    Tell { most: u8 },
    Rebirth,
    OtherCommand,
    Rubbish(Vec<u8>),
    HostState { online: bool, step: i8 },
    LineBreaks,
    Leave,
}

fn happening() -> impl Strategy<Value = Happening> {
    prop_oneof![
        8 => (0..4u8, any::<u8>()).prop_map(|(motor, speed)| Happening::Second { motor, speed }),
        2 => (0..4u8).prop_map(|motor| Happening::Event { motor }),
        2 => (0..4u8, any::<bool>()).prop_map(|(motor, up)| Happening::Link { motor, up }),
        6 => (1..40u8).prop_map(|most| Happening::Tell { most }),
        1 => Just(Happening::Rebirth),
        1 => Just(Happening::OtherCommand),
        1 => prop::collection::vec(any::<u8>(), 0..40).prop_map(Happening::Rubbish),
        2 => (any::<bool>(), -2..3i8).prop_map(|(online, step)| Happening::HostState { online, step }),
        1 => Just(Happening::LineBreaks),
        1 => Just(Happening::Leave),
    ]
}

/// A plant: what is stored, what the broker has taken, and how its motors are now.
struct Plant {
    node: Node,
    host: Host,
    waits_for_host: bool,
    host_online: bool,
    /// Time of the newest STATE that counted; 0: none yet.
    host_time: u64,
    now_ms: i64,
    stored: Vec<(String, Entry)>,
    cursor: usize,
    seconds: BTreeMap<String, Second>,
    links: BTreeMap<String, Link>,
    events: BTreeMap<String, u32>,
    commands: u64,
}

const HOST: &str = "spBv1.0/STATE/scada";

impl Plant {
    fn new(waits_for_host: bool) -> Plant {
        let names = Names::new("plant", "gateway").expect("identifiers");
        let primary = waits_for_host.then(|| "scada".to_owned());
        Plant {
            node: Node::new(names, primary, 250, "1.2.3"),
            host: Host::default(),
            waits_for_host,
            host_online: false,
            host_time: 0,
            now_ms: 1_790_000_000_000,
            stored: Vec::new(),
            cursor: 0,
            seconds: BTreeMap::new(),
            links: BTreeMap::new(),
            events: BTreeMap::new(),
            commands: 0,
        }
    }

    fn connect(&mut self) {
        let will = self.node.connect(self.now_ms);
        self.host.connect(&will);
        let reaction = self.node.subscribed();
        self.react(reaction);
        // The broker keeps the last STATE and hands it over.
        if self.waits_for_host && self.host_online {
            self.state(true, self.host_time);
        }
    }

    fn state(&mut self, online: bool, timestamp: u64) {
        let text = format!("{{\"online\":{online},\"timestamp\":{timestamp}}}");
        let reaction = self.node.take(self.now_ms, HOST, text.as_bytes());
        self.react(reaction);
    }

    fn react(&mut self, reaction: Reaction) {
        match reaction {
            Reaction::None => {}
            Reaction::Tell(message) => self.take(&[message]),
            Reaction::Birth => {
                let motors = self.present();
                let messages = self.node.birth(self.now_ms, Vec::new(), motors);
                self.take(&messages);
            }
            Reaction::Leave => {
                self.host.death(&self.node.death(self.now_ms));
                self.node.end();
                self.connect();
            }
        }
    }

    fn take(&mut self, messages: &[Message]) {
        assert!(
            !self.waits_for_host || self.host_online,
            "said although the host is away"
        );
        messages.iter().for_each(|message| self.host.take(message));
    }

    fn present(&self) -> Vec<Present> {
        let of = |id: &String| {
            let mut values = Vec::new();
            let update = |group, time_ms, values| Update {
                group,
                time_ms,
                values,
            };
            if let Some(second) = self.seconds.get(id) {
                values.push(update(Group::Second, second.time_ms, second_values(second)));
            }
            if let Some(link) = self.links.get(id) {
                values.push(update(Group::Link, link.time_ms, link_values(link)));
            }
            Present {
                device: id.clone(),
                up: self.links.get(id).map(|link| link.up),
                values,
            }
        };
        (0..4).map(motor).map(|id| of(&id)).collect()
    }

    fn store(&mut self, id: String, entry: Entry) {
        self.stored.push((id, entry));
    }

    /// What is sent is taken by the broker, as long as the line holds.
    fn tell(&mut self, most: usize) {
        if self.node.phase() != Phase::Online {
            assert!(self.node.tell(self.now_ms, Vec::new()).is_empty());
            return;
        }
        let entries: Vec<_> = self.stored[self.cursor..]
            .iter()
            .take(most)
            .cloned()
            .collect();
        self.cursor += entries.len();
        let updates = entries
            .iter()
            .map(|(id, entry)| (Some(id.clone()), of_entry(entry)));
        let messages = self.node.tell(self.now_ms, updates.collect());
        self.take(&messages);
    }

    fn happen(&mut self, happening: Happening) {
        self.now_ms += 250;
        match happening {
            Happening::Second { motor: k, speed } => {
                let before = self
                    .seconds
                    .get(&motor(k))
                    .map_or(0, |second| second.number);
                let second = Second {
                    start: 1,
                    number: before + 1,
                    time_ms: self.now_ms,
                    speed_rpm: (speed > 20).then_some(f32::from(speed / 64)),
                    ..Second::default()
                };
                self.seconds.insert(motor(k), second.clone());
                self.store(motor(k), Entry::Second(second));
            }
            Happening::Event { motor: k } => {
                let number = self.events.entry(motor(k)).or_default();
                *number += 1;
                let event = BoardEvent {
                    number: *number,
                    time_ms: self.now_ms,
                    cause: 3,
                    times: 1,
                    values: [12, 900],
                };
                self.store(motor(k), Entry::Event(event));
            }
            Happening::Link { motor: k, up } => {
                let link = Link {
                    up,
                    time_ms: self.now_ms,
                    why: String::new(),
                };
                self.links.insert(motor(k), link.clone());
                self.store(motor(k), Entry::Link(link));
            }
            Happening::Tell { most } => self.tell(usize::from(most)),
            Happening::Rebirth => self.command(command(REBIRTH, Wire::Boolean(true))),
            Happening::OtherCommand => {
                self.commands += 1;
                self.command(command("Speed", Wire::Float(1.0)));
            }
            Happening::Rubbish(bytes) => self.command(bytes),
            Happening::HostState { online, step } => self.host_says(online, step),
            Happening::LineBreaks => {
                // The broker tells the will of the session.
                self.node.end();
                self.connect();
            }
            Happening::Leave => self.react(Reaction::Leave),
        }
    }

    fn command(&mut self, payload: Vec<u8>) {
        let topic = "spBv1.0/plant/NCMD/gateway";
        let births = self.host.births;
        let asked = Payload::from_bytes(&payload).is_ok_and(|payload| {
            let asks = |m: &Metric| {
                m.name.as_deref() == Some(REBIRTH) && m.value == Some(Wire::Boolean(true))
            };
            payload.metrics.iter().any(asks)
        });
        let online = self.node.phase() == Phase::Online;
        let reaction = self.node.take(self.now_ms, topic, &payload);
        self.react(reaction);
        assert_eq!(self.host.births - births, u32::from(asked && online));
    }

    fn host_says(&mut self, online: bool, step: i8) {
        let known = self.host_time.max(100);
        let time = known.saturating_add_signed(i64::from(step));
        // The first one counts, whatever its time.
        if time >= self.host_time {
            self.host_online = online;
            self.host_time = time;
        }
        if self.waits_for_host {
            self.state(online, time);
            assert_eq!(self.node.phase() == Phase::Online, self.host_online);
        }
    }
}

fn motor(k: u8) -> String {
    format!("pump-{k}")
}

fn command(name: &str, value: Wire) -> Vec<u8> {
    let metric = Metric {
        name: Some(name.to_owned()),
        value: Some(value),
        ..Metric::default()
    };
    let payload = Payload {
        timestamp: Some(1),
        metrics: vec![metric],
        ..Payload::default()
    };
    payload.to_bytes()
}

/// Every second that was stored is at the host: in its history, or live with all its values, or told by a birth.
fn nothing_is_missing(plant: &Plant) {
    for (id, entry) in &plant.stored {
        let Entry::Second(second) = entry else {
            continue;
        };
        let device = &plant.host.devices[id];
        let at = second.time_ms as u64;
        let speed = second.speed_rpm.map(Wire::Float);
        let past = device
            .history
            .iter()
            .filter(|(name, known)| name == "Speed" && known.0 == at)
            .map(|(_, known)| &known.1);
        // A birth without a second yet has the time of the birth and no number.
        let number = (at, Some(Wire::Long(u64::from(second.number))));
        let live = device
            .live
            .iter()
            .filter(|values| values["Second/Number"] == number)
            .map(|values| &values["Speed"].1);
        let found: Vec<_> = past.chain(live).collect();
        assert!(
            !found.is_empty(),
            "{id}: second {} is missing",
            second.number
        );
        assert!(
            found.iter().all(|value| **value == speed),
            "{id}: {found:?}, not {speed:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happens_a_host_understands_it(
        waits_for_host in any::<bool>(),
        happenings in prop::collection::vec(happening(), 1..120),
    ) {
        let mut plant = Plant::new(waits_for_host);
        plant.connect();
        happenings.into_iter().for_each(|happening| plant.happen(happening));
        prop_assert!(plant.node.refused() >= plant.commands);
        // The host comes back, and everything is told.
        plant.host_says(true, 1);
        while plant.cursor < plant.stored.len() {
            plant.tell(7);
        }
        nothing_is_missing(&plant);
        // At the end the host knows each motor as it is, if its board answers.
        for (id, device) in plant.host.devices.iter().filter(|(_, device)| device.alive) {
            if let Some(second) = plant.seconds.get(id) {
                let number = Some(Wire::Long(u64::from(second.number)));
                prop_assert_eq!(&device.values["Second/Number"].1, &number, "{}", id);
                prop_assert_eq!(&device.values["Speed"].1, &second.speed_rpm.map(Wire::Float));
            }
        }
        for (id, link) in &plant.links {
            let alive = plant.host.devices.get(id).is_some_and(|device| device.alive);
            prop_assert_eq!(alive, link.up, "{}", id);
        }
    }
}

/// 300 messages in one session: the number goes from 255 to 0, and the host sees no hole.
#[test]
fn the_sequence_number_goes_round() {
    let mut plant = Plant::new(false);
    plant.connect();
    for _ in 0..300 {
        plant.happen(Happening::Second {
            motor: 0,
            speed: 100,
        });
        plant.tell(1);
    }
    nothing_is_missing(&plant);
    assert!(plant.host.devices["pump-0"].live.len() >= 299);
}

/// A birth that was overheard and is played again, and one of a second gateway with the same name, change nothing; they are counted
/// and told. The own birth comes back from the broker once.
#[test]
fn births_of_strangers_are_counted() {
    let mut plant = Plant::new(false);
    plant.connect();
    let topic = "spBv1.0/plant/NBIRTH/gateway";
    let births = plant.node.birth(plant.now_ms, Vec::new(), Vec::new());
    plant.take(&births);
    let own = births[0].payload.clone();
    let (seq, phase) = (births.len(), plant.node.phase());
    assert_eq!(plant.node.take(1, topic, &own), Reaction::None);
    assert_eq!(plant.node.foreign_births(), 0);
    for (count, stranger) in [(1, &own[..]), (2, b"no birth at all")] {
        let reaction = plant.node.take(1, topic, stranger);
        plant.react(reaction);
        assert_eq!(plant.node.foreign_births(), count);
        let known = &plant.host.node.values["Gateway/ForeignBirths"];
        assert_eq!(known.1, Some(Wire::Long(count)));
    }
    assert_eq!((plant.node.phase(), seq), (phase, 1));
    plant.happen(Happening::Second {
        motor: 0,
        speed: 100,
    });
    plant.tell(10);
    nothing_is_missing(&plant);
}

/// A command to a device, and one that is too long, are refused, counted and told.
#[test]
fn commands_are_refused_and_counted() {
    let mut plant = Plant::new(false);
    plant.connect();
    let write = command("Speed", Wire::Float(1.0));
    let reaction = plant
        .node
        .take(1, "spBv1.0/plant/DCMD/gateway/pump-0", &write);
    plant.react(reaction);
    let reaction = plant
        .node
        .take(1, "spBv1.0/plant/NCMD/gateway", &[0; 70_000]);
    plant.react(reaction);
    assert_eq!(plant.node.refused(), 2);
    let known = &plant.host.node.values["Gateway/RefusedCommands"];
    assert_eq!(known.1, Some(Wire::Long(2)));
    // Somebody else's topics are nobody's command here.
    plant
        .node
        .take(1, "spBv1.0/plant/DCMD/other/pump-0", &write);
    assert_eq!(plant.node.refused(), 2);
}
