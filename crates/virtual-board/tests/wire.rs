//! Masters that are programs of their own, on the board's line as a serial port of this computer.

mod common;

use std::process::Command;

use board::modbus::{Field, MAP_VERSION, Object, WORDS, address};
use board::{Configuration, Event, EventCause, Line, MotorImage};
use common::wire::{Wire, run};
use monitor::MonitorConfig;

#[test]
fn drivemon_tells_what_ended_the_program_and_where() {
    let wire = Wire::new(|board| {
        // `ldr r5, [r4]` of the test of the RAM, reading where nothing is.
        let init = board.symbol("__pre_init").expect("a function") & !1;
        let is_load = |board: &mut virtual_board::VirtualBoard, at: u32| {
            (board.word(at & !3).expect("flash") >> (8 * (at & 2))) as u16 == 0x6825
        };
        let load = (init..init + 0x80)
            .step_by(2)
            .find(|at| is_load(board, *at))
            .expect("ldr r5, [r4]");
        board
            .go_astray(load, &[0, 0, 0, 0, 0x6000_0000])
            .expect("a processor");
        board.run(common::LAMP_TEST_S + 0.8).expect("a run");
    });
    let (output, text) = wire.drivemon(&["record"]);
    assert_eq!(output.status.code(), Some(1), "{text}");
    for part in [
        "hard fault after 2.2 s",
        "reached an address where nothing is",
        "0x60000000",
        "doubts     none",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let elf = common::elf_path();
    let elf = elf.to_str().expect("a path");
    let (_, text) = wire.drivemon(&["record", "--elf", elf]);
    assert!(text.contains("__pre_init"), "{text}");
    // Another program's addresses would name the wrong lines.
    let other = std::env::temp_dir().join(format!("other-{}.elf", std::process::id()));
    let mut bytes = common::firmware();
    let seal = bytes
        .windows(4)
        .position(|bytes| bytes == b"SEAL")
        .expect("a seal");
    bytes[seal + 8] ^= 1;
    std::fs::write(&other, bytes).expect("a temporary file");
    let (output, text) = wire.drivemon(&["record", "--elf", other.to_str().expect("a path")]);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("not the program on the board"), "{text}");
    std::fs::remove_file(other).expect("the temporary file");
}

