//! What the page and the server cost at 10 kHz and 50 windows a second, and with a long recording on the workbench.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::page::Page;
use crate::server::{Server, root};

/// Time over which rates are counted.
const OVER: Duration = Duration::from_secs(10);

/// Processor time that a process has used, s; only where the system has /proc.
fn processor_s(id: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    let fields: Vec<&str> = stat.rsplit(") ").next()?.split(' ').collect();
    let ticks = |k: usize| fields.get(k)?.parse::<f64>().ok();
    // utime and stime, the fourteenth and fifteenth field of all, in ticks of 10 ms.
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

/// Prints windows and frames a second, and the server's share of a core.
pub async fn rates(page: &Page) {
    let server = Server::start(&["--motor", "motors/peer-2k2.toml"]);
    page.size(1600, 1000).await;
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    page.run(
        "window.frames_ = 0; window.windows_ = 0; const count = () => { window.frames_ += 1; requestAnimationFrame(count); }; count(); \
         new EventSource('/api/stream').addEventListener('window', () => (window.windows_ += 1));",
    )
    .await;
    let (begin, used) = (Instant::now(), processor_s(server.id()));
    tokio::time::sleep(OVER).await;
    let seconds = begin.elapsed().as_secs_f64();
    let count = |name: &str| format!("return window.{name}");
    let frames = page.run(&count("frames_")).await.as_f64().unwrap_or(0.0);
    let windows = page.run(&count("windows_")).await.as_f64().unwrap_or(0.0);
    println!(
        "page: {:.0} frames a second, {:.1} windows a second",
        frames / seconds,
        windows / seconds
    );
    if let Some((before, after)) = used.zip(processor_s(server.id())) {
        println!(
            "server: {:.1} % of a core, two readers, simulation included",
            100.0 * (after - before) / seconds
        );
    }
}

/// Writes a start with load steps, 5 s at 10 kHz: time, six phase quantities, speed and torque.
fn long_recording(folder: &Path) -> PathBuf {
    let shipped = root().join("sim-host/scenarios/direct-on-line-start.toml");
    let text = std::fs::read_to_string(&shipped).expect("it is shipped");
    let motor = root()
        .join("motors/peer-2k2.toml")
        .canonicalize()
        .expect("it is shipped");
    let text = text
        .replace("duration_s = 4.0", "duration_s = 5.0")
        .replace("../../motors/peer-2k2.toml", &motor.display().to_string());
    let scenario = folder.join("scenario.toml");
    std::fs::write(&scenario, text).expect("written");
    let recording = folder.join("long.csv");
    let status = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .arg("simulate")
        .arg(&scenario)
        .arg("-o")
        .arg(&recording)
        .status()
        .expect("it runs");
    assert!(status.success());
    recording
}

/// A chart of the answer is zoomed by dragging, again and again, and put back by a double click; every frame is timed.
async fn frames_while_zooming(page: &Page, chart: usize) -> Vec<f64> {
    let box_of = format!(
        "const over = document.querySelectorAll('#answer .u-over')[{chart}]; over.scrollIntoView({{ block: 'center' }}); \
         const r = over.getBoundingClientRect(); return [r.x, r.y, r.width, r.height];"
    );
    let place = page.run(&box_of).await;
    let [x, y, width, height] =
        [0, 1, 2, 3].map(|k| place[k].as_f64().expect("a chart with a place"));
    page.run(
        "window.frames_ = []; let last = performance.now(); window.counting_ = true; \
         const tick = () => { const now = performance.now(); window.frames_.push(now - last); last = now; \
         if (window.counting_) requestAnimationFrame(tick); }; requestAnimationFrame(tick);",
    )
    .await;
    for _ in 0..5 {
        for (from, to) in [(0.1, 0.6), (0.3, 0.7), (0.2, 0.9)] {
            drag(page, [x + from * width, x + to * width], y + 0.5 * height).await;
        }
        for clicks in [1, 2] {
            for kind in ["mousePressed", "mouseReleased"] {
                mouse(page, kind, [x + 0.5 * width, y + 0.5 * height], clicks).await;
            }
        }
    }
    let frames = page
        .run("window.counting_ = false; return window.frames_")
        .await;
    let frames = frames.as_array().cloned().unwrap_or_default();
    frames.iter().filter_map(Value::as_f64).collect()
}

fn report_frames(chart: &Value, mut frames: Vec<f64>) {
    frames.sort_by(f64::total_cmp);
    let at = |share: f64| frames[(share * (frames.len() - 1) as f64).round() as usize];
    println!(
        "{chart}: {} frames while zooming, median {:.1} ms, 99 of 100 below {:.1} ms, longest {:.1} ms",
        frames.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
}

async fn mouse(page: &Page, kind: &str, [x, y]: [f64; 2], clicks: u32) {
    let buttons = u32::from(kind != "mouseReleased");
    let event = json!({"type": kind, "x": x, "y": y, "button": "left", "buttons": buttons, "clickCount": clicks});
    page.devtools("Input.dispatchMouseEvent", event).await;
}

/// From the one to the other in twelve steps, as a hand does.
async fn drag(page: &Page, [from, to]: [f64; 2], y: f64) {
    mouse(page, "mousePressed", [from, y], 1).await;
    for k in 1..=12 {
        let x = from + (to - from) * f64::from(k) / 12.0;
        mouse(page, "mouseMoved", [x, y], 0).await;
    }
    mouse(page, "mouseReleased", [to, y], 1).await;
}

/// Prints how long a recording of 5 s at 10 kHz takes to open, and how evenly its traces are zoomed.
pub async fn workbench(page: &Page) {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = long_recording(folder.path());
    let server = Server::start(&["--motor", "motors/peer-2k2.toml"]);
    page.size(1600, 1000).await;
    page.go(&server.url()).await;
    page.click("#tab-workbench").await;
    page.until("the desk", "document.querySelector('#file-0')")
        .await;
    let begin = Instant::now();
    page.choose("#file-0", &[recording]).await;
    page.until(
        "the recording",
        "document.querySelector('[data-slot=\"0\"] .holds')",
    )
    .await;
    let opened = begin.elapsed().as_secs_f64();
    println!(
        "{}: open after {opened:.2} s",
        page.text("[data-slot=\"0\"] .holds").await
    );
    page.click("#ask-compare").await;
    page.until(
        "traces",
        "document.querySelectorAll('#answer .u-over').length > 0",
    )
    .await;
    println!("compared after {:.2} s", begin.elapsed().as_secs_f64());
    for chart in 0..4 {
        let title =
            format!("return document.querySelectorAll('#answer figure h3')[{chart}].textContent");
        let title = page.run(&title).await;
        report_frames(&title, frames_while_zooming(page, chart).await);
    }
}
