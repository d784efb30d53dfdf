//! Standard output and standard error: what cannot be written there stops no work and ends in a plain error.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::{Mutex, PoisonError};

use crate::cli::printing::failure::Failure;

/// Why nothing more is written to standard output; `None` while it takes everything.
static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Prints a line to standard output, with its colours where they are shown.
macro_rules! say {
    ($($text:tt)*) => {
        $crate::cli::printing::terminal::line(format_args!($($text)*))
    };
}
pub(crate) use say;

/// Prints a line to standard output.
pub(crate) fn line(text: Arguments<'_>) {
    put(|| writeln!(anstream::stdout(), "{text}"));
}

/// Writes bytes to standard output as they are.
pub(crate) fn bytes(bytes: &[u8]) {
    put(|| io::stdout().write_all(bytes));
}

/// Prints clap's answer: help and version to standard output, what is wrong with the command line to standard error.
pub(crate) fn page(answer: &clap::Error) {
    match answer.use_stderr() {
        // Where even that fails the message is lost.
        true => drop(answer.print()),
        false => put(|| answer.print()),
    }
}

/// Prints a line to standard error; where even that fails the message is lost.
pub(crate) fn complain(text: Arguments<'_>) {
    let _ = writeln!(anstream::stderr(), "{text}");
}

/// Lets what was printed so far out, before something goes to standard error.
pub(crate) fn flush() {
    put(|| io::stdout().flush());
}

/// Whether the reader of standard output has gone, as behind `| head`.
pub(crate) fn is_closed() -> bool {
    failed().is_some()
}

/// The end of standard output: everything is written now, or the reason why not. A reader that closes the pipe early is no error.
///
/// # Errors
/// A disk that is full, or whatever else the system said.
pub(crate) fn finish() -> Result<(), Failure> {
    flush();
    match failed().take() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::Output(error)),
        _ => Ok(()),
    }
}

fn put(write: impl FnOnce() -> io::Result<()>) {
    let mut failed = failed();
    if failed.is_none() {
        *failed = write().err();
    }
}

fn failed() -> std::sync::MutexGuard<'static, Option<io::Error>> {
    FAILED.lock().unwrap_or_else(PoisonError::into_inner)
}
