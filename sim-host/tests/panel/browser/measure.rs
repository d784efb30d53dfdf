//! What the page and the server cost at 10 kHz and 50 windows a second.

use std::time::{Duration, Instant};

use super::page::Page;
use crate::server::Server;

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
