//! The page of a plant in a real browser.

use std::time::{Duration, Instant};

use base64::Engine;
use serde_json::{Value, json};

use super::processes::Plant;
use super::recording::opens_in_explain;
use crate::browser::{Page, visit};
use crate::server::root;

/// From the end of the second in which a board's FAULT lit until it is on the wall.
const ON_THE_WALL: Duration = Duration::from_secs(2);
const BOARDS: u32 = 200;

#[test]
fn a_fault_on_one_of_200_boards_is_on_the_wall_acknowledged_by_name_still_so_after_a_restart_and_explained()
 {
    visit(|page| async move {
        let mut plant = Plant::start(BOARDS, 1, 45);
        let token = plant.token("Anna", "acknowledge");
        let server = plant.page();
        page.size(1280, 800).await;
        page.go(&server.url()).await;
        page.until("every motor known", "document.querySelectorAll('#wall li').length === 200 && !document.querySelector('.tile[data-condition=never]')").await;
        let took = fault_to_wall(&page, &plant).await;
        eprintln!(
            "FAULT on 1 of {BOARDS} boards was on the wall {} ms after its second had ended",
            took.as_millis()
        );
        assert!(took < ON_THE_WALL, "{took:?}");
        page.until("the alarm of it", "document.querySelector('#wall li:first-child .tile').dataset.alarm === 'unacknowledged'").await;
        acknowledge(&page, &token).await;
        plant.kill_gateway();
        let kept = server.port().to_owned();
        drop(server);
        plant.start_gateway();
        let file = plant.file("plant.toml").display().to_string();
        let again = crate::server::Server::start(&["--fleet", &file, "--port", &kept]);
        page.go(&again.url()).await;
        page.until("the acknowledged alarm", "document.querySelector('#wall li:first-child .tile')?.dataset.alarm === 'acknowledged'").await;
        named_in_the_events(&page).await;
        nothing_is_shown_of_a_motor_that_nobody_knows(&page).await;
        opens_in_explain(&plant, &again);
        drop(again);
        page.until("what is old is called so", "document.body.classList.contains('stale') && document.querySelector('#connection').textContent.startsWith('no connection')").await;
    });
}

