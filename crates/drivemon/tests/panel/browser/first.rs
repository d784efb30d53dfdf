//! A technician's first check of a motor: from an empty panel to the answer, every click counted.

use std::cell::Cell;
use std::path::PathBuf;

use serde_json::{Value, json};

use super::page::Page;
use super::shots;
use crate::server::{Server, root};

/// Clicks from the panel's start to the first answer: the goal.
const MOST_CLICKS: u32 = 10;
/// A motor of 0.75 hp with shorted turns, measured (tests/data/itsc_075hp).
const MEASURED: &str = "tests/data/itsc_075hp";
/// Its plate.
const PLATE: [(&str, &str); 6] = [
    ("name", "Compressor 1"),
    ("power_hp", "0.75"),
    ("voltage_volt", "230"),
    ("frequency_hz", "60"),
    ("speed_rpm", "1725"),
    ("current_amp", "2.6"),
];

fn measured(name: &str) -> PathBuf {
    let path = root().join(MEASURED).join(name);
    path.canonicalize().expect(name)
}

/// A hand that counts.
struct Hand<'p> {
    page: &'p Page,
    clicks: Cell<u32>,
}

impl Hand<'_> {
    async fn click(&self, css: &str) {
        self.clicks.set(self.clicks.get() + 1);
        self.page.click(css).await;
    }

    /// The input is clicked, and the file in the dialogue of the system.
    async fn choose(&self, css: &str, file: PathBuf) {
        self.clicks.set(self.clicks.get() + 2);
        self.page.choose(css, &[file]).await;
    }

    async fn answered(&self) {
        let shown = "document.querySelector('#first-answer').dataset.kind === 'check' && document.querySelectorAll('#first-answer canvas').length > 0";
        self.page.until("the answer", shown).await;
    }
}

async fn opened(page: &Page) -> (Server, Hand<'_>) {
    let server = Server::start(&[]);
    page.size(1400, 1000).await;
    page.go(&server.url()).await;
    let hand = Hand {
        page,
        clicks: Cell::new(0),
    };
    hand.click("#tab-first").await;
    page.until("the form", "document.querySelector('#plate-power_kw')")
        .await;
    (server, hand)
}

async fn plate(page: &Page, hand: &Hand<'_>, pictures: bool) {
    hand.click("#standard-nema").await;
    for (key, text) in PLATE {
        page.fill(&format!("#plate-{key}"), text).await;
    }
    page.until(
        "what the numbers come to",
        "document.querySelector('#plate-enough')",
    )
    .await;
    let expected = page.text("#plate-power_factor-hint").await;
    assert!(expected.starts_with("expected: 0."), "{expected}");
    if pictures {
        shots::part(page, "#view-first", "panel-first-plate", 640).await;
    }
    hand.click("#plate-continue").await;
    page.until("step 2", "document.querySelector('#first-file-0')")
        .await;
}

/// Shorted turns of a real motor: their phase is named within ten clicks; the next recording of it is in good order.
pub async fn a_real_fault_is_named_within_ten_clicks(page: &Page, pictures: bool) {
    let (_server, hand) = opened(page).await;
    plate(page, &hand, pictures).await;
    hand.choose("#first-file-0", measured("sc_a1_b0_c0_001.csv.gz"))
        .await;
    page.until("step 3", "document.querySelector('#healthy-this')")
        .await;
    hand.choose("#first-file-1", measured("sc_hlt_001.csv.gz"))
        .await;
    hand.answered().await;
    println!("clicks to the first answer: {}", hand.clicks.get());
    assert!(hand.clicks.get() <= MOST_CLICKS, "{}", hand.clicks.get());
    let cause = page.text("#first-answer .culprit").await;
    assert!(cause.starts_with("shorted turns, phase a"), "{cause}");
    words_are_those_of_the_server(page).await;
    what_is_saved(page).await;
    if pictures {
        shots::part(page, "#step-4", "panel-first-answer", 1000).await;
    }
    hand.click("#first-next").await;
    page.until(
        "an empty place",
        "document.querySelector('#step-2').dataset.state === 'now'",
    )
    .await;
    hand.choose("#first-file-0", measured("sc_hlt_002.csv.gz"))
        .await;
    page.until(
        "step 3",
        "document.querySelector('#step-3').dataset.state === 'now'",
    )
    .await;
    hand.click("#healthy-none").await;
    hand.answered().await;
    let told = page.text("#first-answer .told").await;
    assert!(told.starts_with("in good order"), "{told}");
    it_opens_in_the_workbench(page, &hand).await;
}

