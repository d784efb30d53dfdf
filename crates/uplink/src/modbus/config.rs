//! What the configuration says of the Modbus server: `[modbus]`.

use std::net::SocketAddr;

use document::{Bounds, Section};

use super::Layout;

/// The Modbus server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModbusConfig {
    /// Address and port to listen at.
    pub listen: SocketAddr,
    /// Where each motor's registers are.
    pub layout: Layout,
    /// Most masters at once.
    pub connections: u32,
    /// Silence after which a master's line is closed, s.
    pub idle_s: u32,
}

const CONNECTIONS: Bounds = Bounds::between(1.0, 1_000.0, "masters");
const IDLE_S: Bounds = Bounds::between(1.0, 86_400.0, "s");

impl ModbusConfig {
    /// A server at an address, everything else as it is usual.
    pub fn new(listen: SocketAddr) -> ModbusConfig {
        ModbusConfig {
            listen,
            layout: Layout::Own,
            connections: 32,
            idle_s: 120,
        }
    }

    /// Reads `[modbus]`. `None` after a problem, which is reported.
    pub fn read(section: Section<'_>) -> Option<ModbusConfig> {
        let listen = listen(&section);
        let layouts = [("own", Layout::Own), ("shared", Layout::Shared)];
        let layout = section.choice_or("units", &layouts, Layout::Own);
        let connections = section.integer_or("connections", &CONNECTIONS, 32);
        let idle_s = section.integer_or("idle_s", &IDLE_S, 120);
        section.finish();
        Some(ModbusConfig {
            listen: listen?,
            layout: layout?,
            connections: connections?,
            idle_s: idle_s?,
        })
    }
}

fn listen(section: &Section<'_>) -> Option<SocketAddr> {
    let text = section.text("listen", "address and port, as \"127.0.0.1:502\"")?;
    match text.parse() {
        Ok(address) => Some(address),
        Err(_) => {
            section.report(
                "listen",
                format!("\"{text}\" is no address with a port: write one as \"127.0.0.1:502\""),
            );
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use document::{Document, FileError};

    fn parse(text: &str) -> Result<ModbusConfig, FileError> {
        let document = Document::parse(text, "plant.toml")?;
        let root = document.root();
        let config = root
            .section("modbus", "the server")
            .and_then(ModbusConfig::read);
        root.finish();
        document.finish(config)
    }

    #[test]
    fn an_address_is_enough() {
        let config = parse("[modbus]\nlisten = \"[::1]:1502\"\n").expect("it is right");
        assert_eq!(config.listen.port(), 1502);
        assert_eq!(config, ModbusConfig::new(config.listen));
    }

    #[test]
    fn problems_have_line_and_remedy() {
        let error = parse("[modbus]\nlisten = \"502\"\nidle_s = 0\nunits = \"all\"\n")
            .expect_err("three slips")
            .to_string();
        for part in [
            "plant.toml:2",
            "127.0.0.1:502",
            "plant.toml:3",
            "at least 1",
        ] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
}
