use std::path::Path;
use std::time::Duration;

use board::LineParity;

use super::{Config, LinkKind, advice};

const SOUND: &str = r#"
[gateway]
lost_after_s = 20

[store]
path = "kept/plant.db"
size_gb = 2
seconds_days = 7

[[link]]
name = "hall-1"
kind = "modbus-tcp"
address = "10.0.0.7:502"

[[link]]
name = "bus"
kind = "modbus-rtu"
port = "/dev/ttyUSB0"
parity = "odd"

[[link]]
name = "bench"
kind = "frames-tcp"
address = "10.0.0.9:4001"

[[motor]]
name = "pump-7"
link = "hall-1"
unit = 7
title = "Feed pump 7"
serial = "00210024 "
"#;

fn parse(text: &str) -> Result<Config, String> {
    let parsed = Config::parse(text, Path::new("/plants/p.toml"), Config::no_outputs);
    parsed
        .map(|(config, ())| config)
        .map_err(|error| error.to_string())
}

fn sound() -> String {
    let more = "\n[[motor]]\nname = \"fan\"\nlink = \"bus\"\nunit = 1\n[[motor]]\nname = \"bench\"\nlink = \"bench\"\n";
    SOUND.replace("00210024 ", "0021002400000000000000AB") + more
}

#[test]
fn a_whole_configuration_is_read() {
    let config = parse(&sound()).expect("sound");
    assert_eq!(config.store, Path::new("/plants/kept/plant.db"));
    assert_eq!(
        (config.limits.bytes, config.limits.seconds_days),
        (2_000_000_000, 7)
    );
    assert_eq!(config.patience.lost_after, Duration::from_secs(20));
    let LinkKind::ModbusRtu { baud, parity, .. } = config.links[1].kind else {
        panic!("a serial line");
    };
    assert_eq!((baud, parity), (19_200, LineParity::Odd));
    assert_eq!(config.links[1].poll, Duration::from_secs(10));
    let [pump, fan, bench] = &config.motors[..] else {
        panic!("three motors");
    };
    assert_eq!(pump.serial.as_deref(), Some("0021002400000000000000ab"));
    assert_eq!(pump.info.title, "Feed pump 7");
    assert_eq!(
        fan.info.link,
        "modbus-rtu /dev/ttyUSB0 19200 bit/s, odd parity unit 1"
    );
    assert_eq!((bench.unit, bench.link), (0, 2));
}

/// What is changed in a sound file, the line that is named, and what is said.
#[test]
fn what_is_wrong_is_named_with_its_line_and_a_remedy() {
    let cases = [
        (
            "unit = 7",
            "unit = 0",
            29,
            "motor[1].unit: 0 is out of range",
        ),
        (
            "unit = 7",
            "",
            26,
            "motor[1].unit: is missing: add the board's address",
        ),
        (
            "unit = 7",
            "unti = 7",
            29,
            "motor[1].unti: is not a known key: did you mean `unit`?",
        ),
        (
            "link = \"bus\"\nunit = 1",
            "link = \"hall-1\"\nunit = 7",
            36,
            "unit: 7 on link \"hall-1\" is the motor of line 26",
        ),
        (
            "name = \"fan\"",
            "name = \"pump-7\"",
            34,
            "name: \"pump-7\" is the motor of line 26",
        ),
        (
            "name = \"fan\"",
            "name = \"hall/fan\"",
            34,
            "character 5 is '/'",
        ),
        (
            "link = \"bus\"\nunit = 1",
            "link = \"bench\"",
            38,
            "carries the frames of one board",
        ),
        (
            "link = \"bus\"",
            "link = \"buss\"",
            35,
            "did you mean \"bus\"?",
        ),
        (
            "10.0.0.9:4001",
            "10.0.0.7:502",
            24,
            "is that of the link in line 10",
        ),
        (
            "name = \"bus\"",
            "name = \"hall-1\"",
            16,
            "is that of the link in line 10",
        ),
        ("10.0.0.7:502", "10.0.0.7", 13, "is not a host and a port"),
        (
            "10.0.0.7:502",
            "fe80::1:502",
            13,
            "is not a host and a port",
        ),
        (
            "\"modbus-tcp\"",
            "\"modbus\"",
            12,
            "write one of \"modbus-tcp\", \"modbus-rtu\"",
        ),
        (
            "parity = \"odd\"",
            "poll_s = 300",
            19,
            "the board keeps 120 s",
        ),
        (
            "0021002400000000000000AB",
            "21",
            31,
            "24 hexadecimal digits",
        ),
        (
            "name = \"fan\"",
            "name = \"Pump-7\"",
            34,
            "differ in case only",
        ),
        ("path = \"kept/plant.db\"", "", 5, "store.path: is missing"),
        (
            "seconds_days = 7",
            "minutes_days = 7",
            5,
            "at least seconds_days",
        ),
        ("size_gb = 2", "size_gb = 0.001", 7, "out of range"),
        ("[gateway]", "[outputs]", 2, "outputs: is not a known key"),
        (
            "lost_after_s = 20",
            "lost_after_s = \"20\"",
            3,
            "remove the quotes",
        ),
    ];
    for (from, to, line, said) in cases {
        let text = sound();
        assert!(text.contains(from), "{from}");
        let error = parse(&text.replacen(from, to, 1)).expect_err(to);
        let place = format!("/plants/p.toml:{line}: ");
        assert!(
            error.contains(said) && error.contains(&place),
            "{to}: {error}"
        );
    }
}

#[test]
fn a_plant_has_links_and_motors() {
    let error = parse("[store]\npath = \"a.db\"\n").expect_err("nothing to do");
    assert!(
        error.contains("link: is missing") && error.contains("motor: is missing"),
        "{error}"
    );
}

#[test]
fn a_line_that_cannot_keep_up_is_named_before_it_is_tried() {
    let mut text = sound();
    for unit in 2..=30 {
        text += &format!("[[motor]]\nname = \"m{unit}\"\nlink = \"bus\"\nunit = {unit}\n");
    }
    let config = parse(&text).expect("sound");
    let bus = advice(&config, 1).expect("a link");
    // Thirty visits of 0.35 s every 10 s.
    assert!(
        bus.busy.is_some_and(|busy| (busy - 1.05).abs() < 0.01),
        "{bus:?}"
    );
    assert!(bus.warnings[0].contains("leave 20 motors on it"), "{bus:?}");
    let hall = advice(&config, 0).expect("a link");
    assert_eq!((hall.busy, hall.warnings.len()), (None, 0));
}

/// A page asks for the store alone, and says what is missing where it is.
#[test]
fn a_file_without_a_store_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("plant.toml");
    let store_of = |text: &str| {
        std::fs::write(&path, text).expect("written");
        Config::store_of(&path).map_err(|error| error.to_string())
    };
    assert_eq!(store_of(SOUND), Ok(folder.path().join("kept/plant.db")));
    for text in ["name = \"pump\"\n", "[store]\nsize_gb = 2\n"] {
        let error = store_of(text).expect_err("no store");
        assert!(error.contains("store.path: is missing"), "{error}");
    }
}
