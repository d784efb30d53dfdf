//! A plant that a program made up, for `tools/check-sparkplug`, `tools/check-modbus-map` and `tools/check-metrics`.
//!
//! `plant FOLDER MOTORS ROUNDS [mqtt=PORT] [ca=FILE] [certificate=FILE key=FILE] [host=PRIMARY_HOST] [modbus=PORT] [shared=1] [metrics=PORT]`
//!
//! What it has stored it writes to `truth.jsonl` too, a line an entry. It ends when everything is delivered, or
//! after two minutes without.

use std::collections::HashMap;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use fleet::alarm::{Alarm, AlarmCause, AlarmChange, AlarmState, Change, Evidence, Severity, Who};
use fleet::{BoardEvent, Entry, Limits, Link, MotorId, MotorInfo, Second, Store, now_ms};
use tokio::sync::watch;
use uplink::metrics::{MetricsConfig, Source, router};
use uplink::modbus::{Layout, ModbusConfig, ModbusStatus};
use uplink::mqtt::{MqttConfig, MqttStatus, OwnCertificate, TlsConfig};
use uplink::sparkplug::Names;

type Failure = Box<dyn std::error::Error>;

/// Rounds of a second: here one is shorter, so that a run takes less time.
const ROUND: Duration = Duration::from_millis(200);

struct Arguments {
    folder: PathBuf,
    motors: u32,
    rounds: u32,
    more: HashMap<String, String>,
}

fn arguments() -> Result<Arguments, Failure> {
    let mut words = std::env::args().skip(1);
    let mut next = || {
        words
            .next()
            .ok_or("plant FOLDER MOTORS ROUNDS [KEY=VALUE]...")
    };
    let (folder, motors, rounds) = (next()?.into(), next()?.parse()?, next()?.parse()?);
    let pair = |word: String| {
        word.split_once('=')
            .map(|(key, value)| (key.to_owned(), value.to_owned()))
    };
    Ok(Arguments {
        folder,
        motors,
        rounds,
        more: words.filter_map(pair).collect(),
    })
}

fn name(k: u32) -> Result<MotorId, Failure> {
    Ok(format!("pump-{k:03}").parse()?)
}

fn second(k: u32, start: u32, number: u32) -> Second {
    // A quarter of the values stays the same from one second to the next, and some are missing.
    let step = (number / 4 + k) % 50;
    Second {
        start,
        number,
        time_ms: now_ms(),
        lamps: 1 | (number / 10 % 3) << 16,
        windows: 5,
        judged: (number % 6) as u8,
        not_judged: (number % 3) as u8,
        fault: (k % 14) as u8,
        residuals: (!number.is_multiple_of(7)).then_some([
            0.012,
            -0.5,
            step as f32 * 0.001,
            f32::NAN,
        ]),
        voltage_v: Some(230.0 + step as f32 * 0.25),
        current_a: (!k.is_multiple_of(3)).then_some(4.75),
        frequency_hz: Some(50.0),
        speed_rpm: (!number.is_multiple_of(5)).then_some(1450.0 + step as f32),
    }
}

fn alarm(k: u32, number: u64, motor: MotorId, present: bool) -> AlarmChange {
    let state = if present {
        AlarmState::Unacknowledged
    } else {
        AlarmState::ReturnedUnacknowledged
    };
    let alarm = Alarm {
        number,
        motor: Some(motor),
        cause: AlarmCause::Fault,
        state,
        present,
        acknowledged: false,
        suppressed: false,
        severity: Severity::High,
        fault: (k % 14) as u8,
        size: Some(0.125),
        evidence: Evidence {
            words: "r1 and r4 beyond their thresholds".to_owned(),
            ..Evidence::default()
        },
        raised_ms: now_ms(),
        changed_ms: now_ms(),
        times: 1,
        shelved_until_ms: None,
    };
    AlarmChange {
        change: if present {
            Change::Raised
        } else {
            Change::Returned
        },
        before: AlarmState::Normal,
        alarm,
        who: Who::Board,
        time_ms: now_ms(),
        why: String::new(),
    }
}

struct Plant {
    store: Arc<Store>,
    truth: std::fs::File,
    wake: watch::Sender<u64>,
    start: u32,
    events: Vec<u32>,
}

impl Plant {
    fn open(folder: &Path, motors: u32, wake: watch::Sender<u64>) -> Result<Plant, Failure> {
        let store = Store::open(&folder.join("plant.db"), &Limits::default())?;
        let infos = (0..motors).map(|k| Ok(MotorInfo::new(name(k)?)));
        store.declare(&infos.collect::<Result<Vec<_>, Failure>>()?)?;
        let events = (0..motors).map(|k| Ok(store.last_event(&name(k)?)?));
        let events = events.collect::<Result<Vec<_>, Failure>>()?;
        let start = store
            .last_second(&name(0)?)?
            .map_or(1, |(start, _)| start + 1);
        let truth = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(folder.join("truth.jsonl"))?;
        Ok(Plant {
            store: Arc::new(store),
            truth,
            wake,
            start,
            events,
        })
    }

