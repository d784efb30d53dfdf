//! Every alarm of a fault ends with the samples that its board took, or with a reason, once.

mod ports;

use std::collections::HashSet;
use std::path::Path;
use std::time::{Duration, Instant};

use fleet::alarm::{Alarm, AlarmCause, AlarmFilter};
use fleet::{Entry, Store};
use gateway::Gateway;
use gateway::config::Config;
use gateway::simulate::{Plan, Plant, Truth, listen};

const HEAD_BYTES: usize = 24;

struct Scene {
    folder: tempfile::TempDir,
    plant: Plant,
    config: Config,
}

impl Scene {
    async fn new(faulty: u32, restart_s: Option<u32>) -> Scene {
        let plan = Plan {
            boards: 8,
            listen: ports::free(),
            per_port: 200,
            seed: 5,
            faulty,
            faults_within_s: 60,
            restart_s,
        };
        let folder = tempfile::tempdir().expect("a folder");
        let truth = Truth::create(&folder.path().join("truth")).expect("a file");
        let plant = Plant::new(&plan, Some(truth)).expect("a sound plan");
        listen(&plant, &plan).await.expect("a free port");
        let text = plan
            .configuration("plant.db")
            .replace("\"modbus-tcp\"", "\"modbus-tcp\"\npoll_s = 0.2");
        let path = folder.path().join("plant.toml");
        let (config, ()) = Config::parse(&text, &path, Config::no_outputs).expect("it is accepted");
        Scene {
            folder,
            plant,
            config,
        }
    }

    fn start(&self) -> Gateway {
        Gateway::start(&self.config, &[], |line| eprintln!("{line}")).expect("it starts")
    }

    fn pass(&mut self, seconds: u32) {
        (0..seconds).for_each(|_| self.plant.tick(0, 1).expect("it is written"));
    }

    /// Motor and instants of each recording that a board took.
    fn taken(&self) -> HashSet<(String, Vec<u8>)> {
        let truth = std::fs::read_to_string(self.folder.path().join("truth")).expect("a record");
        let lines = truth
            .lines()
            .filter_map(|line| line.strip_prefix("recording "));
        lines
            .map(|line| {
                let (motor, digits) = line.split_once(' ').expect("a motor");
                let byte = |at| u8::from_str_radix(&digits[at..at + 2], 16).expect("digits");
                let bytes = (0..digits.len()).step_by(2).map(byte).collect::<Vec<u8>>();
                (motor.to_owned(), bytes[HEAD_BYTES..].to_vec())
            })
            .collect()
    }
}

fn faults(store: &Store) -> Vec<Alarm> {
    let all = store.alarms(&AlarmFilter::default()).expect("it is read");
    let of_faults = all
        .into_iter()
        .filter(|alarm| alarm.cause == AlarmCause::Fault);
    of_faults.collect()
}

fn is_open(alarm: &Alarm) -> bool {
    alarm.evidence.recording.is_none() && alarm.evidence.no_recording.is_none()
}

/// Waits until every alarm has its recording or a reason, and a moment longer for what must not come.
async fn settle(gateway: Gateway, least: usize) -> (Vec<Alarm>, std::sync::Arc<Store>) {
    let (store, end) = (gateway.store(), Instant::now() + Duration::from_secs(30));
    loop {
        let faults = faults(&store);
        let done = faults.len() >= least && !faults.iter().any(is_open);
        if done || Instant::now() > end {
            break;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    tokio::time::sleep(Duration::from_millis(1_500)).await;
    gateway.end().await.expect("it is written");
    (faults(&store), store)
}

/// Names of recordings in the order of storing; a reason has its name too.
fn stored(store: &Store) -> Vec<(String, bool)> {
    let all = store.since(0, 1_000_000).expect("it is read").into_iter();
    all.filter_map(|numbered| match numbered.entry {
        Entry::Recording(recording) => Some((recording.file, recording.missing.is_none())),
        _ => None,
    })
    .collect()
}

fn assert_once(store: &Store) {
    let mut names = HashSet::new();
    for (name, _) in stored(store) {
        assert!(names.insert(name.clone()), "{name} is there twice");
    }
}

#[tokio::test(flavor = "current_thread")]
async fn every_alarm_has_what_its_board_took_whenever_the_gateway_ends() {
    let mut scene = Scene::new(4, None).await;
    for turn in 0..12 {
        let gateway = scene.start();
        scene.pass(10);
        // Some ends come while a recording is being fetched.
        tokio::time::sleep(Duration::from_millis(150 + 90 * turn)).await;
        drop(gateway);
    }
    let (alarms, store) = settle(scene.start(), 4).await;
    assert_eq!(alarms.len(), 4, "{alarms:?}");
    let taken = scene.taken();
    assert!(taken.len() >= 4);
    for alarm in &alarms {
        let name = alarm.evidence.recording.as_ref();
        let name = name.unwrap_or_else(|| panic!("no recording: {alarm:?}"));
        let samples = store
            .recording(name)
            .expect("it is read")
            .expect("it is there");
        let instants = samples.instants.expect("its samples");
        let key = (alarm.motor.as_ref().expect("a motor").to_string(), instants);
        assert!(taken.contains(&key), "{name} is not what the board took");
    }
    assert_once(&store);
    let path = Path::new(&scene.folder.path().join("plant.db")).to_owned();
    let reader = fleet::Reader::open(&path).expect("a store");
    let kept = reader
        .recording_of_alarm(alarms[0].number)
        .expect("it is there");
    assert!(kept.motor_file.ends_with("simulated-motor.toml"));
    let unknown = reader.recording_of_alarm(4_711).expect_err("no such alarm");
    assert!(unknown.to_string().contains("no alarm 4711"));
}

#[tokio::test(flavor = "current_thread")]
async fn a_recording_that_died_with_its_board_is_told() {
    // Power is lost so often that many a board has not seen its fault again yet when it is asked.
    let mut scene = Scene::new(8, Some(4)).await;
    // Seen healthy, then nobody looks while motors fail and boards lose their power.
    scene.pass(1);
    let gateway = scene.start();
    tokio::time::sleep(Duration::from_millis(600)).await;
    drop(gateway);
    scene.pass(110);
    let (alarms, store) = settle(scene.start(), 1).await;
    assert!(!alarms.is_empty());
    for alarm in &alarms {
        assert!(
            !is_open(alarm),
            "neither a recording nor a reason: {alarm:?}"
        );
        assert_eq!(
            alarm.why_no_recording().is_some(),
            alarm.evidence.recording.is_none()
        );
    }
    let reasons: Vec<_> = alarms
        .iter()
        .filter_map(|alarm| alarm.evidence.no_recording.clone())
        .collect();
    assert!(
        reasons.iter().any(|why| why.contains("started again")),
        "{reasons:?}"
    );
    assert_once(&store);
}
