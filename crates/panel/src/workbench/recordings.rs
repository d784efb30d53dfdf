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
use crate::running::shared::Refusal;

/// What goes with a file.
#[derive(Debug, Deserialize)]
pub(super) struct Named {
    name: String,
    /// Whether a sidecar follows: the file is read when that is there.
    #[serde(default)]
    sidecar_follows: bool,
}

/// Which file is meant, by the number that the state gives it: another page may have put another one there.
#[derive(Debug, Deserialize)]
pub(super) struct Meant {
    id: u64,
}

/// What goes with a sidecar.
#[derive(Debug, Deserialize)]
pub(super) struct Sidecar {
    name: String,
    id: u64,
}

/// A recording, in any format that is read. What lay there stays until the new one is whole and read.
pub(super) async fn file(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    Query(named): Query<Named>,
    headers: HeaderMap,
    body: Body,
) -> Response {
    let made = received(&bench, slot, &named, &headers, body).await;
    let (made, before) = match made {
        Ok((made, before)) if named.sidecar_follows => (made, before),
        Ok((made, before)) => match read(&bench, slot, made).await {
            Ok(made) => (made, before),
            Err(refusal) => return refused(&refusal),
        },
        Err(refusal) => return refused(&refusal),
    };
    place(&bench, slot, made, before).await
}

/// The file, unread, and the number of the one that it is to replace.
async fn received(
    bench: &Bench,
    slot: usize,
    named: &Named,
    headers: &HeaderMap,
    body: Body,
) -> Result<(Slot, Option<u64>), Refusal> {
    known(slot)?;
    let (folder, before) = begin(bench, slot)?;
    let stored = store(&folder, &bench.budget, &named.name, headers, body).await?;
    let mut desk = bench.desk();
    desk.files += 1;
    Ok((Slot::new(desk.files, stored), before))
}

/// The sidecar of the recording in a slot.
pub(super) async fn sidecar(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    Query(Sidecar { name, id }): Query<Sidecar>,
    body: Bytes,
) -> Response {
    let written = present(&bench, slot, id).and_then(|mut present| {
        let folder = present.file.path.with_file_name("sidecar");
        let path = folder.join(harmless(&name));
        let done = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, &body));
        done.map_err(|error| Refusal::of(format!("{name}: cannot be kept: {error}")))?;
        present.sidecar = Some(path);
        Ok(present)
    });
    read_again(&bench, slot, written).await
}

/// How the columns of the recording in a slot are to be read.
pub(super) async fn mapping(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    Query(Meant { id }): Query<Meant>,
    body: Result<Json<Columns>, JsonRejection>,
) -> Response {
    let columns = body.map_err(|error| Refusal::of(error.body_text()));
    let changed = columns.and_then(|Json(columns)| {
        let present = present(&bench, slot, id)?;
        Ok(Slot { columns, ..present })
    });
    read_again(&bench, slot, changed).await
}

/// Takes a recording off the desk.
pub(super) async fn remove(
    State(bench): State<Arc<Bench>>,
    Path(slot): Path<usize>,
    Query(Meant { id }): Query<Meant>,
) -> Response {
    let done = known(slot).and_then(|()| put(&bench, slot, None, Some(id)));
    answer(&bench, done)
}

async fn read_again(bench: &Arc<Bench>, slot: usize, changed: Result<Slot, Refusal>) -> Response {
    let made = match changed {
        Ok(changed) => read(bench, slot, changed).await,
        Err(refusal) => Err(refusal),
    };
    match made {
        Ok(made) => {
            let before = Some(made.id);
            place(bench, slot, made, before).await
        }
        Err(refusal) => refused(&refusal),
    }
}

/// Reads beside the server's thread: the lamps go on. One file at a time, with what the others leave of the memory.
async fn read(bench: &Bench, slot: usize, made: Slot) -> Result<Slot, Refusal> {
    let _one = bench.reading.lock().await;
    let left = bench.desk().numbers_left(slot);
    let reading = tokio::task::spawn_blocking(move || made.read(left));
    reading
        .await
        .map_err(|_| Refusal::of("the file cannot be read: the reader broke off"))
}

/// Puts a recording on the desk in the place of `before`, audits it there, and answers with it.
async fn place(bench: &Arc<Bench>, slot: usize, made: Slot, before: Option<u64>) -> Response {
    let id = made.id;
    let done = put(bench, slot, Some(made), before);
    if done.is_ok() {
        let shared = bench.clone();
        // A panic would leave the recording without findings.
        let _ = tokio::task::spawn_blocking(move || shared.audit_missing()).await;
    }
    // An upload's answer never shows a file that another page put there meanwhile.
    let done = done.and_then(|()| present(bench, slot, id).map(drop));
    answer(bench, done)
}

fn put(bench: &Bench, slot: usize, made: Option<Slot>, before: Option<u64>) -> Result<(), Refusal> {
    let mut desk = bench.free_desk()?;
    if desk.slots[slot].as_ref().map(|there| there.id) != before {
        return Err(overtaken());
    }
    desk.slots[slot] = made;
    desk.results.clear();
    desk.job.problem = None;
    Ok(())
}

/// The file in a slot, if it still is the one that is meant.
fn present(bench: &Bench, slot: usize, id: u64) -> Result<Slot, Refusal> {
    known(slot)?;
    let present = bench.free_desk()?.slots[slot].clone();
    let present = present.ok_or_else(|| Refusal::of("load a recording first"))?;
    match present.id == id {
        true => Ok(present),
        false => Err(overtaken()),
    }
}

fn overtaken() -> Refusal {
    Refusal {
        status: 409,
        ..Refusal::of(
            "another page has meanwhile changed this place: look at what lies there now, then load yours again",
        )
    }
}

fn known(slot: usize) -> Result<(), Refusal> {
    match slot < SLOTS {
        true => Ok(()),
        false => Err(Refusal::of("there are two places for recordings, 0 and 1")),
    }
}

/// The folder of the desk, and the number of the file that lies in a slot now.
fn begin(bench: &Bench, slot: usize) -> Result<(PathBuf, Option<u64>), Refusal> {
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
    let path = folder.path().to_owned();
    Ok((path, desk.slots[slot].as_ref().map(|there| there.id)))
}
