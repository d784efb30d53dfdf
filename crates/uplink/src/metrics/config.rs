//! What the configuration says of metrics: `[metrics]`.

use std::net::{Ipv4Addr, SocketAddr};

use document::{Bounds, Section};

/// Metrics for Prometheus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetricsConfig {
    /// Address and port to listen at.
    pub listen: SocketAddr,
    /// Motors that have series of their own, in the order of names; the others are in the sums of the plant only.
    pub motors: u32,
}

/// Where nothing else is usual.
const PORT: u16 = 9184;
const MOTORS: Bounds = Bounds::between(0.0, 100_000.0, "motors");

impl Default for MetricsConfig {
    fn default() -> MetricsConfig {
        MetricsConfig {
            listen: (Ipv4Addr::LOCALHOST, PORT).into(),
            motors: 2_000,
        }
    }
}

impl MetricsConfig {
    /// Reads `[metrics]`. `None` after a problem, which is reported.
    pub fn read(section: Section<'_>) -> Option<MetricsConfig> {
        let usual = MetricsConfig::default();
        let listen = listen(&section, usual.listen);
        let motors = section.integer_or("motors", &MOTORS, usual.motors);
        section.finish();
        Some(MetricsConfig {
            listen: listen?,
            motors: motors?,
        })
    }
}

fn listen(section: &Section<'_>, usual: SocketAddr) -> Option<SocketAddr> {
    let Some(text) = section.optional_text("listen")? else {
        return Some(usual);
    };
    let address = text.parse().ok();
    if address.is_none() {
        section.report(
            "listen",
            format!("\"{text}\" is no address with a port: write one as \"{usual}\""),
        );
    }
    address
}
