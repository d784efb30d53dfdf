//! Windows and the samples around alarms as files.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use formats::{sidecar_text, write_csv, write_parquet};
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::record::RecordWriter;
use recording::Recording;

use crate::running::history::HistoryRow;
use crate::running::session::Session;
use crate::running::shared::locked;

/// `windows.csv`, `windows.parquet` or `windows.json`: the last two minutes.
pub async fn windows(State(session): State<Arc<Session>>, Path(format): Path<String>) -> Response {
    let rows = session.history();
    let content = match format.as_str() {
        "csv" => table(&rows),
        "json" => serde_json::to_vec(&rows).map_err(|error| error.to_string()),
        "parquet" => parquet_of(&rows).map_err(|error| error.to_string()),
        _ => return nothing(),
    };
    file(&format!("windows.{format}"), content)
}

/// `recording.csv`, `recording.parquet`, or the sidecar `recording.toml` of the samples around an alarm.
pub async fn around(
    State(session): State<Arc<Session>>,
    Path((id, format)): Path<(u64, String)>,
) -> Response {
    // Copied, so that the source does not wait until it is written.
    let found = locked(&session.shared.events).recording(id).cloned();
    let Some(recording) = found else {
        return nothing();
    };
    let content = match format.as_str() {
        "csv" => plain(&recording),
        "toml" => Ok(sidecar_text(&recording.metadata).into_bytes()),
        "parquet" => columnar(&recording),
        _ => return nothing(),
    };
    file(&format!("alarm-{id}.{format}"), content)
}

fn nothing() -> Response {
    let why = "no such file; only the latest alarms keep their samples\n";
    (StatusCode::NOT_FOUND, why).into_response()
}

fn file(name: &str, content: Result<Vec<u8>, String>) -> Response {
    let kind = match name.rsplit('.').next() {
        Some("csv") => "text/csv; charset=utf-8",
        Some("json") => "application/json",
        Some("toml") => "application/toml",
        _ => "application/octet-stream",
    };
    let disposition = format!("attachment; filename=\"{name}\"");
    match content {
        Ok(content) => (
            [
                (CONTENT_TYPE, kind.to_owned()),
                (CONTENT_DISPOSITION, disposition),
            ],
            content,
        )
            .into_response(),
        Err(why) => (StatusCode::INTERNAL_SERVER_ERROR, why).into_response(),
    }
}

fn plain(recording: &Recording) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    write_csv(recording, &mut content).map_err(|error| error.to_string())?;
    Ok(content)
}

fn columnar(recording: &Recording) -> Result<Vec<u8>, String> {
    let mut content = Vec::new();
    write_parquet(recording, &mut content).map_err(|error| error.to_string())?;
    Ok(content)
}

/// A line per window; what is not known is left empty.
fn table(rows: &[HistoryRow]) -> Result<Vec<u8>, String> {
    let mut lines = csv::Writer::from_writer(Vec::new());
    for row in rows {
        lines.serialize(row).map_err(|error| error.to_string())?;
    }
    lines.into_inner().map_err(|error| error.to_string())
}

fn parquet_of<R>(rows: &[R]) -> Result<Vec<u8>, ParquetError>
where
    for<'r> &'r [R]: RecordWriter<R>,
{
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .build();
    let mut content = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut content, rows.schema()?, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    rows.write_to_row_group(&mut group)?;
    group.close()?;
    writer.close()?;
    Ok(content)
}
