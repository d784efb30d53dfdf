//! What the configuration says of metrics: `[metrics]`.

use document::{Bounds, Section};

/// Metrics for Prometheus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetricsConfig {
    /// Motors that have series of their own, in the order of names; the others are in the sums of the plant only.
    pub motors: u32,
}

const MOTORS: Bounds = Bounds::between(0.0, 100_000.0, "motors");

impl Default for MetricsConfig {
    fn default() -> MetricsConfig {
        MetricsConfig { motors: 2_000 }
    }
}

impl MetricsConfig {
    /// Reads `[metrics]`. `None` after a problem, which is reported.
    pub fn read(section: Section<'_>) -> Option<MetricsConfig> {
        let usual = MetricsConfig::default();
        let motors = section.integer_or("motors", &MOTORS, usual.motors);
        section.finish();
        Some(MetricsConfig { motors: motors? })
    }
}
