use super::{Bounds, Document, FileError, read_text};
use std::fmt::Write as _;
use std::time::{Duration, Instant};

/// A file of so many unknown sections, read by a reader that knows eight keys.
fn read(sections: usize) -> (FileError, Duration) {
    let mut text = String::new();
    for k in 0..sections {
        let _ = writeln!(text, "[a{k}]");
    }
    let begin = Instant::now();
    let document = Document::parse(&text, "f").expect("it is TOML");
    let root = document.root();
    for key in ["b", "c", "d", "e", "f", "g", "h", "i"] {
        let _ = root.optional_number(key, &Bounds::between(0.0, 1.0, ""));
    }
    root.finish();
    let error = document.finish(Some(())).expect_err("unknown sections");
    (error, begin.elapsed())
}

/// Ten times as many sections take some ten times as long, not a hundred times.
#[test]
fn many_sections_take_linear_time() {
    let (error, few) = read(9_000);
    assert_eq!(error.problems().len(), 9_000);
    let (error, many) = read(90_000);
    assert!(many < 40 * few, "{few:?} and {many:?}");
    let shown = error.to_string();
    assert_eq!(shown.lines().count(), 51);
    assert!(
        shown.ends_with("... and 89950 more problems"),
        "{}",
        &shown[shown.len() - 60..]
    );
}

#[test]
fn what_is_larger_than_any_configuration_is_refused_before_it_is_read() {
    let begin = Instant::now();
    let error = Document::parse(&"\n".repeat(8_000_000), "f").expect_err("too large");
    assert!(
        error.to_string().contains("more than 1048576 bytes"),
        "{error}"
    );
    // It took a minute.
    assert!(begin.elapsed() < Duration::from_secs(5));
}

/// A pipe does not tell its size.
#[cfg(unix)]
#[test]
fn a_stream_without_end_is_refused() {
    let error = read_text(std::path::Path::new("/dev/zero")).expect_err("too large");
    assert!(
        error.to_string().contains("more than 1048576 bytes"),
        "{error}"
    );
}
