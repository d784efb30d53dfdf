//! Requests about the recordings on the desk.

use std::path::PathBuf;
use std::sync::Arc;

use axum::Json;
use axum::body::{Body, Bytes};
use axum::extract::rejection::JsonRejection;
use axum::extract::{Path, Query, State};
use axum::http::HeaderMap;
use axum::response::Response;
use serde::Deserialize;

use super::desk::{Bench, SLOTS};
use super::mapping::Columns;
use super::slot::Slot;
use super::upload::{harmless, store};
use super::{answer, refused};
use crate::panel::session::Refusal;

/// What goes with a file.
#[derive(Debug, Deserialize)]
pub(super) struct Named {
    name: String,
    /// Whether a sidecar follows: the file is read when that is there.
    #[serde(default)]
    sidecar_follows: bool,
}

/// A recording, in any format that is read.
pub(super) async fn file(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    Query(named): Query<Named>,
    headers: HeaderMap,
    body: Body,
) -> Response {
    let stored = match folder(&bench, slot) {
        Ok(folder) => store(&folder, &named.name, &headers, body).await,
        Err(refusal) => Err(refusal),
    };
    let made = match stored {
        Ok(path) if named.sidecar_follows => Ok(Slot::new(path)),
        Ok(path) => read(Slot::new(path)).await,
        Err(refusal) => Err(refusal),
    };
    place(&bench, slot, made).await
}

/// The sidecar of the recording in a slot.
pub(super) async fn sidecar(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    Query(named): Query<Named>,
    body: Bytes,
) -> Response {
    let written = present(&bench, slot).and_then(|mut present| {
        let folder = present.path.with_file_name("sidecar");
        let path = folder.join(harmless(&named.name));
        let done = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, &body));
        done.map_err(|error| Refusal::of(format!("{}: cannot be kept: {error}", named.name)))?;
        present.sidecar = Some(path);
        Ok(present)
    });
    read_again(&bench, slot, written).await
}

/// How the columns of the recording in a slot are to be read.
pub(super) async fn mapping(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    body: Result<Json<Columns>, JsonRejection>,
) -> Response {
    let columns = body.map_err(|error| Refusal::of(error.body_text()));
    let changed = columns.and_then(|Json(columns)| {
        let present = present(&bench, slot)?;
        Ok(Slot { columns, ..present })
    });
    read_again(&bench, slot, changed).await
}

/// Takes a recording off the desk.
pub(super) async fn remove(State(bench): State<Arc<Bench>>, Path(slot): Path<usize>) -> Response {
    answer(&bench, known(slot).and_then(|()| put(&bench, slot, None)))
}

async fn read_again(bench: &Arc<Bench>, slot: usize, changed: Result<Slot, Refusal>) -> Response {
    let made = match changed {
        Ok(changed) => read(changed).await,
        Err(refusal) => return refused(&refusal),
    };
    place(bench, slot, made).await
}

/// Reads beside the server's thread: the lamps go on.
async fn read(slot: Slot) -> Result<Slot, Refusal> {
    let reading = tokio::task::spawn_blocking(move || slot.read());
    reading
        .await
        .map_err(|_| Refusal::of("the file cannot be read: the reader broke off"))
}

/// Puts a recording on the desk and audits it there.
async fn place(bench: &Arc<Bench>, slot: usize, made: Result<Slot, Refusal>) -> Response {
    let done = made.and_then(|made| put(bench, slot, Some(made)));
    if done.is_ok() {
        let shared = bench.clone();
        // A panic would leave the recording without findings.
        let _ = tokio::task::spawn_blocking(move || shared.audit_missing()).await;
    }
    answer(bench, done)
}

fn put(bench: &Bench, slot: usize, made: Option<Slot>) -> Result<(), Refusal> {
    let mut desk = bench.free_desk()?;
    desk.slots[slot] = made;
    desk.results.clear();
    desk.job.problem = None;
    Ok(())
}

fn present(bench: &Bench, slot: usize) -> Result<Slot, Refusal> {
    known(slot)?;
    let present = bench.free_desk()?.slots[slot].clone();
    present.ok_or_else(|| Refusal::of("load a recording first"))
}

fn known(slot: usize) -> Result<(), Refusal> {
    match slot < SLOTS {
        true => Ok(()),
        false => Err(Refusal::of("there are two places for recordings, 0 and 1")),
    }
}

/// The empty folder of a slot.
fn folder(bench: &Bench, slot: usize) -> Result<PathBuf, Refusal> {
    known(slot)?;
    let mut desk = bench.free_desk()?;
    let failed = |error: std::io::Error| Refusal::of(format!("no folder for files: {error}"));
    let folder = match &mut desk.folder {
        Some(folder) => folder,
        none => none.insert(
            tempfile::Builder::new()
                .prefix("drivemon-panel-")
                .tempdir()
                .map_err(failed)?,
        ),
    };
    let path = folder.path().join(format!("recording-{slot}"));
    // What lay there belongs to a recording that is replaced now.
    let _ = std::fs::remove_dir_all(&path);
    desk.slots[slot] = None;
    desk.results.clear();
    std::fs::create_dir_all(&path).map_err(failed)?;
    Ok(path)
}
