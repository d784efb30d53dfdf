//! The page in a real browser, where one is installed.

use std::process::Command;

use crate::page::{Page, scratch};

const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Opens the page without a window: every figure is drawn, and the console stays silent.
pub fn check(page: &Page) {
    let Some(browser) = BROWSERS.into_iter().find(|name| is_installed(name)) else {
        eprintln!(
            "skipped: no Chromium is installed, {} was not opened",
            page.path
        );
        return;
    };
    let (dom, console) = open(browser, page);
    let figures = page.charts().len();
    assert_eq!(console, Vec::<String>::new(), "{}", page.path);
    assert!(
        dom.contains(&format!("data-charts=\"{figures}\"")),
        "{}",
        page.path
    );
    assert_eq!(dom.matches("<canvas").count(), figures, "{}", page.path);
}

fn is_installed(browser: &str) -> bool {
    let version = Command::new(browser).arg("--version").output();
    version.is_ok_and(|done| done.status.success())
}

/// The document after its scripts have run, and what they said to the console.
fn open(browser: &str, page: &Page) -> (String, Vec<String>) {
    let name = page.path.rsplit('/').next().unwrap_or_default();
    let profile = scratch(&format!("profile-{name}"));
    let done = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--enable-logging=stderr",
            "--window-size=1200,900",
            "--virtual-time-budget=4000",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={profile}"))
        .arg(format!("file://{}", page.path))
        .output()
        .expect("the browser starts");
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    let console = said.lines().filter(|line| line.contains(":CONSOLE"));
    let console = console.map(str::to_owned).collect();
    (String::from_utf8_lossy(&done.stdout).into_owned(), console)
}
