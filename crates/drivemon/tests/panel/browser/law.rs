//! A drive engineer at the workbench: a pump lifts from a speed on, and no effect of the library does that.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::bench::{answered, the_error_has_fallen, the_motor_file_is_saved};
use super::page::Page;
use crate::server::{Server, root};

/// Speed from which the pump lifts, rad/s.
const THRESHOLD_RAD_S: f64 = 70.0;

/// Supply and load of two days: `(at_s, frequency_hz, voltage_percent)`, `(at_s, torque_percent)`.
type Day = ([(f64, f64, f64); 2], [(f64, f64); 2]);
const DAYS: [Day; 2] = [
    (
        [(0.0, 25.0, 50.0), (1.0, 50.0, 100.0)],
        [(1.0, 80.0), (2.0, 40.0)],
    ),
    (
        [(0.0, 35.0, 70.0), (1.5, 45.0, 90.0)],
        [(1.0, 60.0), (2.0, 100.0)],
    ),
];

fn scenario((supply, load): &Day, seed: usize) -> String {
    let supply = supply.map(|(at, hz, volt)| {
        format!("{{ at_s = {at:?}, frequency_hz = {hz:?}, voltage_percent = {volt:?} }}")
    });
    let load = load.map(|(at, torque)| format!("{{ at_s = {at:?}, torque_percent = {torque:?} }}"));
    let motor = root().join("motors/peer-2k2.toml");
    format!(
        "motor = {motor:?}\nduration_s = 3.0\nsample_rate_hz = 5000.0\nseed = {seed}\n[supply]\nsteps = [{}]\n\
         [load]\nprofile = [{}]\n[sensors]\ntorque = true\nnoise_sigma_fraction_of_full_scale = 0.002\n\
         [[effects]]\nname = \"expression\"\nadds_to = \"torque\"\nlift_nm = 3.0\n\
         formula = \"lift_nm * ((omega - {THRESHOLD_RAD_S:?} + abs(omega - {THRESHOLD_RAD_S:?})) / 174)^2\"\n",
        supply.join(", "),
        load.join(", "),
    )
}

/// The recordings of two days with their sidecars.
fn recordings(folder: &Path) -> [[PathBuf; 2]; 2] {
    std::fs::create_dir_all(folder).expect("a folder");
    [0, 1].map(|day| {
        let [text, csv, sidecar] =
            ["run.toml", "csv", "toml"].map(|end| folder.join(format!("day-{day}.{end}")));
        std::fs::write(&text, scenario(&DAYS[day], day + 1)).expect("a scenario");
        let simulated = Command::new(env!("CARGO_BIN_EXE_drivemon"))
            .arg("simulate")
            .arg(&text)
            .arg("-o")
            .arg(&csv)
            .output()
            .expect("the program");
        assert!(simulated.status.success(), "{simulated:?}");
        [csv, sidecar]
    })
}

/// Load, explain, see the curve, adopt, save.
pub async fn a_pumps_threshold_is_found_and_adopted(page: &Page) {
    let days = recordings(&PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pump"));
    let server = Server::start(&[]);
    page.go(&server.url()).await;
    page.click("#tab-workbench").await;
    page.until("the desk", "document.querySelector('#motor-file')")
        .await;
    let motor = root().join("motors/peer-2k2.toml");
    let motor = motor.canonicalize().expect("a shipped motor file");
    page.choose("#motor-file", &[motor]).await;
    page.until(
        "the motor file",
        "document.querySelector('#save-motor')?.download === 'peer-2k2.toml'",
    )
    .await;
    for (slot, files) in days.iter().enumerate() {
        page.choose(&format!("#file-{slot}"), files).await;
        let holds = format!("document.querySelector('[data-slot=\"{slot}\"] .holds')");
        page.until("a recording", &holds).await;
    }
    page.click("#ask-explain").await;
    answered(page, "explain").await;
    let said = page.text("#answer .verdict strong").await;
    assert!(said.contains("torque over speed"), "{said}");
    page.until(
        "the curve",
        "document.querySelector('#answer [aria-labelledby=explain-law-0] canvas')",
    )
    .await;
    page.click("#answer [data-ask=adopt]").await;
    answered(page, "adopt").await;
    the_error_has_fallen(page).await;
    let motor = the_motor_file_is_saved(page, "peer-2k2-law.toml").await;
    let written: Vec<&str> = motor.effects.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(written, ["curve"]);
}
