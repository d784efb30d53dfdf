//! `drivemon panel --fleet`: the page of a plant.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use panel::Options;
use panel::fleet::{FleetError, Plant, Settings, bind, is_open};
use tokio::sync::watch;

use super::{LAST_WORK, open, told_to_end};
use crate::cli::printing::failure::{Failure, Finding};
use crate::cli::printing::terminal::say;

/// Shows a plant until the program is told to end.
pub(super) fn run(
    path: &Path,
    stale_s: u32,
    options: &Options,
    in_browser: bool,
) -> Result<Finding, Failure> {
    let settings = Settings {
        stale_ms: i64::from(stale_s) * 1_000,
        open: is_open(options),
    };
    let usage = |error: &dyn std::fmt::Display| Failure::Usage(error.to_string());
    let plant = Plant::open(&store(path)?, settings).map_err(|error| usage(&error))?;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let runtime = runtime.map_err(|error| usage(&format!("no server can be started: {error}")))?;
    let served = runtime.block_on(serve(plant, options, in_browser));
    // A question that is still being answered must not hold the end up.
    runtime.shutdown_timeout(LAST_WORK);
    served.map_err(|error| usage(&error))?;
    Ok(Finding::Nothing)
}

#[cfg(feature = "gateway")]
fn store(path: &Path) -> Result<PathBuf, Failure> {
    gateway::config::Config::store_of(path).map_err(Failure::File)
}

/// Without a gateway in this program nobody reads its configuration.
#[cfg(not(feature = "gateway"))]
fn store(path: &Path) -> Result<PathBuf, Failure> {
    Ok(path.to_owned())
}

async fn serve(plant: Arc<Plant>, options: &Options, in_browser: bool) -> Result<(), FleetError> {
    let running = bind(options, plant).await?;
    let url = running.url();
    say!("panel: {url}   (Ctrl-C ends it)");
    if in_browser {
        open(&url);
    }
    let (end, ended) = watch::channel(false);
    tokio::spawn(async move {
        told_to_end().await;
        let _ = end.send(true);
    });
    running.serve(ended).await;
    Ok(())
}
