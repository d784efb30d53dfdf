//! A broker written from the standard (MQTT 3.1.1), byte by byte: what the gateway sends it, and what it does when nobody answers.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::time::Duration;

use fleet::{Entry, Limits, MotorInfo, Second, Store};
use prost::Message as _;
use tokio::sync::watch;
use uplink::mqtt::{MqttConfig, MqttStatus, run};
use uplink::sparkplug::{Names, Payload, Wire};

/// A control packet: its first byte, and what is behind its length.
struct Packet {
    head: u8,
    body: Vec<u8>,
}

struct Client(TcpStream);

impl Client {
    fn receive(&mut self) -> Packet {
        let mut byte = || {
            let mut one = [0];
            self.0.read_exact(&mut one).expect("a packet");
            one[0]
        };
        let head = byte();
        // 2.2.3: seven bits a byte, the lowest first.
        let (mut length, mut shift) = (0usize, 0);
        loop {
            let digit = byte();
            length |= usize::from(digit & 0x7F) << shift;
            shift += 7;
            if digit < 0x80 {
                break;
            }
        }
        let mut body = vec![0; length];
        self.0.read_exact(&mut body).expect("a whole packet");
        Packet { head, body }
    }

    fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).expect("an open line");
    }

    /// CONNECT, SUBSCRIBE and their answers.
    fn welcome(&mut self) -> (Packet, Packet) {
        let connect = self.receive();
        self.send(&[0x20, 2, 0, 0]);
        let subscribe = self.receive();
        let [high, low] = [subscribe.body[0], subscribe.body[1]];
        let topics = texts(&subscribe.body[2..], 1).len() as u8;
        self.send(&[0x90, 2 + topics, high, low]);
        self.send(&vec![1; usize::from(topics)]);
        (connect, subscribe)
    }

    /// The next message: topic, payload, first byte. Pings are answered on the way, if they shall be.
    fn message(&mut self, pong: bool) -> (String, Payload, u8) {
        loop {
            let packet = self.receive();
            if packet.head == 0xC0 {
                if pong {
                    self.send(&[0xD0, 0]);
                }
                continue;
            }
            assert_eq!(packet.head >> 4, 3, "a PUBLISH");
            let topic = texts(&packet.body, 0).remove(0).0;
            let mut at = 2 + topic.len();
            if packet.head & 0b110 != 0 {
                at += 2;
            }
            let payload = Payload::decode(&packet.body[at..]).expect("a payload");
            return (topic, payload, packet.head);
        }
    }
}

/// Texts with their lengths, each with `behind` bytes behind it; as far as there are whole ones.
fn texts(mut bytes: &[u8], behind: usize) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    while let [high, low, rest @ ..] = bytes {
        let length = usize::from(u16::from_be_bytes([*high, *low]));
        if rest.len() < length + behind {
            break;
        }
        let (text, more) = rest.split_at(length);
        let (extra, more) = more.split_at(behind);
        found.push((String::from_utf8_lossy(text).into_owned(), extra.to_vec()));
        bytes = more;
    }
    found
}

struct Gateway {
    listener: TcpListener,
    store: Arc<Store>,
    status: MqttStatus,
    wake: watch::Sender<u64>,
    stop: watch::Sender<bool>,
    thread: std::thread::JoinHandle<()>,
    _folder: tempfile::TempDir,
}

impl Gateway {
    fn start(primary_host: Option<&str>) -> Gateway {
        Gateway::start_with(primary_host, |_| {})
    }

