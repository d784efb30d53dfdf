//! What the configuration says of the output to a broker: `[mqtt]`.

use std::path::{Path, PathBuf};

use document::{Bounds, Section};

use crate::sparkplug::{Names, check_identifier};

/// The output to a broker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MqttConfig {
    /// Name of its cursor in the store.
    pub sink: String,
    /// The broker's name or address.
    pub host: String,
    /// Its port.
    pub port: u16,
    /// A second broker of the plant, taken in turns with the first whenever a session ends.
    pub second: Option<(String, u16)>,
    /// TLS; `None`: the line is not encrypted.
    pub tls: Option<TlsConfig>,
    /// Group and edge node of Sparkplug.
    pub names: Names,
    /// Name of this client at the broker.
    pub client_id: String,
    /// User and file with the password.
    pub user: Option<(String, PathBuf)>,
    /// Host application without which nothing is sent.
    pub primary_host: Option<String>,
    /// Longest silence, s, before the broker is asked whether it is there.
    pub keep_alive_s: u16,
    /// Most entries that are sent before the broker's answer is awaited.
    pub batch: u32,
    /// File that keeps the number of the last session (`bdSeq`) over restarts.
    pub session_file: Option<PathBuf>,
}

/// TLS to the broker.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TlsConfig {
    /// Certificates of the authorities that are believed, PEM; `None`: those of the system.
    pub ca_file: Option<PathBuf>,
    /// What this client shows of itself; `None`: nothing.
    pub own: Option<OwnCertificate>,
}

/// A certificate of this client with its key, PEM.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnCertificate {
    /// The certificate, and behind it those that lead to the authority.
    pub certificate_file: PathBuf,
    /// Its private key.
    pub key_file: PathBuf,
}

const PORT: Bounds = Bounds::between(1.0, 65_535.0, "");
const KEEP_ALIVE_S: Bounds = Bounds::between(5.0, 3_600.0, "s");
const BATCH: Bounds = Bounds::between(1.0, 10_000.0, "entries");

impl MqttConfig {
    /// A node of a group at a broker, everything else as it is usual.
    pub fn new(host: &str, port: u16, names: Names) -> MqttConfig {
        MqttConfig {
            sink: "mqtt".to_owned(),
            host: host.to_owned(),
            port,
            second: None,
            tls: None,
            client_id: format!("drivemon-{}", names.node()),
            names,
            user: None,
            primary_host: None,
            keep_alive_s: 30,
            batch: 500,
            session_file: None,
        }
    }

    /// Name and port of the broker whose turn it is.
    pub(super) fn broker(&self, turn: usize) -> (&str, u16) {
        match &self.second {
            Some((host, port)) if turn % 2 == 1 => (host, *port),
            _ => (&self.host, self.port),
        }
    }

    /// Reads `[mqtt]`; paths are relative to `folder`. `None` after a problem, which is reported.
    pub fn read(section: Section<'_>, folder: &Path) -> Option<MqttConfig> {
        let config = read(&section, folder);
        section.finish();
        config
    }
}

fn read(section: &Section<'_>, folder: &Path) -> Option<MqttConfig> {
    let host = section.text("host", "name or address of the broker");
    let tls = tls(section, folder);
    let usual = if matches!(tls, Some(Some(_))) {
        8883
    } else {
        1883
    };
    let port = section.integer_or("port", &PORT, usual);
    let second = second(section, usual);
    let names = names(section);
    let client_id = section.optional_text("client_id");
    let user = user(section, folder);
    let primary_host = identifier(section, "primary_host");
    let keep_alive_s = section.integer_or("keep_alive_s", &KEEP_ALIVE_S, 30);
    let batch = section.integer_or("batch", &BATCH, 500);
    let session_file = section.optional_text("session_file");
    let base = MqttConfig::new(&host?, u16::try_from(port?).ok()?, names?);
    Some(MqttConfig {
        second: second?,
        tls: tls?,
        client_id: client_id?.unwrap_or_else(|| base.client_id.clone()),
        user: user?,
        primary_host: primary_host?,
        keep_alive_s: u16::try_from(keep_alive_s?).ok()?,
        batch: batch?,
        session_file: session_file?.map(|file| folder.join(file)),
        ..base
    })
}

fn second(section: &Section<'_>, usual: u32) -> Option<Option<(String, u16)>> {
    let host = section.optional_text("second_host")?;
    let port = section.integer_or("second_port", &PORT, usual)?;
    let port = u16::try_from(port).ok()?;
    Some(host.map(|host| (host, port)))
}

fn names(section: &Section<'_>) -> Option<Names> {
    let group = section.text("group", "group of Sparkplug");
    let node = section.text("node", "name of this gateway as an edge node of Sparkplug");
    let (group, node) = (group?, node?);
    let fits = |key: &str, text: &str| match check_identifier(text) {
        Ok(()) => Some(()),
        Err(error) => {
            section.report(key, error.to_string());
            None
        }
    };
    let (group_fits, node_fits) = (fits("group", &group), fits("node", &node));
    group_fits.and(node_fits)?;
    Names::new(&group, &node).ok()
}

