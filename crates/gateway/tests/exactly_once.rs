//! What simulated boards have produced, by their own record, is in the store once, or a gap says that it is not.

mod ports;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fleet::{Entry, GapOf, Store};
use gateway::Gateway;
use gateway::config::Config;
use gateway::simulate::{Plan, Plant, Truth, listen};

fn plan(boards: u32, restart_s: Option<u32>) -> Plan {
    Plan {
        boards,
        listen: ports::free(),
        per_port: 200,
        seed: 7,
        faulty: boards / 2,
        faults_within_s: 60,
        restart_s,
    }
}

struct Scene {
    folder: tempfile::TempDir,
    plant: Plant,
    config: Config,
}

impl Scene {
    async fn new(plan: &Plan) -> Scene {
        let folder = tempfile::tempdir().expect("a folder");
        let truth = Truth::create(&folder.path().join("truth")).expect("a file");
        let plant = Plant::new(plan, Some(truth)).expect("a sound plan");
        listen(&plant, plan).await.expect("a free port");
        let text = plan
            .configuration("plant.db")
            .replace("\"modbus-tcp\"", "\"modbus-tcp\"\npoll_s = 0.2");
        let read = Config::parse(&text, &folder.path().join("plant.toml"), Config::no_outputs);
        let (config, ()) = read.expect("it is accepted");
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

    /// The first contact: nothing before it was promised.
    async fn meet(&mut self) {
        self.pass(1);
        let gateway = self.start();
        self.settle(gateway).await;
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Waits until everything is stored or told to be lost, and ends the gateway.
    async fn settle(&self, gateway: Gateway) -> Outcome {
        let end = Instant::now() + Duration::from_secs(30);
        let store = gateway.store();
        while Outcome::of(&store, &self.file("truth")).untold > 0 && Instant::now() < end {
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
        gateway.end().await.expect("everything is written");
        Outcome::of(&store, &self.file("truth"))
    }
}

/// Run and number of a second, or 0 and the number of an event, of a motor.
type Key = (String, u32, u32);

/// Store and record side by side.
#[derive(Debug, Default, PartialEq, Eq)]
struct Outcome {
    produced: usize,
    stored: usize,
    twice: usize,
    other: usize,
    told: usize,
    untold: usize,
}

impl Outcome {
    fn of(store: &Store, truth: &Path) -> Outcome {
        let truth = read_truth(truth);
        let mut seen = HashSet::new();
        let mut gaps: HashMap<(String, u32), Vec<(u32, u32)>> = HashMap::new();
        let mut outcome = Outcome {
            produced: truth.len(),
            ..Outcome::default()
        };
        for numbered in store.since(0, 1_000_000).expect("it is read") {
            let motor = numbered
                .motor
                .map_or(String::new(), |motor| motor.to_string());
            let (key, content) = match numbered.entry {
                Entry::Second(second) => (
                    (motor, second.start, second.number),
                    (second.lamps, u32::from(second.windows), second.speed_rpm),
                ),
                Entry::Event(event) => (
                    (motor, 0, event.number),
                    (u32::from(event.cause), event.values[0], None),
                ),
                Entry::Gap(gap) => {
                    let start = match gap.what {
                        GapOf::Seconds { start } => start,
                        _ => 0,
                    };
                    gaps.entry((motor, start))
                        .or_default()
                        .push((gap.first, gap.last));
                    continue;
                }
                _ => continue,
            };
            outcome.stored += 1;
            outcome.other += usize::from(truth.get(&key) != Some(&content));
            outcome.twice += usize::from(!seen.insert(key));
        }
        for key in truth.keys().filter(|key| !seen.contains(*key)) {
            let (motor, start, number) = key.clone();
            let ranges = gaps.get(&(motor, start));
            let told = ranges.is_some_and(|ranges| {
                ranges
                    .iter()
                    .any(|(first, last)| (*first..=*last).contains(&number))
            });
            match told {
                true => outcome.told += 1,
                false => outcome.untold += 1,
            }
        }
        outcome
    }
}

/// Records by the manual's table of bytes, not by the code that wrote them.
fn read_truth(path: &Path) -> BTreeMap<Key, (u32, u32, Option<f32>)> {
    let text = std::fs::read_to_string(path).expect("a record");
    let mut truth = BTreeMap::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let [kind, motor, digits] = words[..] else {
            panic!("{line}");
        };
        // Those have a test of their own.
        if kind == "recording" {
            continue;
        }
        let bytes: Vec<u8> = (0..digits.len() / 2)
            .map(|k| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).expect("digits"))
            .collect();
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
        let motor = motor.to_owned();
        let before = match kind {
            "second" => {
                let speed = Some(f32::from_bits(word(36)));
                truth.insert((motor, word(0), word(4)), (word(8), word(12) & 0xFF, speed))
            }
            _ => truth.insert((motor, 0, word(4)), (word(12) & 0xFFFF, word(16), None)),
        };
        assert!(before.is_none(), "a board numbers nothing twice: {line}");
    }
    truth
}

#[tokio::test(flavor = "current_thread")]
async fn an_end_at_any_moment_loses_nothing_that_a_board_still_has() {
    let mut scene = Scene::new(&plan(20, None)).await;
    scene.meet().await;
    for round in 0..6 {
        let gateway = scene.start();
        scene.pass(40);
        tokio::time::sleep(Duration::from_millis(100 + 50 * round)).await;
        // Nobody is told, nothing is waited for.
        drop(gateway);
        scene.pass(40);
    }
    let gateway = scene.start();
    let outcome = scene.settle(gateway).await;
    assert_eq!(
        (outcome.twice, outcome.other, outcome.untold),
        (0, 0, 0),
        "{outcome:?}"
    );
    assert!(outcome.produced > 20 * 480, "{outcome:?}");
}

#[tokio::test(flavor = "current_thread")]
async fn who_was_away_for_too_long_tells_what_is_missing() {
    let mut scene = Scene::new(&plan(3, None)).await;
    let gateway = scene.start();
    scene.pass(50);
    let outcome = scene.settle(gateway).await;
    assert_eq!(
        (outcome.told, outcome.untold, outcome.twice),
        (0, 0, 0),
        "{outcome:?}"
    );
    scene.pass(300);
    let gateway = scene.start();
    let outcome = scene.settle(gateway).await;
    // The ring holds 120 of 300 seconds of three boards.
    assert_eq!(
        (outcome.told, outcome.untold, outcome.twice),
        (3 * 180, 0, 0),
        "{outcome:?}"
    );
}

#[tokio::test(flavor = "current_thread")]
async fn a_board_that_loses_its_power_goes_on_and_what_was_lost_with_it_is_told() {
    let mut scene = Scene::new(&plan(20, Some(30))).await;
    scene.meet().await;
    let gateway = scene.start();
    for _ in 0..60 {
        scene.pass(5);
        tokio::time::sleep(Duration::from_millis(60)).await;
    }
    let outcome = scene.settle(gateway).await;
    assert_eq!(
        (outcome.twice, outcome.other, outcome.untold),
        (0, 0, 0),
        "{outcome:?}"
    );
    assert!(
        outcome.told > 0 && outcome.stored > outcome.told,
        "{outcome:?}"
    );
}