    fn start_with(primary_host: Option<&str>, change: impl FnOnce(&mut MqttConfig)) -> Gateway {
        let folder = tempfile::tempdir().expect("a folder");
        let store =
            Store::open(&folder.path().join("plant.db"), &Limits::default()).expect("a store");
        store
            .declare(&[MotorInfo::new("pump-1".parse().expect("a name"))])
            .expect("declared");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let port = listener.local_addr().expect("it is bound").port();
        let names = Names::new("plant", "gateway").expect("identifiers");
        let mut config = MqttConfig::new("127.0.0.1", port, names);
        config.primary_host = primary_host.map(str::to_owned);
        change(&mut config);
        let (store, status) = (Arc::new(store), MqttStatus::default());
        let (wake, woken) = watch::channel(0);
        let (stop, stopped) = watch::channel(false);
        let output = run(config, Arc::clone(&store), status.clone(), woken, stopped);
        let thread = std::thread::spawn(move || {
            let mut runtime = tokio::runtime::Builder::new_current_thread();
            let runtime = runtime.enable_all().build().expect("a runtime");
            runtime.block_on(output).expect("a store that works");
        });
        Gateway {
            listener,
            store,
            status,
            wake,
            stop,
            thread,
            _folder: folder,
        }
    }

    fn client(&self) -> Client {
        let (stream, _) = self.listener.accept().expect("a client");
        stream
            .set_read_timeout(Some(Duration::from_secs(30)))
            .expect("a timeout");
        Client(stream)
    }

    fn second(&self, number: u32) {
        let second = Second {
            start: 1,
            number,
            time_ms: 1_790_000_000_000 + i64::from(number) * 1_000,
            speed_rpm: Some(1_450.0),
            ..Second::default()
        };
        let motor = "pump-1".parse().expect("a name");
        self.store
            .append(&[(motor, Entry::Second(second))])
            .expect("stored");
        self.wake.send_modify(|count| *count += 1);
    }

    fn end(self) {
        // It may have ended before.
        let _ = self.stop.send(true);
        self.thread.join().expect("it ends without a panic");
    }
}

/// CONNECT: protocol level 4, a clean session, a will with QoS 1 that is not retained; subscriptions with QoS 1.
#[test]
fn the_connect_is_what_the_specification_asks_for() {
    let gateway = Gateway::start(Some("scada"));
    let mut client = gateway.client();
    let (connect, subscribe) = client.welcome();
    assert_eq!(connect.head, 0x10);
    assert_eq!(&connect.body[..6], b"\0\x04MQTT");
    assert_eq!(connect.body[6], 4);
    // Clean session, will, will QoS 1, will retain 0, no user, no password (3.1.2).
    assert_eq!(connect.body[7], 0b0000_1110);
    let fields = texts(&connect.body[10..], 0);
    assert_eq!(fields[0].0, "drivemon-gateway");
    assert_eq!(fields[1].0, "spBv1.0/plant/NDEATH/gateway");
    assert_eq!(subscribe.head, 0x82);
    let one = |topic: &str| (topic.to_owned(), vec![1]);
    let wanted = [
        one("spBv1.0/plant/NCMD/gateway"),
        one("spBv1.0/plant/DCMD/gateway/+"),
        one("spBv1.0/plant/NBIRTH/gateway"),
        one("spBv1.0/STATE/scada"),
    ];
    assert_eq!(texts(&subscribe.body[2..], 1), wanted);
    drop(client);
    gateway.end();
}

/// Nobody listens where the first broker should be: the second one gets everything.
#[test]
fn a_second_broker_takes_over() {
    let dead = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let nowhere = dead.local_addr().expect("it is bound").port();
    drop(dead);
    let gateway = Gateway::start_with(None, |config| {
        config.second = Some((config.host.clone(), config.port));
        config.port = nowhere;
    });
    let mut client = gateway.client();
    client.welcome();
    let (topic, ..) = client.message(false);
    assert_eq!(topic, "spBv1.0/plant/NBIRTH/gateway");
    drop(client);
    gateway.end();
}

