//! The pictures of the documentation.

use std::time::Duration;

use serde_json::json;

use super::page::Page;
use crate::server::{Server, root};

/// Time for charts to fill.
const FILL: Duration = Duration::from_secs(4);

/// Takes all of them.
pub async fn all(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.size(1500, 1000).await;
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    tokio::time::sleep(FILL).await;
    page.turn("fault-Rs").await;
    page.until_lamps("run r1 r4 fault").await;
    tokio::time::sleep(FILL / 2).await;
    whole(page, "panel-live", 1500).await;
    scheme(page, "dark").await;
    whole(page, "panel-dark", 1500).await;
    page.size(3840, 2160).await;
    take(page, "panel-large").await;
    scheme(page, "light").await;
    whole(page, "panel-narrow", 360).await;
    page.click("#faults-off").await;
    page.until_lamps("run").await;
    parameters(page).await;
    calibrated(page).await;
    replay(page).await;
    page.size(1400, 1000).await;
}

/// The words at a field.
async fn parameters(page: &Page) {
    page.size(1200, 800).await;
    page.fill("#field-parameters-stator_leakage_henry", "-0.02")
        .await;
    page.click("#parameters button[type=submit]").await;
    page.until(
        "the error",
        "document.querySelector('#fields [aria-invalid=true]')",
    )
    .await;
    page.run("document.querySelector('#parameters-card').scrollIntoView({block: 'center'})")
        .await;
    take(page, "panel-parameters").await;
}

/// Cause, phase and size.
async fn calibrated(page: &Page) {
    let server = Server::start(&[
        "--motor",
        "motors/assumed-300w-calibrated.toml",
        "--speed",
        "2",
    ]);
    page.size(1400, 800).await;
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    tokio::time::sleep(FILL / 2).await;
    page.fill("#fault-size", "100").await;
    page.click("#faults-card summary").await;
    page.turn("fault-Rsa").await;
    page.until(
        "the cause",
        "document.querySelector('#causes [data-cause=Rs]')",
    )
    .await;
    tokio::time::sleep(FILL / 2).await;
    page.run("scrollTo(0, 0)").await;
    take(page, "panel-calibrated").await;
    drop(server);
}

/// The desk with its recordings; the columns of the first are open.
pub async fn desk(page: &Page) {
    page.run("document.querySelector('[data-slot=\"0\"] .mapping').open = true")
        .await;
    whole(page, "panel-workbench-load", 1500).await;
    page.size(1400, 1000).await;
}

/// The upper part of an answer.
pub async fn answer(page: &Page, name: &str) {
    page.size(1500, 1400).await;
    page.run(
        "document.querySelector('#answer').scrollIntoView({block: 'start', behavior: 'instant'})",
    )
    .await;
    tokio::time::sleep(Duration::from_millis(800)).await;
    take(page, name).await;
    page.size(1400, 1000).await;
}

/// What is in view from an element on, 1200 pixels wide.
pub async fn part(page: &Page, css: &str, name: &str, height: u32) {
    page.size(1200, height).await;
    // The page's own smooth scrolling ends first, and the figures take the new width.
    tokio::time::sleep(Duration::from_millis(1200)).await;
    let scroll = format!(
        "document.querySelector('{css}').scrollIntoView({{block: 'start', behavior: 'instant'}})"
    );
    page.run(&scroll).await;
    take(page, name).await;
    page.size(1400, 1000).await;
}

/// The desk on a telephone, dark.
pub async fn narrow_bench(page: &Page) {
    scheme(page, "dark").await;
    whole(page, "panel-workbench-narrow", 360).await;
    scheme(page, "light").await;
    page.size(1400, 1000).await;
}

async fn replay(page: &Page) {
    let peer = "tests/data/peer/supply-unbalance/recording.csv.gz";
    let server = Server::start(&[
        "--replay",
        peer,
        "--motor",
        "motors/peer-2k2.toml",
        "--speed",
        "0.5",
    ]);
    page.go(&server.url()).await;
    tokio::time::sleep(FILL / 2).await;
    whole(page, "panel-replay", 1500).await;
    drop(server);
}

async fn scheme(page: &Page, value: &str) {
    let features = json!({"features": [{"name": "prefers-color-scheme", "value": value}]});
    page.devtools("Emulation.setEmulatedMedia", features).await;
    tokio::time::sleep(Duration::from_millis(300)).await;
}

/// The page from top to bottom.
pub async fn whole(page: &Page, name: &str, width: u32) {
    page.size(width, 900).await;
    tokio::time::sleep(Duration::from_millis(400)).await;
    let height = page
        .run("return document.documentElement.scrollHeight")
        .await;
    page.size(width, height.as_u64().unwrap_or(900) as u32)
        .await;
    take(page, name).await;
}

async fn take(page: &Page, name: &str) {
    page.run("document.activeElement?.blur(); scrollTo(0, scrollY)")
        .await;
    tokio::time::sleep(Duration::from_millis(400)).await;
    let path = root().join(format!("docs/images/{name}.png"));
    std::fs::write(path, page.picture().await).expect("written");
}
