//! Metrics for Prometheus.

mod config;
mod render;
mod router;
mod text;

pub use config::MetricsConfig;
pub use render::{Output, PageState, Plant, STALE_MS, render};
pub use router::{Source, router, run};