/// From the truth of the boards to what a person sees.
async fn fault_to_wall(page: &Page, plant: &Plant) -> Duration {
    assert!(
        !plant.fault_is_lit(),
        "the board failed before the page was open: let it fail later"
    );
    let begin = Instant::now();
    while !plant.fault_is_lit() {
        assert!(
            begin.elapsed() < Duration::from_secs(150),
            "no board failed"
        );
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let lit = Instant::now();
    page.until(
        "the fault",
        "document.querySelector('#wall li:first-child .tile').dataset.condition === 'fault'",
    )
    .await;
    lit.elapsed()
}

/// A press that lasts while new data come is a press.
async fn a_button_outlives_new_data(page: &Page) {
    page.run(
        "window.aimed = document.querySelector('#alarms [data-action=acknowledge]');
         window.ago = aimed.closest('tr').textContent",
    )
    .await;
    page.until(
        "new data",
        "document.querySelector('#alarms tbody tr:first-child').textContent !== ago",
    )
    .await;
    let same = page.run("return aimed.isConnected").await;
    assert_eq!(same, true, "the button is another one");
}

async fn acknowledge(page: &Page, token: &str) {
    page.click("#tab-alarms").await;
    page.until(
        "the alarm",
        "document.querySelector('#alarms [data-action=acknowledge]')",
    )
    .await;
    a_button_outlives_new_data(page).await;
    // Nobody has signed in: the page asks who it is.
    page.click("#alarms [data-action=acknowledge]").await;
    page.until("the question", "document.querySelector('#sign-in').open")
        .await;
    page.fill("#token", "wrong").await;
    page.press("\u{E007}").await;
    page.until(
        "a refusal",
        "!document.querySelector('#sign-problem').hidden",
    )
    .await;
    page.fill("#token", token).await;
    page.press("\u{E007}").await;
    page.until(
        "Anna",
        "document.querySelector('#me').textContent.startsWith('Anna')",
    )
    .await;
    page.click("#alarms [data-action=acknowledge]").await;
    page.until("the dialog", "document.querySelector('#act').open")
        .await;
    page.fill("#act-why", "service is called").await;
    page.press("\u{E007}").await;
    page.until(
        "it is acknowledged",
        "document.querySelector('#alarms tbody tr:first-child').dataset.state === 'acknowledged'",
    )
    .await;
}

async fn named_in_the_events(page: &Page) {
    page.run("document.querySelector('#wall li:first-child .tile').click()")
        .await;
    page.until(
        "who acknowledged",
        "document.querySelector('#motor-events')?.textContent.includes('Anna: service is called')",
    )
    .await;
    page.until(
        "its history",
        "document.querySelectorAll('#trends .u-wrap').length === 4",
    )
    .await;
}

/// What was shown of the motor before goes, and comes back with it.
async fn nothing_is_shown_of_a_motor_that_nobody_knows(page: &Page) {
    const SEEN: &str = "document.querySelector('#motor-figures').offsetParent !== null && document.querySelector('#motor-events').offsetParent !== null";
    page.until("figures", SEEN).await;
    page.run("window.known_ = location.hash; location.hash = '#motor/nobody'")
        .await;
    page.until(
        "nothing but a title",
        "[...document.querySelector('#view-motor').children].every((part) => part.id === 'motor-state' || part.offsetParent === null) && document.querySelectorAll('#motor-lamps li').length === 0",
    )
    .await;
    page.run("location.hash = window.known_").await;
    page.until("the figures again", SEEN).await;
}

/// Motors of the pictures.
const MANY: u32 = 300;

#[test]
fn three_hundred_motors_fit_on_a_small_and_on_a_large_screen() {
    visit(|page| async move {
        let plant = Plant::start(MANY, 4, 20);
        let server = plant.page();
        page.size(1280, 800).await;
        page.go(&server.url()).await;
        page.until(
            "faults",
            "document.querySelectorAll('.tile[data-condition=fault]').length >= 3",
        )
        .await;
        for (name, width, height) in [("fleet-wall", 1280, 800), ("fleet-wall-4k", 3840, 2160)] {
            page.size(width, height).await;
            page.until("the new size", &format!("innerWidth === {width}"))
                .await;
            tokio::time::sleep(Duration::from_secs(1)).await;
            whole_wall(&page, name).await;
            picture(&page, name).await;
        }
        if std::env::var_os("UPDATE_SCREENSHOTS").is_some() {
            others(&page, &plant).await;
        }
        page.assert_silent().await;
    });
}

/// Every motor is in sight, no name is cut to nothing, and names of motors with a fault are large.
async fn whole_wall(page: &Page, name: &str) {
    let seen = page
        .run(
            "const tiles = [...document.querySelectorAll('#wall .tile')];
             const boxes = tiles.map((tile) => tile.getBoundingClientRect());
             const names = [...document.querySelectorAll('.large .tile[data-condition=fault] .name')].map((name) => parseFloat(getComputedStyle(name).fontSize));
             const small = [...document.querySelectorAll('#wall li:not(.large) .name')].map((name) => name.clientWidth);
             return { tiles: tiles.length, below: boxes.filter((box) => box.bottom > innerHeight + 1).length, across: document.documentElement.scrollWidth - innerWidth,
                      large: Math.min(...names), small: Math.min(...small), words: tiles.every((tile) => tile.getAttribute('aria-label').length > 8) };",
        )
        .await;
    eprintln!("{name}: {seen}");
    assert_eq!(
        (&seen["tiles"], &seen["below"], &seen["words"]),
        (&json!(MANY), &json!(0), &Value::Bool(true)),
        "{seen}"
    );
    assert!(
        seen["across"].as_f64() <= Some(0.0) && seen["small"].as_f64() > Some(10.0),
        "{seen}"
    );
}

async fn others(page: &Page, plant: &Plant) {
    let token = plant.token("Anna", "acknowledge");
    page.size(1280, 800).await;
    let signed = format!(
        "return fetch('/api/fleet/session', {{method: 'POST', headers: {{'content-type': 'application/json'}}, body: JSON.stringify({{token: '{token}'}})}}).then((answer) => answer.status)"
    );
    assert_eq!(page.run(&signed).await, json!(200));
    page.run("location.reload()").await;
    page.until(
        "Anna",
        "document.querySelector('#me').textContent.startsWith('Anna')",
    )
    .await;
    page.click("#tab-alarms").await;
    page.until(
        "alarms",
        "document.querySelectorAll('#alarms tbody tr').length >= 3",
    )
    .await;
    picture(page, "fleet-alarms").await;
    page.click("#tab-table").await;
    page.until(
        "numbers",
        "document.querySelectorAll('#motors tbody tr').length > 100",
    )
    .await;
    picture(page, "fleet-table").await;
    page.click("#tab-wall").await;
    page.run("document.querySelector('#wall li:first-child .tile').click()")
        .await;
    page.until(
        "its history",
        "document.querySelectorAll('#trends .u-wrap').length === 4",
    )
    .await;
    tokio::time::sleep(Duration::from_secs(3)).await;
    picture(page, "fleet-motor").await;
}

async fn picture(page: &Page, name: &str) {
    // Small, for a large screen too.
    let format = json!({"format": "webp", "quality": 85});
    let shot = page.devtools("Page.captureScreenshot", format).await;
    let data = shot["data"].as_str().expect("a picture");
    let engine = base64::engine::general_purpose::STANDARD;
    let picture = engine.decode(data).expect("base64");
    let folder = match std::env::var_os("UPDATE_SCREENSHOTS") {
        Some(_) => root().join("docs/images"),
        None => env!("CARGO_TARGET_TMPDIR").into(),
    };
    std::fs::write(folder.join(format!("{name}.webp")), picture).expect("written");
}
