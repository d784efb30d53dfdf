//! A functional mock-up unit (FMI 2.0): the C source, its description and, where there is a compiler, the library.

mod compile;
mod description;

use super::page::{filled, harmless};
use super::{File, Job, c};
use crate::ExportError;
use crate::model::Model;
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// The archive.
///
/// # Errors
/// An archive that cannot be packed.
pub fn files(model: &Model, job: &Job<'_>) -> Result<Vec<File>, ExportError> {
    let (source, header) = (c::source(model, job), c::header(model, job));
    let guid = guid(&[&source, &header]);
    let sources = [
        (format!("{}.c", job.name), source),
        (format!("{}.h", job.name), header),
        ("fmi2.c".to_owned(), around(model, job, &guid)),
    ];
    let mut entries: Vec<(String, Vec<u8>)> = vec![(
        "modelDescription.xml".to_owned(),
        description::description(model, job, &guid).into_bytes(),
    )];
    let remark = match compile::library(&job.name, &sources) {
        Ok(library) => {
            let remark = format!("Library for this computer: {}", library.path);
            entries.push((library.path, library.bytes));
            remark
        }
        Err(reason) => format!(
            "No library is in it, only its sources ({reason}): a tool that compiles sources can use it; or install a C compiler and export it again"
        ),
    };
    for (name, text) in sources {
        entries.push((format!("sources/{name}"), text.into_bytes()));
    }
    Ok(vec![File {
        content: packed(&entries).map_err(ExportError::Archive)?,
        remarks: vec![remark],
    }])
}

fn around(model: &Model, job: &Job<'_>, guid: &str) -> String {
    let starts: Vec<_> = model
        .inputs
        .iter()
        .map(|q| format!("{:?}", q.value))
        .collect();
    let (title, exchange, rates) = match model.held {
        Some(_) => ("", "", RATES_HELD),
        None => (
            " and model exchange",
            include_str!("../../../templates/fmi2_model_exchange.c"),
            "    @NAME@_derivatives(m->t, m->x, m->u, &p, dx);",
        ),
    };
    filled(
        include_str!("../../../templates/fmi2.c"),
        &[
            ("@MODEL_EXCHANGE@", exchange.to_owned()),
            ("@ME_TITLE@", title.to_owned()),
            ("@RATES@", rates.to_owned()),
            ("@INPUT_STARTS@", starts.join(", ")),
            ("@GUID@", guid.to_owned()),
            ("@NAME@", job.name.clone()),
            ("@TITLE@", harmless(&model.title)),
        ],
    )
}

const RATES_HELD: &str = "    double held[2];
    @NAME@_held_voltage(m->t, m->x, m->u, &p, held);
    @NAME@_derivatives(m->t, m->x, m->u, &p, held, dx);";

fn packed(entries: &[(String, Vec<u8>)]) -> Result<Vec<u8>, String> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // The time of packing is no part of the model: the same motor file gives the same bytes.
    let options = SimpleFileOptions::default().last_modified_time(zip::DateTime::default());
    for (name, bytes) in entries {
        archive
            .start_file(name.as_str(), options)
            .map_err(|error| error.to_string())?;
        archive
            .write_all(bytes)
            .map_err(|error| error.to_string())?;
    }
    let done = archive.finish().map_err(|error| error.to_string())?;
    Ok(done.into_inner())
}

/// A name of the model that changes with its content: twice the hash of Fowler, Noll and Vo (FNV-1a, 64 bits).
fn guid(texts: &[&str]) -> String {
    let hash = |seed: u64| {
        let bytes = texts.iter().flat_map(|text| text.bytes());
        bytes.fold(seed, |h, byte| {
            (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        })
    };
    let (a, b) = (hash(0xcbf2_9ce4_8422_2325), hash(0x6c62_272e_07bb_0142));
    format!(
        "{{{:08x}-{:04x}-{:04x}-{:04x}-{:012x}}}",
        a >> 32,
        (a >> 16) & 0xffff,
        a & 0xffff,
        b >> 48,
        b & 0xffff_ffff_ffff
    )
}
