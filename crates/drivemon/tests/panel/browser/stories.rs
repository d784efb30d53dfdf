//! What people come to the panel for.

use monitor::TABLE_1;

use super::page::Page;
use crate::server::Server;

/// As `drivemon demo` measures it on the full motor: Table 1, but for a rotor inductance, which there shows r1 and r4.
fn expected(name: &str, pattern: [bool; 4]) -> String {
    let pattern = if name == "Lr" {
        [true, false, false, true]
    } else {
        pattern
    };
    let residuals = (1..).zip(pattern).filter(|(_, on)| *on);
    let mut lit = vec!["run".to_owned()];
    lit.extend(residuals.map(|(k, _)| format!("r{k}")));
    if matches!(name, "Iq" | "wr") {
        lit.push("sensor".into());
    }
    lit.push("fault".into());
    lit.join(" ")
}

/// Each row of Table 1 is switched on and off.
pub async fn faults_light_their_lamps_and_go_dark(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    assert_eq!(page.text("#state-title").await, "Healthy");
    for (fault, pattern) in TABLE_1 {
        let name = fault.name();
        page.turn(&format!("fault-{name}")).await;
        page.until_lamps(&expected(name, pattern)).await;
        page.until(
            "the headline",
            "document.querySelector('#state-title').textContent === 'Fault'",
        )
        .await;
        if name != "Lr" {
            leads(page, name).await;
        }
        page.turn(&format!("fault-{name}")).await;
        page.until_lamps("run").await;
    }
    page.until(
        "dark causes",
        "document.querySelector('#causes').childElementCount === 0",
    )
    .await;
    page.until(
        "an event for each",
        "document.querySelectorAll('#events tbody tr').length === 9",
    )
    .await;
    page.until(
        "samples of each",
        "document.querySelectorAll('#events a[href$=csv]').length === 9",
    )
    .await;
    both_directions_and_beyond_the_table(page).await;
}

/// The cause is the likeliest, alone or among those that cannot be told apart from it.
async fn leads(page: &Page, name: &str) {
    let first = format!("document.querySelector('#causes li:first-child [data-cause={name}]')");
    page.until(&format!("{name} among the likeliest"), &first)
        .await;
    let shown = page
        .run("return [...document.querySelectorAll('#causes li:first-child .cause b')].map((b) => b.textContent)")
        .await;
    let shown: Vec<String> = serde_json::from_value(shown).expect("texts");
    let number = |percent: &String| -> f64 {
        let text = percent.trim_end_matches(" %").trim_start_matches("> ");
        text.parse().expect("a number")
    };
    let percents: Vec<f64> = shown.iter().map(number).collect();
    // One meaning of a tie everywhere: half a decade; shown without decimals.
    let least = percents[0] / f64::from(monitor::TIE_RATIO) - 1.0;
    assert!(percents.iter().all(|p| *p >= least), "{name}: {shown:?}");
    // Tied rows share what a lone one has: 94 %, 48 %, or on the weak inductance some 20 %.
    assert!(percents.iter().sum::<f64>() > 45.0, "{name}: {shown:?}");
}

async fn both_directions_and_beyond_the_table(page: &Page) {
    page.fill("#fault-size", "-50").await;
    page.turn("fault-Bl").await;
    page.until_lamps("run r2 r3 r4 fault").await;
    page.click("#faults-off").await;
    page.until_lamps("run").await;
    page.fill("#fault-size", "-100").await;
    page.click("#faults-card summary").await;
    page.turn("fault-ia").await;
    page.until_lamps("sensor fault").await;
    // Said once, with what to do about it, and named as the cause.
    let shows = |css: &str, text: &str| {
        format!("document.querySelector(\"{css}\").innerText.trim().includes(\"{text}\")")
    };
    let reason = shows("#state-why", "Current sensor a is dead.");
    page.until("the reason", &reason).await;
    assert_eq!(page.text("#state-why").await, "Current sensor a is dead.");
    let advice = shows("#state-do", "Check the sensor's cable and its supply.");
    page.until("what to do", &advice).await;
    let cause = shows("#causes", "current sensor, phase a");
    page.until("the cause", &cause).await;
    assert!(page.text("#causes").await.contains("100 %"));
    page.click("#faults-off").await;
    page.until_lamps("run").await;
    // A motor cannot lose all its friction and more: refused, and the switch stays off.
    page.fill("#fault-size", "-99").await;
    page.click("label[for=fault-B]").await;
    page.until(
        "a refusal",
        "!document.querySelector('#faults-problem').hidden",
    )
    .await;
    assert!(page.text("#faults-problem").await.contains("-95"));
    assert_eq!(
        page.run("return document.querySelector('#fault-B').checked")
            .await,
        false
    );
}

