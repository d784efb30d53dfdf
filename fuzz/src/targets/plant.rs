//! What others send to a gateway: requests of Modbus TCP, commands and states of Sparkplug.

use std::sync::OnceLock;

use fleet::{MotorInfo, MotorState, Second};
use uplink::modbus::{Frame, LARGEST_FRAME, Layout, Plant, answer, split};
use uplink::sparkplug::{Message, Names, Node, Payload, Phase, Present, Reaction};

/// Any time: 2026.
const NOW_MS: i64 = 1_790_000_000_000;

fn plants() -> &'static [Plant; 2] {
    static PLANTS: OnceLock<[Plant; 2]> = OnceLock::new();
    PLANTS.get_or_init(|| {
        let motors: Vec<_> = (0..3).map(motor).collect();
        [Layout::Own, Layout::Shared].map(|layout| Plant::new(&motors, layout))
    })
}

fn motor(k: u32) -> MotorState {
    let id = format!("m{k}").parse().expect("a name");
    let second = Second {
        number: k,
        time_ms: NOW_MS,
        ..Second::default()
    };
    MotorState {
        info: MotorInfo::new(id),
        last: (k > 0).then_some(second),
        last_event: k,
        link: None,
        open_alarms: 0,
        unacknowledged: 0,
        worst: None,
    }
}

/// A stream of frames: each whole one has an answer with its numbers, of the length that it says; what is broken stays so.
pub(crate) fn modbus_tcp(bytes: &[u8]) {
    for plant in plants() {
        let mut rest = bytes;
        while let Frame::Whole(request, length) = split(rest) {
            assert!(length <= LARGEST_FRAME && length <= rest.len(), "{length}");
            let (reply, exception) = answer(&request, plant, NOW_MS);
            assert_eq!(reply[..2], request.transaction.to_be_bytes());
            let says = usize::from(u16::from_be_bytes([reply[4], reply[5]]));
            assert_eq!(says, reply.len() - 6);
            assert_eq!(reply[6], request.unit);
            assert!(reply.len() <= LARGEST_FRAME);
            assert_eq!(exception, reply[7] >= 0x80);
            rest = &rest[length..];
        }
    }
}

/// Messages of a kind, a length and a body each. Births follow commands that ask for them and nothing else; without its host the
/// node says nothing.
pub(crate) fn sparkplug(bytes: &[u8]) {
    let names = Names::new("plant", "gateway").expect("identifiers");
    let mut node = Node::new(names, Some("scada".to_owned()), 0, "1");
    node.connect(NOW_MS);
    assert_eq!(node.subscribed(), Reaction::None);
    let mut rest = bytes;
    while let [kind, length, tail @ ..] = rest {
        let body = &tail[..tail.len().min(usize::from(*length))];
        rest = &tail[body.len()..];
        let topic = match kind % 4 {
            0 => "spBv1.0/plant/NCMD/gateway",
            1 => "spBv1.0/plant/DCMD/gateway/m1",
            2 => "spBv1.0/STATE/scada",
            _ => "spBv1.0/plant/NCMD/other",
        };
        again(body);
        let (before, refused) = (node.phase(), node.refused());
        match node.take(NOW_MS, topic, body) {
            Reaction::None => {}
            Reaction::Tell(message) => {
                assert!(before == Phase::Online && node.refused() > refused);
                sound(&message);
            }
            Reaction::Birth => births(&mut node),
            Reaction::Leave => {
                assert_eq!(before, Phase::Online);
                node.connect(NOW_MS);
                node.subscribed();
            }
        }
    }
}

fn births(node: &mut Node) {
    let motors = (0..2).map(|k| Present {
        device: format!("m{k}"),
        up: Some(true),
        values: Vec::new(),
    });
    let messages = node.birth(NOW_MS, Vec::new(), motors.collect());
    assert_eq!(messages.len(), 3);
    messages.iter().for_each(sound);
}

fn sound(message: &Message) {
    let payload = Payload::from_bytes(&message.payload).expect("our own payload");
    assert!(payload.seq.is_some());
}

/// A payload that is read is written so that it is read as the same.
fn again(body: &[u8]) {
    if let Ok(payload) = Payload::from_bytes(body) {
        let bytes = payload.to_bytes();
        let read = Payload::from_bytes(&bytes).expect("our own payload");
        // NaN is not equal to itself; its bytes are.
        assert_eq!(read.to_bytes(), bytes);
    }
}
