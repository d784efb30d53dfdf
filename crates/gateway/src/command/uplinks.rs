//! What a gateway hands on: Sparkplug B to a broker, registers for Modbus masters, metrics for Prometheus.

use std::convert::Infallible;
use std::future::Future;
use std::path::Path;
use std::time::Duration;

use document::Section;
use tokio::sync::watch;
use uplink::metrics::{self, MetricsConfig, Source};
use uplink::modbus::{self, ModbusConfig, ModbusStatus};
use uplink::mqtt::{self, MqttConfig, MqttStatus};

use super::outputs::{Handles, Outputs};
use super::terminal::Terminal;

/// How often the line to a broker is looked at: its changes are for people.
const LOOK: Duration = Duration::from_secs(1);

/// The outputs of a configuration; each is there where its section is.
#[derive(Debug)]
pub struct Uplinks {
    mqtt: Option<MqttConfig>,
    modbus: Option<ModbusConfig>,
    metrics: Option<MetricsConfig>,
}

/// A section that may be absent. `None` after a problem.
fn optional<T>(
    root: &Section<'_>,
    key: &str,
    read: impl FnOnce(Section<'_>) -> Option<T>,
) -> Option<Option<T>> {
    match root.optional_section(key)? {
        Some(section) => read(section).map(Some),
        None => Some(None),
    }
}

impl Outputs for Uplinks {
    fn read(root: &Section<'_>, folder: &Path) -> Option<Self> {
        let mqtt = optional(root, "mqtt", |section| MqttConfig::read(section, folder));
        let modbus = optional(root, "modbus", ModbusConfig::read);
        let metrics = optional(root, "metrics", MetricsConfig::read);
        Some(Uplinks {
            mqtt: mqtt?,
            modbus: modbus?,
            metrics: metrics?,
        })
    }

    fn names(&self) -> Vec<String> {
        self.mqtt.iter().map(|mqtt| mqtt.sink.clone()).collect()
    }

    fn described(&self) -> Vec<String> {
        let mqtt = self.mqtt.as_ref().map(|mqtt| {
            let tls = if mqtt.tls.is_some() { ", TLS" } else { "" };
            let names = &mqtt.names;
            let (group, node) = (names.group(), names.node());
            format!(
                "mqtt: Sparkplug B, group {group}, node {node}, to {}:{}{tls}",
                mqtt.host, mqtt.port
            )
        });
        let modbus = self
            .modbus
            .as_ref()
            .map(|modbus| format!("modbus: every motor for masters at {}", modbus.listen));
        let metrics = self
            .metrics
            .as_ref()
            .map(|metrics| format!("metrics: http://{}/metrics", metrics.listen));
        let all: Vec<String> = mqtt.into_iter().chain(modbus).chain(metrics).collect();
        match all.is_empty() {
            true => vec!["outputs: none".to_owned()],
            false => all,
        }
    }

    fn to_change(&self) -> Vec<String> {
        let checked = self.mqtt.as_ref().map(mqtt::check_files);
        let wrong = checked.and_then(Result::err);
        wrong
            .map(|error| format!("mqtt: {error}"))
            .into_iter()
            .collect()
    }

    async fn run(self, handles: Handles) -> String {
        let outputs = self.names();
        let (mqtt, modbus) = (MqttStatus::default(), ModbusStatus::default());
        let source = self.metrics.map(|config| Source {
            store: handles.store.clone(),
            config,
            outputs,
            mqtt: self.mqtt.is_some().then(|| mqtt.clone()),
            modbus: self.modbus.is_some().then(|| modbus.clone()),
        });
        let ended = || handles.ended.clone();
        let broker = async {
            let Some(mut config) = self.mqtt else {
                return at_the_end(ended()).await;
            };
            let store = handles.store.clone();
            let beside = || store.path().with_extension("mqtt-session");
            config.session_file.get_or_insert_with(beside);
            let told = tell_line(mqtt.clone(), handles.terminal);
            let done = mqtt::run(config, store, mqtt, handles.stored.clone(), ended());
            tokio::select! {
                done = done => done.err().map(|error| error.to_string()),
                never = told => match never {},
            }
        };
        let masters = async {
            let Some(config) = self.modbus else {
                return at_the_end(ended()).await;
            };
            let done = modbus::run(config, handles.store.clone(), modbus, ended()).await;
            done.err().map(|error| error.to_string())
        };
        let scraped = async {
            let Some(source) = source else {
                return at_the_end(ended()).await;
            };
            let address = source.config.listen;
            let done = metrics::run(source, ended()).await;
            done.err()
                .map(|error| format!("metrics at {address}: {error}"))
        };
        all_of(broker, masters, scraped).await
    }
}

/// Says when the line to a broker comes, and why there is none.
async fn tell_line(status: MqttStatus, terminal: Terminal) -> Infallible {
    let mut told = None;
    loop {
        let state = status.get();
        let line = match (state.connected, state.last_error.as_str()) {
            (true, _) => Some("mqtt: connected".to_owned()),
            // The first attempt is still on its way.
            (false, "") => None,
            (false, why) => Some(format!(
                "mqtt: no line to the broker, the store keeps what it has not taken: {why}"
            )),
        };
        if line.is_some() && line != told {
            line.iter().for_each(|line| (terminal.complain)(line));
            told = line;
        }
        tokio::time::sleep(LOOK).await;
    }
}

/// An output that is not configured ends with the gateway.
async fn at_the_end(mut ended: watch::Receiver<bool>) -> Option<String> {
    // A gateway that was dropped has ended, too.
    let _ = ended.wait_for(|ended| *ended).await;
    None
}

/// Ends with the first output that cannot go on, saying why, or when all have ended.
async fn all_of(
    broker: impl Future<Output = Option<String>>,
    masters: impl Future<Output = Option<String>>,
    scraped: impl Future<Output = Option<String>>,
) -> String {
    let or_error = |why: Option<String>| why.map_or(Ok(()), Err);
    let done = tokio::try_join!(
        async { or_error(broker.await) },
        async { or_error(masters.await) },
        async { or_error(scraped.await) },
    );
    done.err().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use document::{Document, FileError};

    fn described(text: &str) -> Result<Vec<String>, FileError> {
        let document = Document::parse(text, "plant.toml")?;
        let root = document.root();
        let uplinks = Uplinks::read(&root, Path::new("/etc/plant"));
        root.finish();
        let uplinks = document.finish(uplinks)?;
        let mut told = uplinks.names();
        told.extend(uplinks.described());
        Ok(told)
    }

    #[test]
    fn each_output_is_there_where_its_section_is() {
        let alone = described("[metrics]\nlisten = \"[::1]:80\"\n").expect("sound");
        assert_eq!(alone, ["metrics: http://[::1]:80/metrics"]);
        let text = "[mqtt]\nhost = \"broker\"\ngroup = \"Hall\"\nnode = \"gw\"\ntls = true\n\
                    [modbus]\nlisten = \"0.0.0.0:502\"\n[metrics]\n";
        let expected = [
            "mqtt",
            "mqtt: Sparkplug B, group Hall, node gw, to broker:8883, TLS",
            "modbus: every motor for masters at 0.0.0.0:502",
            "metrics: http://127.0.0.1:9184/metrics",
        ];
        assert_eq!(described(text).expect("sound"), expected);
    }

    #[test]
    fn a_certificate_that_is_not_there_is_to_change() {
        let text = "[mqtt]\nhost = \"broker\"\ngroup = \"Hall\"\nnode = \"gw\"\ntls = true\nca_file = \"none.pem\"\n";
        let document = Document::parse(text, "plant.toml").expect("TOML");
        let uplinks = Uplinks::read(&document.root(), Path::new("/etc/plant")).expect("sound");
        let wrong = uplinks.to_change();
        assert!(
            wrong.len() == 1
                && wrong
                    .iter()
                    .all(|line| line.starts_with("mqtt: /etc/plant/none.pem: ")),
            "{wrong:?}"
        );
    }

    #[test]
    fn what_is_wrong_in_several_outputs_is_told_at_once() {
        let text = "[mqtt]\nhost = \"broker\"\ngroup = \"Hall\"\n[modbus]\nlisten = \"502\"\n[metrics]\nport = 9\n";
        let told = described(text).expect_err("wrong").to_string();
        for part in ["mqtt.node", "plant.toml:5: modbus.listen", "metrics.port"] {
            assert!(told.contains(part), "{part}: {told}");
        }
    }
}