/// Impossible, then wrong, then right again.
pub async fn parameters_are_checked_at_their_field(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    let field = "#field-parameters-stator_leakage_henry";
    page.fill(field, "-0.02").await;
    page.click("#parameters button[type=submit]").await;
    let invalid =
        format!("document.querySelector('{field}').getAttribute('aria-invalid') === 'true'");
    page.until("the error at its field", &invalid).await;
    let said = page.text(&format!("{field}-problem")).await;
    assert!(
        said.contains("-0.02") && said.contains("at most 100 H"),
        "{said}"
    );
    assert_eq!(page.lamps().await, "run", "nothing was applied");
    page.fill(field, "0.028").await;
    page.fill("#field-parameters-stator_resistance_ohm", "12")
        .await;
    page.click("#parameters button[type=submit]").await;
    page.until_lamps("run r1 r4 fault").await;
    let mended = format!("!({invalid})");
    page.until("a field without an error", &mended).await;
    page.click("#parameters-reset").await;
    page.until_lamps("run").await;
}

/// Names, roles and keys.
pub async fn the_keyboard_and_a_screen_reader_suffice(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    let unnamed = page
        .run(
            "return [...document.querySelectorAll('button, input, select, a, [role=img]')].filter((part) => part.checkVisibility() && \
             !part.textContent.trim() && !part.getAttribute('aria-label') && !part.labels?.length).map((part) => part.outerHTML)",
        )
        .await;
    assert_eq!(unnamed, serde_json::json!([]));
    let live = page.run("return document.querySelectorAll('[aria-live], [role=status], [role=alert]').length >= 5").await;
    assert_eq!(live, true);
    page.run("document.querySelector('#fault-size').value = 50; document.querySelector('#fault-Rs').focus()").await;
    page.press(" ").await;
    page.until_lamps("run r1 r4 fault").await;
    page.press(" ").await;
    page.until_lamps("run").await;
    page.run("document.querySelector('#chart-residuals .plot').focus()")
        .await;
    page.press("+").await;
    page.until(
        "a chart that stands",
        "!document.querySelector('#chart-residuals .follow').hidden",
    )
    .await;
    page.press("\u{e00c}").await; // Escape
    page.until(
        "a chart that follows",
        "document.querySelector('#chart-residuals .follow').hidden",
    )
    .await;
    page.run("HTMLAnchorElement.prototype.click = function () { window.saved_ = this.download; }")
        .await;
    page.click("#chart-residuals button[title]").await;
    page.until(
        "a picture of the chart",
        "window.saved_ === 'residuals.png'",
    )
    .await;
    page.click("#pause").await;
    page.until(
        "standstill",
        "document.querySelector('#pause').textContent === 'Go on'",
    )
    .await;
    page.click("#pause").await;
    page.until(
        "motion",
        "document.querySelector('#pause').textContent === 'Pause'",
    )
    .await;
}

/// The server goes away and another one comes on the same port.
pub async fn the_page_comes_back_after_a_restart(page: &Page) {
    let first = Server::start(&[]);
    let port = first.port().to_owned();
    page.go(&first.url()).await;
    page.until_lamps("run").await;
    assert_eq!(first.interrupt(), Some(0));
    page.until(
        "a word about it",
        "document.querySelector('#connection').dataset.state === 'waiting'",
    )
    .await;
    let _second = Server::start(&["--port", &port, "--speed", "2"]);
    page.until(
        "a connection",
        "document.querySelector('#connection').dataset.state === 'open'",
    )
    .await;
    page.turn("fault-Vq").await;
    page.until_lamps("run r1 r3 r4 fault").await;
}

