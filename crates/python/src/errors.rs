//! Why there is no answer, as exceptions with place and remedy.

use discovery::Error as StudyError;
use document::FileError;
use pyo3::PyErr;
use recording::{Class, Error as RecordingError};
use report::study::MonitorError;

pyo3::import_exception!(drivemon._errors, InputError);
pyo3::import_exception!(drivemon._errors, UnsupportedError);

/// A problem as the exception takes it: file, line, column, message, remedy.
type Row = (String, u64, String, String, String);

/// What a person can put right.
pub fn usage(message: impl Into<String>) -> PyErr {
    InputError::new_err((message.into(), Vec::<Row>::new()))
}

/// Sound data that do not support an answer.
pub fn unsupported(message: impl Into<String>) -> PyErr {
    UnsupportedError::new_err((message.into(), Vec::<Row>::new()))
}

/// Data that do not support an answer, with the recording, the reason and the remedy.
pub fn unsupported_at(file: &str, message: &str, reason: &str, remedy: &str) -> PyErr {
    let row = row(file, 0, "", reason, remedy);
    UnsupportedError::new_err((message.to_owned(), vec![row]))
}

fn row(file: &str, line: u64, column: &str, message: &str, remedy: &str) -> Row {
    let [file, column, message, remedy] = [file, column, message, remedy].map(str::to_owned);
    (file, line, column, message, remedy)
}

/// A recording, a table or a sidecar.
pub fn of_recording(error: &RecordingError) -> PyErr {
    let rows = error.problems().iter();
    let rows: Vec<Row> = rows
        .map(|p| row(&p.file, p.line, &p.field, &p.message, &p.remedy))
        .collect();
    match error.class() {
        Class::BadInput => InputError::new_err((error.to_string(), rows)),
        Class::Unsupported => UnsupportedError::new_err((error.to_string(), rows)),
    }
}

/// A motor file, a scenario or a file of shapes. Its messages end with the remedy: `is missing: add ...`.
pub fn of_file(error: &FileError) -> PyErr {
    let rows = error.problems().iter();
    let rows: Vec<Row> = rows
        .map(|p| {
            let (message, remedy) = p.message.split_once(": ").unwrap_or((&p.message, ""));
            row(&p.file, p.line as u64, &p.key, message, remedy)
        })
        .collect();
    InputError::new_err((error.to_string(), rows))
}

/// Compare, explain and adopt.
pub fn of_study(error: &StudyError, recording: &str) -> PyErr {
    match error {
        StudyError::MotorFile(error) => of_file(error),
        StudyError::Unsupported(_, why) => {
            unsupported_at(recording, &error.to_string(), &why.reason, &why.remedy)
        }
        StudyError::Recordings(_) | StudyError::UnknownEffect(_) => usage(error.to_string()),
    }
}

/// A motor file that the core cannot take.
pub fn of_monitor(error: &MonitorError, file: &str) -> PyErr {
    match error {
        MonitorError::File(error) => of_file(error),
        MonitorError::Config(error) => usage(format!(
            "{file}: {error}; change the value in the motor file"
        )),
    }
}