/// The page derives nothing: its words are those of the answer.
async fn words_are_those_of_the_server(page: &Page) {
    let answer = page
        .run("return fetch('/api/workbench/results/check').then((answer) => answer.json()).then(({ result }) => result.recordings[0].told)")
        .await;
    let shown = page
        .run("return document.querySelector('#first-answer').textContent")
        .await;
    let shown = shown.as_str().expect("text");
    for key in ["state", "cause", "sure", "severity"] {
        let words = answer[key].as_str().expect(key);
        assert!(shown.contains(words), "{words}");
    }
}

async fn what_is_saved(page: &Page) {
    let text = |css: &str| {
        format!(
            "return fetch(document.querySelector('{css}').href).then((answer) => answer.text())"
        )
    };
    let motor = page.run(&text("#first-save-motor")).await;
    let motor = motor::MotorFile::parse(motor.as_str().expect("text"), "saved").expect("a motor");
    assert!(motor.healthy.is_some() && motor.name == "Compressor 1");
    let report = page.run(&text("#first-save-report")).await;
    let report = report.as_str().expect("text").to_owned();
    assert!(report.starts_with("<!DOCTYPE html>") && report.contains("shorted turns, phase a"));
}

async fn it_opens_in_the_workbench(page: &Page, hand: &Hand<'_>) {
    hand.click("#first-workbench").await;
    page.until(
        "the recording on the desk",
        "document.querySelector('#view-workbench [data-slot=\"0\"] .file-name b')?.textContent === 'sc_hlt_002.csv.gz'",
    )
    .await;
    let file = page
        .run("return document.querySelector('#save-motor').download")
        .await;
    assert_eq!(file, Value::from("compressor-1.toml"));
}

/// What is wrong is said where it is wrong, and the path stays where it is.
pub async fn what_is_wrong_is_said_plainly(page: &Page) {
    let (_server, hand) = opened(page).await;
    hand.click("#plate-continue").await;
    page.until(
        "what is missing",
        "!document.querySelector('#plate-problem').hidden",
    )
    .await;
    let said = page.text("#plate-problem").await;
    assert!(said.contains("is missing"), "{said}");
    page.fill("#plate-power_kw", "5.5 kW").await;
    page.until(
        "words at the field",
        "document.querySelector('#plate-power_kw').getAttribute('aria-invalid') === 'true'",
    )
    .await;
    let odd = [
        ("power_kw", "5,5"),
        ("voltage_volt", "400"),
        ("frequency_hz", "50"),
        ("speed_rpm", "1455"),
        ("current_amp", "16"),
        ("power_factor", "0.85"),
        ("efficiency_percent", "89.2"),
    ];
    for (key, text) in odd {
        page.fill(&format!("#plate-{key}"), text).await;
    }
    page.until(
        "the contradiction",
        "document.querySelector('#plate-contradictions')?.textContent.includes('current 16')",
    )
    .await;
    page.fill("#plate-current_amp", "10.4").await;
    page.until(
        "no contradiction",
        "document.querySelector('#plate-enough')",
    )
    .await;
    // The keyboard alone: Enter goes on, and the focus goes with it.
    page.press("\u{e007}").await;
    page.until(
        "the focus at step 2",
        "document.activeElement?.id === 'step-2-title' && document.querySelector('#first-file-0')",
    )
    .await;
    wrong_files(page).await;
}

async fn wrong_files(page: &Page) {
    let readme = root().join("README.md").canonicalize().expect("it ships");
    page.choose("#first-file-0", &[readme]).await;
    page.until(
        "the reader's words",
        "document.querySelector('#step-2 .problem')?.textContent.includes('README.md')",
    )
    .await;
    let table = root().join("tests/data/imc_18k5_load_test/load_test.csv");
    page.choose("#first-file-0", &[table.canonicalize().expect("it ships")])
        .await;
    page.until(
        "no waveforms",
        "document.querySelector('#step-2 .problem')?.textContent.includes('load table')",
    )
    .await;
    assert_eq!(
        page.run("return document.querySelector('#step-3').dataset.state")
            .await,
        json!("later")
    );
    let clamp = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("clamp.csv");
    let row = |k: i32| {
        let t = f64::from(k) / 1000.0;
        format!("{t},{}\n", (314.159 * t).sin() * 14.0)
    };
    std::fs::write(
        &clamp,
        format!("t,ia\n{}", (0..2000).map(row).collect::<String>()),
    )
    .expect("written");
    page.choose("#first-file-0", &[clamp]).await;
    page.until(
        "what is missing",
        "document.querySelector('#step-2')?.textContent.includes('three currents')",
    )
    .await;
    page.click("#healthy-none").await;
    page.until(
        "an answer",
        "document.querySelector('#first-answer .told')?.textContent === 'not judged'",
    )
    .await;
    let said = page.text("#first-answer .verdict").await;
    assert!(
        said.contains("three voltages or three currents are needed"),
        "{said}"
    );
}
