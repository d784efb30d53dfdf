//! The likely cause of an alarm as `drivemon monitor` names it.

use crate::common::{PROJECT, drivemon, scratch, stderr, text};
use serde_json::Value;

/// A simulated recording of the assumed motor whose sensors fail, and what `drivemon monitor` says about it.
fn monitored(name: &str, duration_s: f64, faults: &str) -> Value {
    let folder = scratch(name);
    let scenario = folder.join("scenario.toml");
    let content = format!(
        "name = \"{name}\"\nmotor = \"{PROJECT}/motors/assumed-300w.toml\"\nstart = \"running\"\nduration_s = {duration_s}\nseed = 3\n\
         [sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\n{faults}"
    );
    std::fs::write(&scenario, content).expect("written");
    let (recording, json) = (folder.join("rec.csv.gz"), folder.join("result.json"));
    let made = drivemon(&["simulate", text(&scenario), "-o", text(&recording)]);
    assert!(made.status.success(), "{}", stderr(&made));
    let motor = format!("{PROJECT}/motors/assumed-300w.toml");
    let told = drivemon(&[
        "monitor",
        text(&recording),
        "--motor",
        &motor,
        "--json",
        text(&json),
    ]);
    assert_eq!(told.status.code(), Some(1), "{}", stderr(&told));
    let written = std::fs::read_to_string(&json).expect("written");
    serde_json::from_str(&written).expect("JSON")
}

fn candidates(result: &Value) -> &[Value] {
    result["verdict"]["candidates"].as_array().expect("a list")
}

fn sum(result: &Value) -> f64 {
    candidates(result)
        .iter()
        .filter_map(|c| c["probability"].as_f64())
        .sum()
}

#[test]
fn a_channel_that_the_audit_finds_wrong_is_among_the_causes() {
    let result = monitored(
        "gain-error",
        3.0,
        "[[faults]]\nfault = \"ia\"\ngain = 1.093\nfrom_s = 0.0\n",
    );
    let findings = result["audit"]["findings"].as_array().expect("a list");
    let gain = findings
        .iter()
        .find(|finding| finding["code"] == "zero-sequence");
    assert_eq!(gain.expect("the audit sees it")["suspect"], "ia");
    let first = &candidates(&result)[0];
    assert_eq!(
        (&first["fault"], &first["phase"]),
        (&"Iq".into(), &"a".into()),
        "{result:#}"
    );
    let tests = result["verdict"]["separating_tests"].to_string();
    let tied = result["verdict"]["tied"].as_u64().expect("a number");
    assert!(tied < 2 || tests.contains("ammeter"), "{tests}");
    assert!(
        (0.9..=1.0 + 1e-6).contains(&sum(&result)),
        "{}",
        sum(&result)
    );
}

#[test]
fn what_several_sensors_showed_one_after_the_other_adds_up_to_one() {
    let faults = "[[faults]]\nfault = \"ia\"\ndead = true\nfrom_s = 1.0\nto_s = 2.0\n\
                  [[faults]]\nfault = \"vb\"\ngain = 0.9\nfrom_s = 3.0\nto_s = 4.5\n";
    let result = monitored("sums", 5.0, faults);
    assert!(
        (0.9..=1.0 + 1e-6).contains(&sum(&result)),
        "{}",
        sum(&result)
    );
    let dead = candidates(&result).iter().find(|c| c["phase"] == "a");
    assert_eq!(dead.expect("named")["fault"], "Iq");
}

/// A pump that lifts from 60 rad/s on, at the end of a motor file.
const PUMP: &str = "\n[[effects]]\nname = \"curve\"\nplace = \"torque\"\ncoordinate = \"speed\"\n\
                    knots_rad_s = [0.0, 60.0, 90.0, 120.0, 157.0]\nvalues_nm = [0.0, 0.0, 0.3, 1.2, 2.9]\n";

/// A motor whose pump the monitor does not know shows FAULT; once the law is in its motor file it is dark, and a resistance that
/// really rises still lights.
#[test]
fn a_law_that_was_adopted_puts_its_lamps_out_and_no_other() {
    let folder = scratch("law");
    let motor =
        std::fs::read_to_string(format!("{PROJECT}/motors/peer-2k2.toml")).expect("shipped");
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("written");
        path
    };
    let bare = write("bare.toml", &motor);
    let pump = write("pump.toml", &format!("{motor}{PUMP}"));
    let recorded = |name: &str, faults: &str| {
        let scenario = format!(
            "motor = \"pump.toml\"\nduration_s = 3\n[load]\nfriction_percent = 0\nactive = true\n\
             profile = [{{ at_s = 0, torque_percent = 60 }}]\n[sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\ntorque = true\n{faults}"
        );
        let scenario = write(&format!("{name}-scenario.toml"), &scenario);
        let recording = folder.join(format!("{name}.csv.gz"));
        let made = drivemon(&["simulate", text(&scenario), "-o", text(&recording)]);
        assert!(made.status.success(), "{}", stderr(&made));
        recording
    };
    let lit = |recording: &std::path::Path, motor: &std::path::Path| {
        let told = drivemon(&["monitor", text(recording), "--motor", text(motor)]);
        told.status.code()
    };
    let sound = recorded("sound", "");
    assert_eq!(
        lit(&sound, &bare),
        Some(1),
        "the pump is taken for friction"
    );
    assert_eq!(lit(&sound, &pump), Some(0));
    let fault = "[[faults]]\nfault = \"Rs\"\nchange_percent = 50.0\nfrom_s = 1.5\n";
    assert_eq!(lit(&recorded("fault", fault), &pump), Some(1));
}