    fn keep(&mut self, entries: &[(MotorId, Entry)]) -> Result<(), Failure> {
        let lines = entries
            .iter()
            .map(|entry| serde_json::to_string(entry).map(|line| line + "\n"));
        let text = lines.collect::<Result<String, _>>()?;
        self.store.append(entries)?;
        self.truth.write_all(text.as_bytes())?;
        self.wake.send_modify(|count| *count += 1);
        Ok(())
    }

    fn round(&mut self, number: u32) -> Result<(), Failure> {
        let mut entries = Vec::new();
        for k in 0..self.events.len() as u32 {
            let motor = name(k)?;
            let link = |up, why: &str| {
                Entry::Link(Link {
                    up,
                    time_ms: now_ms(),
                    why: why.to_owned(),
                })
            };
            if number == 1 {
                entries.push((motor.clone(), link(true, "")));
            }
            if (number + k) % 20 == 5 {
                let event = self.events.get_mut(k as usize).ok_or("a motor too many")?;
                *event += 1;
                let event = BoardEvent {
                    number: *event,
                    time_ms: now_ms(),
                    cause: 3 + (k % 2) as u16,
                    times: 1,
                    values: [12, u32::MAX],
                };
                entries.push((motor.clone(), Entry::Event(event)));
                let change = alarm(k, u64::from(k) + 1, motor.clone(), number % 40 < 20);
                entries.push((motor.clone(), Entry::Alarm(change)));
            }
            entries.push((motor.clone(), Entry::Second(second(k, self.start, number))));
            // The last motor's link is cut now and then.
            match (k + 1 == self.events.len() as u32, number % 30) {
                (true, 10) => entries.push((motor, link(false, "no answer"))),
                (true, 14) => entries.push((motor, link(true, ""))),
                _ => {}
            }
        }
        self.keep(&entries)
    }
}

#[tokio::main(flavor = "multi_thread", worker_threads = 1)]
async fn main() -> Result<(), Failure> {
    let arguments = arguments()?;
    let (wake, woken) = watch::channel(0);
    let (stop, stopped) = watch::channel(false);
    let mut plant = Plant::open(&arguments.folder, arguments.motors, wake)?;
    let (mqtt, modbus) = (MqttStatus::default(), ModbusStatus::default());
    let mut running = tokio::task::JoinSet::new();
    if let Some(port) = arguments.more.get("mqtt") {
        let mut config = MqttConfig::new(
            "127.0.0.1",
            port.parse()?,
            Names::new("Plant 1", "gateway")?,
        );
        config.primary_host = arguments.more.get("host").cloned();
        config.session_file = Some(arguments.folder.join("session"));
        if let Some(file) = arguments.more.get("ca") {
            let ca_file = Some(file.into());
            let file = |key: &str| arguments.more.get(key).map(PathBuf::from);
            let own = file("certificate").zip(file("key"));
            let own = own.map(|(certificate_file, key_file)| OwnCertificate {
                certificate_file,
                key_file,
            });
            config.tls = Some(TlsConfig { ca_file, own });
            config.user = Some(("gateway".to_owned(), arguments.folder.join("password")));
        }
        let output = uplink::mqtt::run(
            config,
            Arc::clone(&plant.store),
            mqtt.clone(),
            woken,
            stopped.clone(),
        );
        running.spawn(async { output.await.map_err(|error| error.to_string()) });
    }
    if let Some(port) = arguments.more.get("modbus") {
        let mut config = ModbusConfig::new(format!("127.0.0.1:{port}").parse()?);
        if arguments.more.contains_key("shared") {
            config.layout = Layout::Shared;
        }
        let output = uplink::modbus::run(
            config,
            Arc::clone(&plant.store),
            modbus.clone(),
            stopped.clone(),
        );
        running.spawn(async { output.await.map_err(|error| error.to_string()) });
    }
    if let Some(port) = arguments.more.get("metrics") {
        let source = Source {
            store: Arc::clone(&plant.store),
            config: MetricsConfig::default(),
            outputs: vec!["mqtt".to_owned()],
            mqtt: Some(mqtt.clone()),
            modbus: Some(modbus),
        };
        let listener = tokio::net::TcpListener::bind(format!("127.0.0.1:{port}")).await?;
        tokio::spawn(async { axum::serve(listener, router(source)).await });
    }
    for number in 1..=arguments.rounds {
        plant.round(number)?;
        tokio::time::sleep(ROUND).await;
    }
    if arguments.more.contains_key("mqtt") {
        let mut patience = 1_200;
        while patience > 0 && !plant.store.since(mqtt.get().delivered, 1)?.is_empty() {
            patience -= 1;
            tokio::time::sleep(Duration::from_millis(100)).await;
        }
    } else {
        println!("ready");
        // The program that started this one ends it by closing its input.
        tokio::task::spawn_blocking(|| std::io::stdin().read_to_end(&mut Vec::new())).await??;
    }
    stop.send(true)?;
    while let Some(ended) = running.join_next().await {
        ended??;
    }
    println!("{}", serde_json::to_string(&mqtt.get())?);
    Ok(())
}
