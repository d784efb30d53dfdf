//! A drive engineer at the workbench: a recording that the model does not fit, and how it comes to fit.

use std::path::PathBuf;

use motor::MotorFile;
use serde_json::json;

use super::page::Page;
use super::shots;
use crate::server::{Server, root};

const PEER: &str = "tests/data/peer/magnetizing-saturation";

fn peer(name: &str) -> PathBuf {
    let path = root().join(PEER).join(name);
    path.canonicalize().expect(name)
}

/// Whether an answer is shown, with its figures.
pub(super) async fn answered(page: &Page, kind: &str) {
    let shown = format!(
        "document.querySelector('#answer').dataset.kind === '{kind}' && document.querySelectorAll('#answer canvas').length > 0"
    );
    page.until(kind, &shown).await;
}

/// Load, compare, click, explain, adopt, save, undo; `pictures` are taken on the way.
pub async fn a_hidden_effect_is_found_and_adopted(page: &Page, pictures: bool) {
    let server = Server::start(&[]);
    page.go(&server.url()).await;
    page.click("#tab-workbench").await;
    page.until("the desk", "document.querySelector('#motor-file')")
        .await;
    a_bad_file_is_answered(page).await;
    page.choose("#motor-file", &[peer("recording.toml")]).await;
    page.until(
        "words at the input",
        "document.querySelector('#motor-file').getAttribute('aria-invalid') === 'true'",
    )
    .await;
    let said = page.text("#motor-file-problem").await;
    assert!(said.contains("recording.toml"), "{said}");
    page.choose(
        "#file-0",
        &[peer("recording.csv.gz"), peer("recording.toml")],
    )
    .await;
    page.until(
        "the first recording",
        "document.querySelector('[data-slot=\"0\"] .file-name b').textContent === 'recording.csv.gz'",
    )
    .await;
    page.choose(
        "#file-1",
        &[peer("recording_b.csv.gz"), peer("recording_b.toml")],
    )
    .await;
    page.until(
        "the second recording",
        "document.querySelector('[data-slot=\"1\"] .holds')",
    )
    .await;
    page.choose("#motor-file", &[peer("motor.toml")]).await;
    page.until(
        "the motor file",
        "document.querySelector('#save-motor')?.download === 'motor.toml'",
    )
    .await;
    let refused = page
        .run("return document.querySelectorAll('.findings .refuses').length")
        .await;
    assert_eq!(refused, 0, "audited with the motor's own nameplate");
    if pictures {
        shots::desk(page).await;
    }
    page.click("#ask-compare").await;
    answered(page, "compare").await;
    a_region_shows_its_traces(page).await;
    if pictures {
        shots::answer(page, "panel-workbench-compare").await;
    }
    page.click("#ask-explain").await;
    page.click("#job-stop").await;
    page.until(
        "the stopped question",
        "document.querySelector('.ask .what').textContent.startsWith('Stopped')",
    )
    .await;
    answered(page, "compare").await;
    page.click("#answer [data-ask=explain]").await;
    answered(page, "explain").await;
    assert!(
        page.text("#answer .verdict strong")
            .await
            .contains("magnetizing-saturation")
    );
    if pictures {
        shots::answer(page, "panel-workbench-explain").await;
    }
    page.click("#answer [data-ask=adopt]").await;
    answered(page, "adopt").await;
    the_error_has_fallen(page).await;
    if pictures {
        shots::answer(page, "panel-workbench-adopt").await;
    }
    let motor = the_motor_file_is_saved(page, "motor-magnetizing-saturation.toml").await;
    assert_eq!(motor.effects.len(), 1);
    page.click("#undo").await;
    page.until(
        "the motor file before",
        "document.querySelector('#save-motor')?.download === 'motor.toml'",
    )
    .await;
    if pictures {
        shots::narrow_bench(page).await;
    }
}

/// The reader's words, the rows as they are, and a form to say what they mean.
async fn a_bad_file_is_answered(page: &Page) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("foreign.csv");
    let rows = (0..40).map(|k| format!("{},{},{},{}\n", f64::from(k) / 1000.0, k, 2 * k, -3 * k));
    std::fs::write(
        &file,
        format!("laufnr,kanalx,kanaly,kanalz\n{}", rows.collect::<String>()),
    )
    .expect("written");
    page.choose("#file-0", &[file]).await;
    page.until(
        "the reader's words",
        "document.querySelector('[data-slot=\"0\"] .problem')",
    )
    .await;
    let said = page.text("[data-slot='0'] .problem").await;
    assert!(said.contains("foreign.csv:1"), "{said}");
    for (channel, column) in [
        ("t", "laufnr"),
        ("ia", "kanalx"),
        ("ib", "kanaly"),
        ("ic", "kanalz"),
    ] {
        page.run(&format!(
            "document.querySelector('#slot-0-column-{channel}').value = '{column}'"
        ))
        .await;
    }
    page.click("[data-slot='0'] form button[type=submit]").await;
    page.until(
        "a recording",
        "document.querySelector('[data-slot=\"0\"] .holds')",
    )
    .await;
    let holds = page.text("[data-slot='0'] .holds").await;
    assert!(holds.ends_with("ia, ib, ic"), "{holds}");
}

async fn a_region_shows_its_traces(page: &Page) {
    for css in [
        "#answer [aria-labelledby=compare-heat] button.region",
        "#answer [aria-labelledby=compare-regions] tr:nth-child(14) button.region",
    ] {
        let before = page.text(".region-note").await;
        page.click(css).await;
        let another = format!(
            "document.querySelector('.region-note').textContent !== {}",
            json!(before)
        );
        page.until("other traces", &another).await;
        assert!(page.text(".region-note").await.starts_with("Now shown"));
    }
    page.until(
        "a heading with its time",
        "document.querySelector('#answer figure h3').textContent.endsWith(' s')",
    )
    .await;
}

pub(super) async fn the_error_has_fallen(page: &Page) {
    let figures = "return [...document.querySelectorAll('#answer .cards .figure data')].map((figure) => Number(figure.value))";
    let errors: Vec<f64> = serde_json::from_value(page.run(figures).await).expect("numbers");
    // Held out before and after, fitted before and after, times the noise.
    assert!(errors[0] > 1.6 && errors[1] < 1.1, "{errors:?}");
    let drawn = "return document.querySelector('#answer .bars .chosen i').getBoundingClientRect().width / \
                 document.querySelector('#answer .bars tr:not(.chosen) i').getBoundingClientRect().width";
    let share = page.run(drawn).await.as_f64().unwrap_or(1.0);
    assert!((0.3..0.7).contains(&share), "the bars show it too: {share}");
}

pub(super) async fn the_motor_file_is_saved(page: &Page, name: &str) -> MotorFile {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("saved")
        .join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    let to = json!({"behavior": "allow", "downloadPath": folder});
    page.devtools("Browser.setDownloadBehavior", to).await;
    page.click("#save-motor").await;
    let file = folder.join(name);
    let begin = std::time::Instant::now();
    while !file.exists() {
        assert!(begin.elapsed().as_secs() < 20, "no file was saved");
        tokio::time::sleep(std::time::Duration::from_millis(100)).await;
    }
    MotorFile::read(&file).expect("a motor file")
}