/// Three measured currents, then voltages, currents and speed of a peer.
pub async fn a_measured_recording_is_played(page: &Page) {
    let currents = "tests/data/itsc_075hp/sc_a3_b0_c0_001.csv.gz";
    let server = Server::start(&["--replay", currents, "--motor", "motors/itsc-075hp.toml"]);
    page.go(&server.url()).await;
    page.until(
        "the reason",
        "document.querySelector('#state-why').textContent === 'Voltages are not recorded.'",
    )
    .await;
    let audit = page.text("#audit").await;
    assert!(
        audit.contains("zero-sequence") && audit.contains("do not add up"),
        "{audit}"
    );
    page.until(
        "currents",
        "document.querySelector('#figure-current_rms_amp').textContent > '0'",
    )
    .await;
    assert_eq!(page.text("#figure-voltage_rms_volt").await, "–");
    drop(server);
    let peer = "tests/data/peer/supply-unbalance/recording.csv.gz";
    let server = Server::start(&[
        "--replay",
        peer,
        "--motor",
        "motors/peer-2k2.toml",
        "--speed",
        "0.5",
    ]);
    page.go(&server.url()).await;
    page.until(
        "a lamp",
        "document.querySelector('#door li[data-lamp=run]').dataset.state !== 'off'",
    )
    .await;
    seek(page, "0.5").await;
    page.until(
        "the time",
        "parseFloat(document.querySelector('#clock').textContent) >= 0.5",
    )
    .await;
    speed(page, "10").await;
    page.until(
        "the end",
        "document.querySelector('#pace-note').textContent.includes('has ended')",
    )
    .await;
    // Slowly: at ten times real time it is over before anybody has looked.
    speed(page, "0.5").await;
    seek(page, "0").await;
    page.until(
        "another play",
        // A busy computer may say that it was too slow instead.
        "!document.querySelector('#pace-note').textContent.includes('has ended')",
    )
    .await;
    drop(server);
}

async fn speed(page: &Page, factor: &str) {
    let script = format!(
        "const speed = document.querySelector('#speed'); speed.value = '{factor}'; speed.dispatchEvent(new Event('change'))"
    );
    page.run(&script).await;
}

async fn seek(page: &Page, t_s: &str) {
    let script = format!(
        "const seek = document.querySelector('#seek'); seek.value = {t_s}; seek.dispatchEvent(new Event('change'))"
    );
    page.run(&script).await;
}

/// Stopped, killed, gone: nothing on the page may then look healthy.
pub async fn old_data_do_not_look_healthy(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    page.until(
        "green",
        "document.querySelector('#state').dataset.mood === 'good'",
    )
    .await;
    let begin = std::time::Instant::now();
    server.signal("STOP");
    page.until("grey", "document.body.classList.contains('stale')")
        .await;
    let took = begin.elapsed().as_secs_f64();
    assert!(
        (1.5..4.0).contains(&took),
        "two seconds after the last window: {took}"
    );
    nothing_is_known(page).await;
    server.signal("CONT");
    page.until_lamps("run").await;
    page.until(
        "green again",
        "document.querySelector('#state').dataset.mood === 'good'",
    )
    .await;
    // A pause is no silence.
    page.click("#pause").await;
    page.until(
        "a pause",
        "document.querySelector('#connection').textContent === 'paused'",
    )
    .await;
    tokio::time::sleep(std::time::Duration::from_secs(3)).await;
    assert_eq!(page.lamps().await, "run");
    page.click("#pause").await;
    page.until(
        "motion",
        "document.querySelector('#connection').textContent === 'live'",
    )
    .await;
    let port = server.port().to_owned();
    server.signal("KILL");
    page.until("grey", "document.body.classList.contains('stale')")
        .await;
    nothing_is_known(page).await;
    drop(server);
    let _again = Server::start(&["--port", &port, "--speed", "2"]);
    page.until_lamps("run").await;
}

async fn nothing_is_known(page: &Page) {
    let title = page.text("#state-title").await;
    let time = title.strip_prefix("No data since ").expect("the headline");
    assert!(time.len() == 8 && time.matches(':').count() == 2, "{title}");
    assert_eq!(page.lamps().await, "");
    let looks = "return [document.querySelector('#state').dataset.mood, document.querySelector('#causes').childElementCount, \
                 getComputedStyle(document.querySelector('.board')).filter, document.querySelector('#connection').dataset.state]";
    let expected = serde_json::json!(["stale", 0, "grayscale(1)", "waiting"]);
    assert_eq!(page.run(looks).await, expected);
}

