//! A fault on a board becomes one alarm with its evidence, whatever becomes of the gateway meanwhile.

mod ports;

use std::collections::HashMap;
use std::time::{Duration, Instant};

use fleet::alarm::{Alarm, AlarmCause, AlarmFilter};
use gateway::Gateway;
use gateway::config::Config;
use gateway::simulate::{Plan, Plant, Truth, listen};

const FAULTY: u32 = 4;

fn plan() -> Plan {
    Plan {
        boards: 20,
        listen: ports::free(),
        per_port: 200,
        seed: 3,
        faulty: FAULTY,
        faults_within_s: 60,
        restart_s: None,
    }
}

/// The likely fault of each motor whose board wrote "FAULT on" (cause 3), by its own record.
fn faults(truth: &str) -> HashMap<String, u8> {
    let mut faults = HashMap::new();
    for line in truth.lines().filter(|line| line.starts_with("event")) {
        let words: Vec<&str> = line.split(' ').collect();
        // Bytes 12 and 16 of an event, little-endian.
        let byte = |at: usize| u8::from_str_radix(&words[2][2 * at..2 * at + 2], 16);
        if byte(12) == Ok(3) {
            faults.insert(words[1].to_owned(), byte(16).expect("digits"));
        }
    }
    faults
}

fn alarms(gateway: &Gateway) -> Vec<Alarm> {
    let all = gateway.store().alarms(&AlarmFilter::default());
    let faults = all.expect("it is read").into_iter();
    faults
        .filter(|alarm| alarm.cause == AlarmCause::Fault)
        .collect()
}

#[tokio::test(flavor = "current_thread")]
async fn every_fault_is_one_alarm_and_no_healthy_motor_has_one() {
    let (plan, folder) = (plan(), tempfile::tempdir().expect("a folder"));
    let record = folder.path().join("truth");
    let truth = Truth::create(&record).expect("a file");
    let mut plant = Plant::new(&plan, Some(truth)).expect("a sound plan");
    listen(&plant, &plan).await.expect("a free port");
    let text = plan
        .configuration("plant.db")
        .replace("\"modbus-tcp\"", "\"modbus-tcp\"\npoll_s = 0.2");
    let read = Config::parse(&text, &folder.path().join("plant.toml"), Config::no_outputs);
    let (config, ()) = read.expect("it is accepted");
    for _ in 0..5 {
        let gateway = Gateway::start(&config, &[], |line| eprintln!("{line}")).expect("it starts");
        (0..80).for_each(|_| plant.tick(0, 1).expect("it is written"));
        tokio::time::sleep(Duration::from_millis(700)).await;
        drop(gateway);
    }
    let gateway = Gateway::start(&config, &[], |line| eprintln!("{line}")).expect("it starts");
    let faults = faults(&std::fs::read_to_string(&record).expect("a record"));
    assert_eq!(faults.len(), FAULTY as usize);
    let end = Instant::now() + Duration::from_secs(20);
    while alarms(&gateway).len() < faults.len() && Instant::now() < end {
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    // One more look at everything: nothing is told again.
    tokio::time::sleep(Duration::from_millis(1_500)).await;
    let told: Vec<(String, u8)> = alarms(&gateway)
        .into_iter()
        .map(|alarm| (alarm.motor.expect("of a motor").to_string(), alarm.fault))
        .collect();
    assert_eq!(told.len(), faults.len(), "{told:?}");
    assert_eq!(told.into_iter().collect::<HashMap<_, _>>(), faults);
    gateway.end().await.expect("it is written");
}