#[test]
fn drivemon_reads_the_map_and_prepares_a_board_as_shipped() {
    let wire = Wire::new(|board| {
        board
            .set_options(virtual_board::SHIPPED_OPTIONS)
            .expect("options");
        board.run(common::LAMP_TEST_S + 0.8).expect("a run");
    });
    let (output, text) = wire.drivemon(&["read"]);
    assert_eq!(output.status.code(), Some(1), "{text}");
    let line = |name: &str| {
        let found = text.lines().find(|line| line.starts_with(name));
        found.unwrap_or_else(|| panic!("{name}: {text}")).to_owned()
    };
    assert!(line("Doubts").ends_with("option bytes"), "{text}");
    assert!(line("Lamps").contains("run, sensor blinks"), "{text}");
    assert!(line("SupplyFrequency").contains("60.0"), "{text}");
    let (output, text) = wire.drivemon(&["prepare"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    // It starts again meanwhile.
    std::thread::sleep(std::time::Duration::from_secs_f64(
        common::LAMP_TEST_S + 1.0,
    ));
    let (output, text) = wire.drivemon(&["record"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let (output, text) = wire.drivemon(&["read", "--unit", "2"]);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("no answer from unit 2"), "{text}");
}

#[test]
fn drivemon_tells_which_board_it_is_and_what_happened() {
    let wire = Wire::new(|_| {});
    let (output, text) = wire.drivemon(&["identify"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let line = |name: &str| {
        let found = text.lines().find(|line| line.starts_with(name));
        found.unwrap_or_else(|| panic!("{name}: {text}")).to_owned()
    };
    // What crates/virtual-board/src/machine/bus.rs has for the chip's.
    assert!(
        line("serial number").ends_with("203639363033510100420007"),
        "{text}"
    );
    assert!(line("motor ").contains(&common::motor().name), "{text}");
    assert!(
        line("calibration").contains("none: values of the motor file"),
        "{text}"
    );
    assert!(
        line("version").ends_with(env!("CARGO_PKG_VERSION")),
        "{text}"
    );
    let (output, text) = wire.drivemon(&["events"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(
        text.contains("    1       0:00:01  start: reset by power or brown-out, program "),
        "{text}"
    );
    let (_, _) = wire.drivemon(&["acknowledge"]);
    std::thread::sleep(std::time::Duration::from_millis(300));
    let (_, text) = wire.drivemon(&["events", "--last", "1"]);
    let last = text.lines().last().expect("an event");
    assert!(last.ends_with("acknowledged"), "{text}");
    assert_eq!(text.lines().count(), 2, "{text}");
}

/// `pymodbus` speaks the protocol by its own reading of the specification.
#[test]
fn a_master_from_elsewhere_reads_registers_identification_and_events() {
    let wire = Wire::new(|_| {});
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pymodbus_master.py");
    let words = WORDS.to_string();
    let (output, text) = run(Command::new("python3").args([script, &wire.port, &words]));
    assert!(output.status.success(), "{text}");
    let told: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let register = |field: Field| &told["input"][usize::from(address(field))];
    assert_eq!(told["input"].as_array().map(Vec::len), Some(WORDS));
    assert_eq!(*register(Field::MapVersion), MAP_VERSION);
    assert_eq!(*register(Field::Verdict), 1);
    assert_eq!(told["holding"], serde_json::json!([0, 0]));
    assert_eq!(told["beyond"], 2);
    assert_eq!(told["locked"], 1);
    let identity = told["identity"].as_object().expect("objects");
    assert_eq!(identity.len(), Object::ALL.len());
    let number = (Object::Motor as u8).to_string();
    assert_eq!(identity[&number], common::motor().name);
    let hexadecimal = told["event"].as_str().expect("text");
    let digits = hexadecimal.as_bytes().chunks(2);
    let bytes: Vec<u8> = digits
        .map(|two| {
            let two = std::str::from_utf8(two).expect("text");
            u8::from_str_radix(two, 16).expect("hexadecimal digits")
        })
        .collect();
    let bytes = bytes.try_into().expect("an event's bytes");
    let event = Event::from_bytes(&bytes).expect("a whole event");
    assert_eq!((event.number, event.cause), (1, EventCause::Start));
}

/// `mbpoll` counts registers from 1.
#[test]
fn another_master_reads_the_whole_map_alike() {
    let wire = Wire::new(|_| {});
    let count = WORDS.to_string();
    let line = ["-m", "rtu", "-a", "1", "-b", "19200", "-P", "even", "-1"];
    let (output, text) = run(Command::new("mbpoll")
        .args(line)
        .args(["-t", "3", "-r", "1", "-c", &count, &wire.port]));
    assert!(output.status.success(), "{text}");
    let values: Vec<u16> = text
        .lines()
        .filter_map(|line| line.strip_prefix('[')?.split_once("]:"))
        .map(|(_, value)| {
            let value = value.split_whitespace().next().expect("a value");
            // Values beyond 32767 are followed by the same as a signed number.
            value.parse().expect("a number")
        })
        .collect();
    assert_eq!(values.len(), WORDS, "{text}");
    let (output, read) = wire.drivemon(&["read"]);
    assert_eq!(output.status.code(), Some(0), "{read}");
    for (field, name) in [
        (Field::SerialHigh, "SerialHigh"),
        (Field::ProgramChecksum, "ProgramChecksum"),
        (Field::MotorIdentification, "MotorIdentification"),
    ] {
        let at = usize::from(address(field));
        let value = u32::from(values[at]) << 16 | u32::from(values[at + 1]);
        let told = read.lines().find(|line| line.starts_with(name));
        let told = told.unwrap_or_else(|| panic!("{name}: {read}"));
        assert!(told.ends_with(&format!("{value:#010x}")), "{told}");
    }
}

/// The value behind a name in what `drivemon board configure` prints.
fn told(text: &str, name: &str) -> String {
    let line = text.lines().find(|line| line.starts_with(name));
    let line = line.unwrap_or_else(|| panic!("{name}: {text}"));
    line[15..].trim().to_owned()
}

fn motor_file(name: &str) -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../motors");
    format!("{path}/{name}.toml")
}

#[test]
fn drivemon_configures_motor_line_and_relay_and_they_hold_after_power_returns() {
    let (reset, resets) = std::sync::mpsc::channel();
    let wire = Wire::with_resets(resets);
    let (output, text) = wire.drivemon(&["configure"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(told(&text, "motor "), common::motor().name);
    assert_eq!(told(&text, "line"), "unit 1, 19200 bit/s, parity even");
    assert_eq!(told(&text, "configuration"), "as flashed");
    let file = motor_file("peer-2k2");
    let change = [
        "configure",
        "--motor",
        &file,
        "--set-unit",
        "247",
        "--set-baud",
        "38400",
        "--relay",
        "blind",
    ];
    let (output, text) = wire.drivemon(&change);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let name = motor::MotorFile::read(&file).expect("a motor file").name;
    assert_eq!(told(&text, "motor "), name);
    assert_eq!(told(&text, "configuration"), "configured and confirmed");
    // Where it answered before, nobody answers.
    let (output, text) = wire.drivemon(&["identify"]);
    assert_eq!(output.status.code(), Some(2), "{text}");
    let new = ["--unit", "247", "--baud", "38400"];
    let ask = |command: &str| wire.drivemon(&[&[command], &new[..]].concat());
    reset.send(()).expect("a board");
    std::thread::sleep(std::time::Duration::from_secs_f64(
        common::LAMP_TEST_S + 1.0,
    ));
    let (output, text) = ask("configure");
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(told(&text, "motor "), name);
    assert_eq!(told(&text, "line"), "unit 247, 38400 bit/s, parity even");
    assert!(
        told(&text, "relay").contains("without a judgement"),
        "{text}"
    );
    let (_, text) = ask("identify");
    assert!(text.contains(&name), "{text}");
    let (_, text) = ask("events");
    assert!(text.contains("configured: motor constants"), "{text}");
    // Back to the motor that is in the program; the line stays.
    let back = [&["configure", "--flashed-motor"], &new[..]].concat();
    let (output, text) = wire.drivemon(&back);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert_eq!(told(&text, "motor "), common::motor().name);
    assert_eq!(told(&text, "line"), "unit 247, 38400 bit/s, parity even");
}

#[test]
fn what_is_not_confirmed_does_not_stay() {
    let (reset, resets) = std::sync::mpsc::channel();
    let wire = Wire::with_resets(resets);
    let trial = ["configure", "--relay", "blind", "--trial"];
    let (output, text) = wire.drivemon(&trial);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(
        told(&text, "configuration").starts_with("on trial, 5"),
        "{text}"
    );
    let (output, text) = wire.drivemon(&["configure", "--discard"]);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let (_, text) = wire.drivemon(&["configure"]);
    assert_eq!(told(&text, "relay"), "opens on FAULT");
    assert_eq!(told(&text, "configuration"), "as flashed");
    let (output, text) = wire.drivemon(&["configure", "--confirm"]);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("nothing on trial"), "{text}");
    // Power fails during a trial.
    wire.drivemon(&trial);
    reset.send(()).expect("a board");
    std::thread::sleep(std::time::Duration::from_secs_f64(
        common::LAMP_TEST_S + 1.0,
    ));
    let (_, text) = wire.drivemon(&["configure"]);
    assert_eq!(told(&text, "configuration"), "as flashed");
}

#[test]
fn a_master_from_elsewhere_configures_a_board_and_follows_it_to_its_new_line() {
    let wire = Wire::new(|_| {});
    let file = motor::MotorFile::read(motor_file("chalmers-4kw")).expect("a motor file");
    let config = MonitorConfig::of_board(&file).expect("effects of the library");
    let mut wanted = Configuration::of(&file.name, &MotorImage::new(&config));
    wanted.set_line(Line {
        unit: 99,
        baud: 57_600,
        ..Line::default()
    });
    let wanted: Vec<u16> = wanted.registers().collect();
    let words = std::env::temp_dir().join(format!("words-{}.json", std::process::id()));
    let json = serde_json::to_string(&wanted).expect("JSON");
    std::fs::write(&words, json).expect("a temporary file");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pymodbus_configure.py");
    let mut command = Command::new("python3");
    command.args([script, &wire.port]).arg(&words);
    let (output, text) = run(command.args(["99", "57600"]));
    assert!(output.status.success(), "{text}");
    let holds: Vec<u16> = serde_json::from_str(&text).expect("JSON");
    assert_eq!(holds, wanted);
    std::fs::remove_file(words).expect("the temporary file");
    // And another one finds it there.
    let line = ["-m", "rtu", "-a", "99", "-b", "57600", "-P", "even", "-1"];
    let (output, text) = run(Command::new("mbpoll")
        .args(line)
        .args(["-t", "3", "-r", "101", "-c", "1", &wire.port]));
    assert!(output.status.success(), "{text}");
    assert!(text.contains("[101]: \t1"), "{text}");
}
