//! Masters that are not ours read simulated boards over Modbus TCP: mbpoll and pymodbus, where they are installed.

mod ports;

use std::process::{Command, Output};

use gateway::simulate::{Plan, Plant, Truth, listen};

const BOARDS: u32 = 3;
const SECONDS: u32 = 130;

/// What pymodbus is to do: registers 103 to 106 of each unit, its newest second, its first event.
const SCRIPT: &str = r#"
import struct, sys
from pymodbus.client import ModbusTcpClient
from pymodbus.pdu.file_message import FileRecord
client = ModbusTcpClient("127.0.0.1", port=int(sys.argv[1]))
assert client.connect()
for unit in range(1, 4):
    words = client.read_input_registers(103, count=4, device_id=unit).registers
    start, last = struct.unpack(">2I", struct.pack(">4H", *words))
    place = (last - 1) % 120
    ask = [FileRecord(file_number=2, record_number=20 * place, record_length=40),
           FileRecord(file_number=1, record_number=0, record_length=32)]
    second, event = client.read_file_record(ask, device_id=unit).records
    print("second", f"m{unit:05d}", second.record_data.hex())
    print("event", f"m{unit:05d}", event.record_data.hex())
"#;

fn plan() -> Plan {
    Plan {
        boards: BOARDS,
        listen: ports::free(),
        per_port: 200,
        seed: 11,
        faulty: 1,
        faults_within_s: 10,
        restart_s: None,
    }
}

/// Runs a program while boards answer; `None` where it is not installed.
async fn run(mut command: Command) -> Option<Output> {
    let output = tokio::task::spawn_blocking(move || command.output()).await;
    output.expect("no panic").ok()
}

#[tokio::test(flavor = "current_thread")]
async fn pymodbus_reads_seconds_and_events_as_files() {
    let (plan, folder) = (plan(), tempfile::tempdir().expect("a folder"));
    let record = folder.path().join("truth");
    let truth = Truth::create(&record).expect("a file");
    let mut plant = Plant::new(&plan, Some(truth)).expect("a sound plan");
    (0..SECONDS).for_each(|_| plant.tick(0, 1).expect("it is written"));
    listen(&plant, &plan).await.expect("a free port");
    let mut python = Command::new("python3");
    python.args(["-c", SCRIPT, &plan.listen.port().to_string()]);
    let output = run(python).await;
    let missing = |output: &Output| {
        String::from_utf8_lossy(&output.stderr).contains("No module named 'pymodbus")
    };
    let Some(output) = output.filter(|output| !missing(output)) else {
        eprintln!("pymodbus is not installed: skipped");
        return;
    };
    let read = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(read.lines().count(), 2 * BOARDS as usize, "{read}{errors}");
    let record = std::fs::read_to_string(record).expect("a record");
    for line in read.lines() {
        let of_motor = |known: &&str| known[..13] == line[..13];
        let known: Vec<&str> = record.lines().filter(of_motor).collect();
        let expected = match line.starts_with("second") {
            true => known.last(),
            false => known.first(),
        };
        assert_eq!(Some(&line), expected);
    }
}

#[tokio::test(flavor = "current_thread")]
async fn mbpoll_reads_every_register_of_every_board() {
    let plan = plan();
    let mut plant = Plant::new(&plan, None).expect("a sound plan");
    (0..SECONDS).for_each(|_| plant.tick(0, 1).expect("no record"));
    listen(&plant, &plan).await.expect("a free port");
    for unit in 1..=BOARDS {
        let mut mbpoll = Command::new("mbpoll");
        let (unit, port) = (unit.to_string(), plan.listen.port().to_string());
        mbpoll.args(["-m", "tcp", "-a", &unit, "-p", &port, "-0", "-1", "-q"]);
        mbpoll.args(["-t", "3", "-r", "0", "-c", "107", "127.0.0.1"]);
        let Some(output) = run(mbpoll).await else {
            eprintln!("mbpoll is not installed: skipped");
            return;
        };
        let text = String::from_utf8_lossy(&output.stdout);
        let value = |register: u16| {
            let prefix = format!("[{register}]:");
            let line = text.lines().find_map(|line| line.strip_prefix(&prefix));
            // Above 32767 the negative value follows in brackets.
            let number = line.and_then(|rest| rest.split_whitespace().next());
            number.and_then(|number| number.parse::<u16>().ok())
        };
        assert!((0..107).all(|register| value(register).is_some()), "{text}");
        // Map version, the newest second, and the board's number in its serial number.
        assert_eq!(value(0), Some(board::modbus::MAP_VERSION));
        assert_eq!((value(105), value(106)), (Some(0), Some(SECONDS as u16)));
        assert_eq!(value(95).map(|low| low.to_string()), Some(unit));
    }
}
