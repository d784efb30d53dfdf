//! The first check of a motor: plate and recordings in, the answer of `drivemon check` out.

use serde_json::{Value, json};

use super::{PEER, asked, load, project, state, upload};
use crate::http::{get, post};
use crate::server::{Server, root};

/// What `drivemon check` says of the same plate and recording.
fn told_by_the_command(plate: &Value) -> Value {
    let flags = plate.as_object().expect("a plate").iter();
    let flags = flags.flat_map(|(key, text)| {
        let text = text.as_str().expect("a text").to_owned();
        [format!("--{}", key.replace('_', "-")), text]
    });
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .current_dir(root())
        .args(["check", &format!("{PEER}/recording.csv.gz"), "--json", "-"])
        .args(flags)
        .output()
        .expect("it runs");
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    answer["recordings"][0]["told"].clone()
}

/// A check over HTTP: what is missing is named, and the answer is the command's own.
#[test]
fn a_check_needs_a_plate_and_waveforms() {
    let server = Server::start(&[]);
    let address = server.address.as_str();
    let question = json!({"kind": "check", "healthy": "none"}).to_string();
    let ask = || post(address, "/api/workbench/jobs", &question);
    let without = ask();
    assert_eq!(without.status, 422);
    assert!(without.text().contains("nameplate"), "{}", without.text());
    let plate = |plate: Value| post(address, "/api/workbench/check/plate", &plate.to_string());
    let refused = plate(json!({"power_kw": "2.2 kW", "voltage_volt": "400"}));
    assert_eq!(refused.status, 422);
    assert_eq!(refused.json()["problems"][0]["key"], "power_kw");
    let numbers = json!({"name": "Pump 3", "power_kw": "2.2", "voltage_volt": "400", "frequency_hz": "50", "speed_rpm": "1438", "current_amp": "4.78"});
    let taken = plate(numbers.clone());
    assert_eq!(taken.status, 200, "{}", taken.text());
    assert_eq!(taken.json()["check"]["by_plate"], true);
    assert_eq!(taken.json()["motor"]["file"], "pump-3.toml");
    assert!(ask().text().contains("load a recording first"));
    let table = project("tests/data/imc_18k5_load_test/load_test.csv");
    assert_eq!(
        upload(address, "recordings/0/file?name=table.csv", &table).status,
        200
    );
    assert!(ask().text().contains("load table"));
    assert_eq!(get(address, "/api/workbench/check/report.html").status, 404);
    let id = state(address)["recordings"][0]["id"].clone();
    let gone = post(
        address,
        &format!("/api/workbench/recordings/0/remove?id={id}"),
        "{}",
    );
    assert_eq!(gone.status, 200);
    load(address, 0, "recording");
    let shown = asked(address, "check", "");
    assert_eq!(shown["result"]["known_by"], "known by its plate alone");
    assert_eq!(
        shown["result"]["recordings"][0]["told"],
        told_by_the_command(&numbers)
    );
    let state_of = &shown["result"]["recordings"][0]["told"]["state"];
    assert!(
        state_of.is_string()
            && shown["html"]
                .as_str()
                .is_some_and(|html| html.contains("What to do"))
    );
    let report = get(address, "/api/workbench/check/report.html");
    assert_eq!(report.status, 200);
    assert!(report.text().contains(state_of.as_str().expect("words")));
    // Another motor file is another motor: its first check begins anew.
    let motor = project(&format!("{PEER}/motor.toml"));
    let other = upload(address, "motor/file?name=motor.toml", &motor);
    assert_eq!(other.json()["check"], Value::Null);
}