fn identifier(section: &Section<'_>, key: &str) -> Option<Option<String>> {
    let text = section.optional_text(key)?;
    if let Some(Err(error)) = text.as_deref().map(check_identifier) {
        section.report(key, error.to_string());
        return None;
    }
    Some(text)
}

fn tls(section: &Section<'_>, folder: &Path) -> Option<Option<TlsConfig>> {
    let wanted = section.flag_or("tls", false);
    let ca_file = section.optional_text("ca_file")?;
    let own = own_certificate(section, folder);
    if ca_file.is_some() && wanted == Some(false) {
        section.report("ca_file", "is only used with TLS: write `tls = true` too");
        return None;
    }
    let ca_file = ca_file.map(|file| folder.join(file));
    let own = own?;
    if own.is_some() && wanted == Some(false) {
        section.report(
            "certificate_file",
            "is only used with TLS: write `tls = true` too",
        );
        return None;
    }
    Some(wanted?.then_some(TlsConfig { ca_file, own }))
}

fn own_certificate(section: &Section<'_>, folder: &Path) -> Option<Option<OwnCertificate>> {
    let certificate = section.optional_text("certificate_file")?;
    let key = section.optional_text("key_file")?;
    match (certificate, key) {
        (None, None) => Some(None),
        (Some(certificate), Some(key)) => Some(Some(OwnCertificate {
            certificate_file: folder.join(certificate),
            key_file: folder.join(key),
        })),
        (Some(_), None) => {
            section.report(
                "certificate_file",
                "needs `key_file` too, the private key that belongs to it",
            );
            None
        }
        (None, Some(_)) => {
            section.report("key_file", "needs `certificate_file` too");
            None
        }
    }
}

/// A password stands in a file of its own, which the configuration names: the configuration is shown and sent around.
fn user(section: &Section<'_>, folder: &Path) -> Option<Option<(String, PathBuf)>> {
    let user = section.optional_text("user")?;
    let file = section.optional_text("password_file")?;
    match (user, file) {
        (None, None) => Some(None),
        (Some(user), Some(file)) => Some(Some((user, folder.join(file)))),
        (Some(_), None) => {
            section.report(
                "user",
                "needs `password_file`, a file with the password in its first line",
            );
            None
        }
        (None, Some(_)) => {
            section.report("password_file", "needs `user` too");
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use document::{Document, FileError};

    fn parse(text: &str) -> Result<MqttConfig, FileError> {
        let document = Document::parse(text, "plant.toml")?;
        let root = document.root();
        let config = root
            .section("mqtt", "the broker")
            .and_then(|section| MqttConfig::read(section, Path::new("/etc/plant")));
        root.finish();
        document.finish(config)
    }

    #[test]
    fn little_is_enough() {
        let text = "[mqtt]\nhost = \"broker\"\ngroup = \"Plant 1\"\nnode = \"hall-3\"\n";
        let config = parse(text).expect("it is right");
        let names = Names::new("Plant 1", "hall-3").expect("they are right");
        assert_eq!(config, MqttConfig::new("broker", 1883, names));
    }

    #[test]
    fn everything_can_be_said() {
        let text = "[mqtt]\nhost = \"broker\"\ngroup = \"p\"\nnode = \"n\"\ntls = true\nca_file = \"ca.pem\"\nuser = \"u\"\n\
                    password_file = \"/run/password\"\nprimary_host = \"scada\"\nkeep_alive_s = 60\nbatch = 7\nclient_id = \"c\"\n\
                    session_file = \"bdseq\"\n";
        let text = format!(
            "{text}certificate_file = \"own.pem\"\nkey_file = \"own.key\"\nsecond_host = \"broker-b\"\n"
        );
        let config = parse(&text).expect("it is right");
        assert_eq!(config.port, 8883);
        let turns = [0, 1, 2].map(|turn| config.broker(turn));
        assert_eq!(
            turns,
            [("broker", 8883), ("broker-b", 8883), ("broker", 8883)]
        );
        let own = config.tls.as_ref().and_then(|tls| tls.own.as_ref());
        let key = own.map(|own| own.key_file.clone());
        assert_eq!(key, Some(PathBuf::from("/etc/plant/own.key")));
        let ca = config.tls.and_then(|tls| tls.ca_file);
        assert_eq!(ca, Some(PathBuf::from("/etc/plant/ca.pem")));
        let user = ("u".to_owned(), PathBuf::from("/run/password"));
        assert_eq!(config.user, Some(user));
        assert_eq!(config.primary_host.as_deref(), Some("scada"));
        assert_eq!((config.keep_alive_s, config.batch), (60, 7));
    }

    #[test]
    fn every_problem_has_its_line_and_remedy() {
        let text = "[mqtt]\nhost = \"broker\"\ngroup = \"a/b\"\nnode = \"n+\"\nca_file = \"ca.pem\"\nuser = \"u\"\nkeepalive_s = 60\n";
        let text = format!("{text}certificate_file = \"own.pem\"\n");
        let error = parse(&text).expect_err("six slips").to_string();
        for part in [
            "plant.toml:3",
            "plant.toml:4",
            "no `+`, `/`, `#`",
            "plant.toml:5",
            "tls = true",
            "plant.toml:6",
            "password_file",
            "plant.toml:7",
            "did you mean `keep_alive_s`?",
            "plant.toml:8",
            "key_file",
        ] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