/// Opened after its end: the last state is there; pause and another time work.
pub async fn an_ended_replay_shows_its_last_state(page: &Page) {
    let peer = "tests/data/peer/supply-unbalance/recording.csv.gz";
    let server = Server::start(&[
        "--replay",
        peer,
        "--motor",
        "motors/peer-2k2.toml",
        "--speed",
        "50",
    ]);
    let ended = || crate::http::get(&server.address, "/api/status").json()["ended"] == true;
    crate::life::until("the end", ended);
    page.go(&server.url()).await;
    let lit = "document.querySelector('#door li[data-lamp=run]').dataset.state === 'on'";
    page.until("its last state", lit).await;
    let clock = "parseFloat(document.querySelector('#clock').textContent)";
    page.until("its time", &format!("{clock} > 1")).await;
    page.until(
        "a figure",
        "parseFloat(document.querySelector('#figure-speed_rad_s').textContent) > 100",
    )
    .await;
    let rpm = page.text("#figure-rpm").await;
    assert!(rpm.ends_with(" rpm") && rpm.len() > 6, "{rpm}");
    page.click("#pause").await;
    page.until(
        "a pause",
        "document.querySelector('#pause').textContent === 'Go on'",
    )
    .await;
    assert_eq!(
        page.run(&format!("return {clock} > 1")).await,
        true,
        "nothing is reset"
    );
    seek(page, "0.7").await;
    page.until("another time", &format!("Math.abs({clock} - 0.7) < 0.05"))
        .await;
    page.until("its lamps", lit).await;
    // Every residual has a line, as it has a number in the table.
    let drawn = "document.querySelectorAll('#row-percent td').length === 4 && \
                 [...document.querySelectorAll('#chart-residuals .u-series')].slice(1, 5).every((row) => row.querySelector('.u-value').textContent !== '–')";
    page.until("four lines", drawn).await;
}

/// Text of the axes has the size of the page's text on every screen; nothing is cut off at 360 pixels.
pub async fn charts_fit_their_screen(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.size_at(1280, 900, 2).await;
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    page.run(
        "import('/panel/charts.js').then(({ Chart }) => { const box = document.createElement('div'); document.body.append(box); \
         window.chart_ = new Chart(box, { id: 'x', title: 'x', x: 't', unit: 'V', lines: [{ label: 'a', color: 'blue' }] }); });",
    )
    .await;
    page.until("a chart", "window.chart_").await;
    // Chromium tells a page of another ratio together with another width only.
    for (width, ratio) in [(1280, 2), (1290, 1), (3840, 2), (370, 1), (360, 2)] {
        page.size_at(width, 900, ratio).await;
        let size =
            "Math.round(0.8 * parseFloat(getComputedStyle(document.documentElement).fontSize))";
        let font = format!(
            "devicePixelRatio === {ratio} && window.chart_.plot.axes.every((axis) => axis.font[0].startsWith(`${{{size} * {ratio}}}px`))"
        );
        page.until(&format!("text at {width}, ratio {ratio}"), &font)
            .await;
    }
    let cut = page
        .run(
            "return [...document.querySelectorAll('.u-legend')].filter((legend) => legend.scrollHeight > legend.clientHeight + 1 || \
             legend.scrollWidth > legend.clientWidth + 1).map((legend) => legend.textContent)",
        )
        .await;
    assert_eq!(cut, serde_json::json!([]));
    assert_eq!(
        page.run("return document.documentElement.scrollWidth <= 360")
            .await,
        true
    );
    page.size(1400, 1000).await;
}

/// Who has seen an alarm stays when the page is loaded again.
pub async fn an_alarm_is_acknowledged(page: &Page) {
    let server = Server::start(&["--speed", "2"]);
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    page.turn("fault-Rs").await;
    page.until("an event", "document.querySelector('#events tbody tr')")
        .await;
    let at = page.text("#events tbody th").await;
    assert_eq!(at.matches(':').count(), 2, "a time of day: {at}");
    page.fill("#acknowledge-name", "Ada").await;
    page.fill("#acknowledge-comment", "terminal tightened")
        .await;
    page.click("#acknowledge button").await;
    let seen = "document.querySelector('#events .comment')?.textContent.startsWith('Ada, ')";
    page.until("who has seen it", seen).await;
    page.go(&server.url()).await;
    page.until("the same after a reload", seen).await;
    assert!(
        page.text("#events .comment")
            .await
            .ends_with(": terminal tightened")
    );
    let name = "return document.querySelector('#acknowledge-name').value";
    assert_eq!(page.run(name).await, "Ada");
}

/// The printed link opens a panel that others can reach; without it the page is refused.
pub async fn the_link_with_its_token_opens_the_page(page: &Page) {
    let server = Server::start(&["--host", "0.0.0.0", "--allow-network", "--speed", "2"]);
    page.go(&server.url()).await;
    page.until_lamps("run").await;
    assert_eq!(
        page.run("return location.search").await,
        "",
        "the token does not stay in sight"
    );
    page.go(&format!("http://{}/", server.address)).await;
    page.until_lamps("run").await;
}
