//! From a fault on one of several boards to the answer of `explain`, with a gateway that is killed on the way.

use std::process::Command;

use serde_json::Value;

use super::processes::{Plant, printed};
use crate::http::get;
use crate::server::Server;

/// The alarm of a fault.
fn fault(server: &Server) -> Option<Value> {
    let answer = get(&server.address, "/api/fleet/alarms?show=all").json();
    let alarms = answer["alarms"].as_array()?.iter();
    let mut faults = alarms.filter(|alarm| alarm["cause"] == "fault");
    faults.next().cloned()
}

#[test]
fn the_recording_of_an_alarm_opens_in_explain_though_the_gateway_was_killed_before_it_was_fetched()
{
    let mut plant = Plant::start(5, 1, 1);
    let server = plant.page();
    plant.until("an alarm", || fault(&server).is_some());
    // A recording takes five visits of a second each.
    plant.kill_gateway();
    let alarm = fault(&server).expect("it is in the store");
    // On a computer that is very busy it may have come already.
    if alarm["recording"].is_null() {
        let why = alarm["no_recording"].as_str().expect("a reason");
        assert!(why.contains("not fetched yet"), "{why}");
    }
    plant.start_gateway();
    opens_in_explain(&plant, &server);
    let over_http = get(
        &server.address,
        &format!("/api/fleet/alarms/{}/recording", alarm["number"]),
    );
    assert_eq!(over_http.status, 200);
    let file = std::fs::read(plant.file("alarm.csv")).expect("it was written");
    assert!(over_http.body == file, "the page and the command differ");
    let rows = over_http.text().lines().count();
    assert_eq!(rows, 641, "a header and 640 instants");
    let refused = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(export("99", "x.csv"))
        .current_dir(plant.file(""))
        .output()
        .expect("it runs");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("there is no alarm 99"));
}

fn export<'a>(number: &'a str, file: &'a str) -> [&'a str; 8] {
    [
        "fleet",
        "export",
        "--fleet",
        "plant.toml",
        "--alarm",
        number,
        "-o",
        file,
    ]
}

/// Waits for the recording of a fault's alarm, writes it into `alarm.csv` and asks what its motor's model misses.
pub fn opens_in_explain(plant: &Plant, server: &Server) {
    plant.until("a recording", || {
        fault(server).is_some_and(|alarm| alarm["recording"].is_string())
    });
    let number = fault(server).expect("it is in the store")["number"].to_string();
    let folder = plant.file("");
    printed(&folder, &export(&number, "alarm.csv"));
    let explained = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["explain", "alarm.csv", "--motor", "simulated-motor.toml"])
        .args(["--json", "answer.json"])
        .current_dir(&folder)
        .output()
        .expect("it runs");
    // 1: a finding. The motor of this recording differs from its file by half of a parameter, or by a tenth of a sensor.
    let said = String::from_utf8_lossy(&explained.stderr);
    assert_eq!(explained.status.code(), Some(1), "{said}");
}
