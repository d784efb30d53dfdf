//! The links of a configuration.

use std::collections::HashMap;
use std::time::Duration;

use board::LineParity;
use document::{Bounds, Section};

use super::{LinkConfig, LinkKind};

const POLL_S: Bounds = Bounds::between(0.2, 110.0, "s")
    .hint("the board keeps 120 s; who asks less often loses seconds");
const TIMEOUT_S: Bounds = Bounds::between(0.05, 60.0, "s");
const BAUD: Bounds = Bounds::between(1_200.0, 1_000_000.0, "bit/s");
/// What a board speaks on its debugger's port.
const FRAMES_BAUD: u32 = 115_200;
const LINE_BAUD: u32 = 19_200;
const PARITIES: [(&str, LineParity); 3] = [
    ("even", LineParity::Even),
    ("odd", LineParity::Odd),
    ("none", LineParity::None),
];

/// The keys of a kind.
#[derive(Clone, Copy)]
enum Kind {
    ModbusTcp,
    ModbusRtu,
    FramesSerial,
    FramesTcp,
}

const KINDS: [(&str, Kind); 4] = [
    ("modbus-tcp", Kind::ModbusTcp),
    ("modbus-rtu", Kind::ModbusRtu),
    ("frames-serial", Kind::FramesSerial),
    ("frames-tcp", Kind::FramesTcp),
];

/// Reads all of them.
pub(super) fn read(root: &Section<'_>) -> Option<Vec<LinkConfig>> {
    let sections = root.sections("link")?;
    if sections.is_empty() {
        root.report("link", "is missing: add a section [[link]] for each way to boards, with name, kind and address or port");
        return None;
    }
    let mut names = HashMap::new();
    let mut places = HashMap::new();
    let mut links = Vec::with_capacity(sections.len());
    for section in sections {
        let link = of_section(&section);
        if let Some(link) = &link {
            alone(&section, "name", &link.name, link.line, &mut names);
            let key = if matches!(
                link.kind,
                LinkKind::ModbusTcp { .. } | LinkKind::FramesTcp { .. }
            ) {
                "address"
            } else {
                "port"
            };
            alone(&section, key, link.kind.place(), link.line, &mut places);
        }
        section.finish();
        links.push(link);
    }
    links.into_iter().collect()
}

/// Reports what another link has already.
fn alone(
    section: &Section<'_>,
    key: &str,
    value: &str,
    line: usize,
    seen: &mut HashMap<String, usize>,
) {
    if let Some(before) = seen.insert(value.to_owned(), line) {
        let message = format!(
            "\"{value}\" is that of the link in line {before}, too: a link has its own; boards behind one {key} belong to one link"
        );
        section.report(key, message);
    }
}

fn of_section(section: &Section<'_>) -> Option<LinkConfig> {
    let name = section.text("name", "what motors call this link");
    let kind = section.choice("kind", &KINDS);
    let link = kind.and_then(|kind| of_kind(section, kind));
    // A serial line is slow, and boards keep two minutes.
    let usual_s = if matches!(kind, Some(Kind::ModbusRtu)) {
        10.0
    } else {
        1.0
    };
    let asked = matches!(kind, None | Some(Kind::ModbusTcp | Kind::ModbusRtu));
    let number = |key, bounds: &Bounds, usual| match asked {
        true => section.number_or(key, bounds, usual),
        false => Some(usual),
    };
    let poll = number("poll_s", &POLL_S, usual_s);
    let timeout = number("timeout_s", &TIMEOUT_S, 1.0);
    Some(LinkConfig {
        name: name?,
        line: section.line(),
        kind: link?,
        poll: duration(poll?),
        timeout: duration(timeout?),
    })
}

fn of_kind(section: &Section<'_>, kind: Kind) -> Option<LinkKind> {
    match kind {
        Kind::ModbusTcp => Some(LinkKind::ModbusTcp {
            address: address(section)?,
        }),
        Kind::FramesTcp => Some(LinkKind::FramesTcp {
            address: address(section)?,
        }),
        Kind::ModbusRtu => {
            let port = port(section);
            let baud = section.integer_or("baud", &BAUD, LINE_BAUD);
            let parity = section.choice_or("parity", &PARITIES, LineParity::Even);
            Some(LinkKind::ModbusRtu {
                port: port?,
                baud: baud?,
                parity: parity?,
            })
        }
        Kind::FramesSerial => {
            let port = port(section);
            let baud = section.integer_or("baud", &BAUD, FRAMES_BAUD);
            Some(LinkKind::FramesSerial {
                port: port?,
                baud: baud?,
            })
        }
    }
}

fn port(section: &Section<'_>) -> Option<String> {
    section.text("port", "the serial port, \"/dev/ttyUSB0\" or \"COM3\"")
}

/// Host and port; whether the host exists is seen when it is asked.
fn address(section: &Section<'_>) -> Option<String> {
    let text = section.text("address", "host and port, \"10.0.0.7:502\"")?;
    let sound = text.rsplit_once(':').is_some_and(|(host, port)| {
        let bare = host.contains(':') && !(host.starts_with('[') && host.ends_with(']'));
        !host.is_empty() && !bare && port.parse::<u16>().is_ok_and(|port| port > 0)
    });
    if !sound {
        let message = format!(
            "\"{text}\" is not a host and a port: write \"10.0.0.7:502\", \"plc.example:502\" or \"[fe80::1]:502\""
        );
        section.report("address", message);
    }
    sound.then_some(text)
}

/// Of a number that was checked to be in its range.
pub(super) fn duration(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}
