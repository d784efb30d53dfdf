//! From two recordings to a better motor file.

use motor::MotorFile;
use serde_json::json;

use super::{PEER, asked, load, number, project, state, upload};
use crate::http::{get, post};
use crate::life::until;
use crate::server::Server;

#[test]
fn a_hidden_effect_is_found_adopted_saved_and_undone() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    let loaded = load(address, 0, "recording");
    assert_eq!(loaded["summary"]["kind"], "recording");
    assert_eq!(loaded["preview"]["columns"][0], "t");
    assert_eq!(loaded["preview"]["rows"].as_array().map(Vec::len), Some(6));
    load(address, 1, "recording_b");
    let motor = project(&format!("{PEER}/motor.toml"));
    // The panel's own motor is one for 230 V: the audit wonders until the motor is the recording's.
    assert_eq!(loaded["audit"]["supported"], false);
    let chosen = upload(address, "motor/file?name=motor.toml", &motor);
    assert_eq!(chosen.status, 200);
    assert_eq!(chosen.json()["recordings"][0]["audit"]["supported"], true);

    let compared = asked(address, "compare", "");
    assert!(number(&compared, "/result/overall/error_over_noise") > 2.0);
    let html = compared["html"].as_str().expect("HTML");
    assert!(
        html.contains("data-chart") && !html.contains(" style=\"") && !html.contains("<script")
    );
    let (from, to) = (
        number(&compared, "/result/regions/0/from_s"),
        number(&compared, "/result/regions/0/to_s"),
    );
    let traces = get(
        address,
        &format!("/api/workbench/region?from_s={from}&to_s={to}"),
    )
    .json();
    let times: Vec<f64> = serde_json::from_value(traces["t"].clone()).expect("times");
    assert!(
        times.len() > 10
            && times
                .iter()
                .all(|t| (from - 0.001..=to + 0.001).contains(t))
    );

    a_stopped_question_changes_nothing(address);
    let explained = asked(address, "explain", "");
    assert_eq!(
        explained["result"]["next"]["adopt"],
        "magnetizing-saturation"
    );

    let adopted = asked(address, "adopt", "magnetizing-saturation");
    let held_out = |when: &str| {
        number(
            &adopted,
            &format!("/result/{when}/held_out_error_over_noise"),
        )
    };
    // 2.1 times the noise before, the noise itself after.
    assert!(held_out("before") > 1.8 && held_out("after") < 1.1);
    saved_and_undone(address, &motor);
}

fn a_stopped_question_changes_nothing(address: &str) {
    let stop = || post(address, "/api/workbench/jobs/stop", "{}");
    assert_eq!(stop().status, 409, "no question is being worked on");
    let question = json!({"kind": "explain"}).to_string();
    assert_eq!(post(address, "/api/workbench/jobs", &question).status, 200);
    let stopping = stop();
    assert_eq!(stopping.status, 200, "{}", stopping.text());
    assert_eq!(stopping.json()["job"]["stopping"], true);
    until("stopped", || state(address)["job"]["running"] == false);
    let state = state(address);
    assert_eq!(state["job"]["problem"], json!(null));
    assert_eq!(state["results"], json!(["compare"]));
}

fn saved_and_undone(address: &str, before: &[u8]) {
    let saved = get(address, "/api/workbench/motor.toml");
    let name = saved.header("content-disposition").expect("a name");
    assert!(name.contains("motor-magnetizing-saturation.toml"), "{name}");
    let better = MotorFile::parse(&saved.text(), "saved").expect("a motor file");
    assert_eq!(better.effects.len(), 1);
    let compared = asked(address, "compare", "");
    // Nothing is refitted: what was adopted fits the first recording.
    assert!(number(&compared, "/result/overall/error_over_noise") < 1.1);
    assert_eq!(post(address, "/api/workbench/motor/undo", "{}").status, 200);
    assert_eq!(get(address, "/api/workbench/motor.toml").body, before);
    assert_eq!(state(address)["results"], json!([]));
    assert_eq!(post(address, "/api/workbench/motor/undo", "{}").status, 422);
}
