//! Links and names of tests on the pages lead somewhere.

use std::fs;
use std::path::Path;

use crate::{documents, root};

#[test]
fn links_lead_somewhere() {
    let mut links = 0;
    for (path, text) in documents() {
        let folder = path.parent().expect("in a folder");
        for target in text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split(')').next())
        {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            if file.contains("://") {
                continue;
            }
            links += 1;
            let target = if file.is_empty() {
                path.clone()
            } else {
                folder.join(file)
            };
            assert!(target.exists(), "{}: {file}", path.display());
            assert!(
                has_heading(&target, anchor),
                "{}: {file}#{anchor}",
                path.display()
            );
        }
    }
    assert!(links > 10, "only {links} links were found");
}

/// Whether a page has a heading with this anchor, as GitHub derives it.
fn has_heading(page: &Path, anchor: &str) -> bool {
    let slug = |line: &str| -> String {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title
            .chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    anchor.is_empty()
        || fs::read_to_string(page)
            .unwrap_or_default()
            .lines()
            .any(|line| line.starts_with('#') && slug(line) == anchor)
}

/// A name in backticks with three underscores or more is that of a test.
#[test]
fn every_test_that_the_theory_names_exists() {
    let theory =
        fs::read_to_string(root().join("docs/theory.md")).expect("part of the source tree");
    let mut sources = String::new();
    for folder in [
        "crates/motor",
        "crates/parity",
        "crates/scenario",
        "crates/monitor",
        "crates/drivemon/tests",
        "tests",
    ] {
        collect(&root().join(folder), &mut sources);
    }
    let is_name = |text: &&str| {
        let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        plain && text.matches('_').count() >= 3
    };
    let names: Vec<&str> = theory.split('`').filter(is_name).collect();
    assert!(names.len() >= 8, "{names:?}");
    for name in names {
        assert!(
            sources.contains(&format!("fn {name}(")),
            "{name} is no test"
        );
    }
}

fn collect(folder: &Path, into: &mut String) {
    for entry in fs::read_dir(folder).expect("part of the source tree") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            collect(&path, into);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            *into += &fs::read_to_string(&path).expect("UTF-8");
        }
    }
}
