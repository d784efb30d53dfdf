//! The route `/metrics`. Who may ask is decided by the server that takes it in.

use std::io;
use std::sync::Arc;

use axum::Router;
use axum::extract::State;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use fleet::{Store, StoreError, now_ms};
use tokio::net::TcpListener;
use tokio::sync::watch;

use super::MetricsConfig;
use super::render::{Output, Plant, render};
use crate::modbus::ModbusStatus;
use crate::mqtt::MqttStatus;

/// Where the metrics come from.
#[derive(Clone)]
pub struct Source {
    /// The store.
    pub store: Arc<Store>,
    /// What is shown.
    pub config: MetricsConfig,
    /// Names of the outputs that have a cursor in the store.
    pub outputs: Vec<String>,
    /// The output to a broker.
    pub mqtt: Option<MqttStatus>,
    /// The Modbus server.
    pub modbus: Option<ModbusStatus>,
}

/// Answers at the address of the configuration until `stop` is true or its sender is gone.
///
/// # Errors
/// The address is taken, or may not be used.
pub async fn run(source: Source, mut stop: watch::Receiver<bool>) -> io::Result<()> {
    let listener = TcpListener::bind(source.config.listen).await?;
    let ended = async move {
        let _ = stop.wait_for(|stop| *stop).await;
    };
    let server = axum::serve(listener, router(source));
    server.with_graceful_shutdown(ended).await
}

/// `GET /metrics`.
pub fn router(source: Source) -> Router {
    Router::new()
        .route("/metrics", get(metrics))
        .with_state(Arc::new(source))
}

async fn metrics(State(source): State<Arc<Source>>) -> Response {
    // The store waits for the disk.
    let text = tokio::task::spawn_blocking(move || source.text()).await;
    match text {
        Ok(Ok(text)) => {
            let kind = "text/plain; version=0.0.4; charset=utf-8";
            ([(header::CONTENT_TYPE, kind)], text).into_response()
        }
        Ok(Err(error)) => (StatusCode::SERVICE_UNAVAILABLE, error.to_string()).into_response(),
        Err(_) => StatusCode::SERVICE_UNAVAILABLE.into_response(),
    }
}

impl Source {
    /// The metrics now.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn text(&self) -> Result<String, StoreError> {
        let now_ms = now_ms();
        let motors = self.store.motors()?;
        let outputs = self.outputs.iter().map(|name| self.output(name, now_ms));
        let outputs = outputs.collect::<Result<Vec<_>, _>>()?;
        let mqtt = self.mqtt.as_ref().map(MqttStatus::get);
        let modbus = self.modbus.as_ref().map(ModbusStatus::get);
        Ok(render(&Plant {
            motors: &motors,
            shown: self.config.motors as usize,
            outputs: &outputs,
            mqtt: mqtt.as_ref(),
            modbus: modbus.as_ref(),
            page: None,
            now_ms,
        }))
    }

    fn output(&self, name: &str, now_ms: i64) -> Result<Output, StoreError> {
        let delivered = self.store.cursor(name)?;
        let next = self.store.since(delivered, 1)?;
        let waiting = next
            .first()
            .map_or(0, |next| now_ms.saturating_sub(next.entry.time_ms()));
        Ok(Output {
            name: name.to_owned(),
            delivered,
            lag_s: waiting.max(0) as f64 / 1_000.0,
        })
    }
}