/// At the end: NDEATH with QoS 1, then DISCONNECT.
#[test]
fn the_death_comes_before_the_disconnect() {
    let gateway = Gateway::start(None);
    let mut client = gateway.client();
    client.welcome();
    let (topic, birth, head) = client.message(true);
    assert_eq!(
        (topic.as_str(), head),
        ("spBv1.0/plant/NBIRTH/gateway", 0x30)
    );
    gateway.stop.send(true).expect("it still runs");
    let (topic, death, head) = loop {
        let message = client.message(true);
        if message.0.contains("/NDEATH/") {
            break message;
        }
    };
    assert_eq!(
        (topic.as_str(), head),
        ("spBv1.0/plant/NDEATH/gateway", 0x32)
    );
    assert_eq!(death.metrics[0].value, birth.metrics[0].value);
    let packet = client.receive();
    assert_eq!((packet.head, packet.body.len()), (0xE0, 0));
    gateway.end();
}

/// A broker that takes what is sent and goes before it answers: the next session brings it again, with the same time.
#[test]
fn what_was_not_answered_is_sent_again() {
    let gateway = Gateway::start(None);
    let mut client = gateway.client();
    client.welcome();
    client.message(false);
    gateway.second(1);
    let seen = second_of(&mut client, false);
    assert_eq!(gateway.status.get().delivered, 0);
    drop(client);
    let mut client = gateway.client();
    client.welcome();
    let again = second_of(&mut client, true);
    assert_eq!(seen, again);
    // Answered now: a third session would bring only what is new.
    let until = std::time::Instant::now() + Duration::from_secs(20);
    while gateway.status.get().delivered == 0 {
        assert!(
            std::time::Instant::now() < until,
            "{:?}",
            gateway.status.get()
        );
        // The answer is read together with the next packet.
        client
            .0
            .set_read_timeout(Some(Duration::from_millis(50)))
            .expect("a timeout");
        let mut one = [0];
        if client
            .0
            .read(&mut one)
            .is_ok_and(|count| count == 1 && one[0] == 0xC0)
        {
            client.send(&[0xD0, 0]);
        }
    }
    drop(client);
    gateway.second(2);
    let mut client = gateway.client();
    client.welcome();
    let (number, _) = second_of(&mut client, true);
    assert_eq!(number, 2);
    gateway.end();
}

/// Number and time of the next second in data; births are passed over.
fn second_of(client: &mut Client, pong: bool) -> (u64, u64) {
    let mut alias = None;
    loop {
        let (topic, payload, _) = client.message(pong);
        let named =
            |metric: &&uplink::sparkplug::Metric| metric.name.as_deref() == Some("Second/Number");
        if let Some(metric) = payload.metrics.iter().find(named) {
            alias = metric.alias;
        }
        // The first session's births came before the second was stored.
        let alias = alias.or(Some(128 + 6));
        let of = |metric: &&uplink::sparkplug::Metric| metric.alias == alias;
        if topic.contains("/DDATA/")
            && let Some(metric) = payload.metrics.iter().find(of)
            && let Some(Wire::Long(number)) = metric.value
        {
            return (number, metric.timestamp.unwrap_or(0));
        }
    }
}

/// A packet that is too long, and a refusal: the line is given up, and the next one has the next number.
#[test]
fn a_broker_that_is_none_is_given_up() {
    let gateway = Gateway::start(None);
    // A PUBLISH of 256 MB, and a CONNACK that refuses.
    for rubbish in [&[0x30, 0xFF, 0xFF, 0xFF, 0x7F][..], &[0x20, 2, 0, 5]] {
        let mut client = gateway.client();
        client.receive();
        client.send(rubbish);
        let mut rest = Vec::new();
        let _ = client.0.read_to_end(&mut rest);
        assert!(rest.is_empty(), "{rest:?}");
    }
    let mut client = gateway.client();
    client.welcome();
    let (_, birth, _) = client.message(true);
    assert_eq!(birth.metrics[0].value, Some(Wire::Long(2)));
    assert_eq!(gateway.status.get().sessions, 1);
    gateway.end();
}
