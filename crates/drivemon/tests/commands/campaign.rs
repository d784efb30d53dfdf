//! Campaigns: the same rows wherever they are made, nothing lost to a crash, and a table that can be checked by hand.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{PROJECT, drivemon, scratch, stderr, stdout, text};
use campaign::{Plan, Results, Row, Run};
use serde_json::Value;

const SMOKE: &str = "campaigns/smoke.toml";

fn smoke() -> Plan {
    let path = Path::new(PROJECT).join(SMOKE);
    Plan::read(path).unwrap_or_else(|error| panic!("{error}"))
}

/// Runs a share of the smoke plan; a finding is no failure.
fn share(plan: &str, output: &Path, more: &[&str]) -> String {
    let arguments = [&["campaign", "run", plan, "-o", text(output)], more].concat();
    let done = drivemon(&arguments);
    assert!(
        matches!(done.status.code(), Some(0 | 1)),
        "{}",
        stderr(&done)
    );
    stdout(&done)
}

fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).expect("written")
}

#[test]
fn two_shares_merged_are_the_bytes_of_the_whole() {
    let folder = scratch("campaign-shares");
    let [whole, a, b, merged] =
        ["whole", "a", "b", "merged"].map(|name| folder.join(format!("{name}.parquet")));
    share(SMOKE, &whole, &[]);
    // Not at the border of a part.
    share(SMOKE, &a, &["--to", "21"]);
    share(SMOKE, &b, &["--from", "21"]);
    let merge = ["campaign", "merge", text(&b), text(&a), "-o", text(&merged)];
    assert!(drivemon(&merge).status.code().is_some_and(|code| code < 2));
    assert!(bytes(&whole) == bytes(&merged));
    assert_ne!(bytes(&whole), bytes(&a));
    let rows = Results::read(&whole).expect("rows").rows;
    assert_eq!(rows.len() as u64, smoke().runs());
    assert!(
        rows.iter()
            .enumerate()
            .all(|(k, row)| row.index == k as u64)
    );
}

/// A larger plan than the smoke test's, so that there is something left when it is killed; cold, so that few alarms are looked into.
fn longer(folder: &Path) -> String {
    let motors = std::fs::canonicalize(Path::new(PROJECT).join("motors")).expect("shipped");
    let plan = std::fs::read_to_string(Path::new(PROJECT).join(SMOKE)).expect("shipped");
    let plan = plan
        .replace("draws = 24", "draws = 200")
        .replace(
            "winding_degc = { from = 0.0, to = 120.0 }",
            "winding_degc = 20.0",
        )
        .replace("../motors", text(&motors));
    let path = folder.join("longer.toml");
    std::fs::write(&path, plan).expect("written");
    text(&path).to_owned()
}

fn finished_parts(output: &Path) -> usize {
    let folder = format!("{}.parts", text(output));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name());
    names
        .filter(|name| Path::new(name).extension().is_some_and(|x| x == "parquet"))
        .count()
}

#[test]
fn a_killed_campaign_goes_on_where_it_was() {
    let folder = scratch("campaign-killed");
    let plan = longer(&folder);
    let (unbroken, broken) = (
        folder.join("unbroken.parquet"),
        folder.join("broken.parquet"),
    );
    let mut child = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(["campaign", "run", &plan, "-o", text(&broken)])
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .expect("the binary runs");
    let patience = Instant::now() + Duration::from_secs(120);
    while finished_parts(&broken) < 3 && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(2));
    }
    // On Unix this is SIGKILL: nothing can be tidied up.
    child.kill().expect("it still runs");
    child.wait().expect("it ends");
    let survived = finished_parts(&broken);
    assert!(survived >= 3 && !broken.exists(), "{survived}");
    let said = share(&plan, &broken, &[]);
    let there: usize = said
        .split_whitespace()
        .next()
        .and_then(|n| n.parse().ok())
        .expect("a number");
    assert!(
        said.contains("were there already") && there >= (survived - 1) * 16,
        "{said}"
    );
    share(&plan, &unbroken, &[]);
    assert!(bytes(&unbroken) == bytes(&broken));
    assert_eq!(finished_parts(&broken), 0);
    let again = share(&plan, &broken, &[]);
    assert!(again.contains("214 runs were there already"), "{again}");
}

#[test]
fn results_of_another_plan_are_not_mixed_in() {
    let folder = scratch("campaign-mixed");
    let (output, other) = (folder.join("x.parquet"), folder.join("other.toml"));
    share(SMOKE, &output, &["--to", "2"]);
    let motors = std::fs::canonicalize(Path::new(PROJECT).join("motors")).expect("shipped");
    let plan = std::fs::read_to_string(Path::new(PROJECT).join(SMOKE)).expect("shipped");
    let plan = plan
        .replace("seed = 7", "seed = 8")
        .replace("../motors", text(&motors));
    std::fs::write(&other, plan).expect("written");
    let done = drivemon(&["campaign", "run", text(&other), "-o", text(&output)]);
    assert_eq!(done.status.code(), Some(2));
    assert!(
        stderr(&done).contains("another campaign"),
        "{}",
        stderr(&done)
    );
    let more = drivemon(&["campaign", "run", SMOKE, "--to", "3", "-o", text(&output)]);
    assert!(
        stderr(&more).contains("holds other runs"),
        "{}",
        stderr(&more)
    );
}

#[test]
fn a_run_made_again_is_the_run_of_the_table() {
    let plan = smoke();
    // The first run with a fault.
    let index = 24;
    let row = || Row::of(&Run::new(&plan, index).expect("a run"));
    assert_eq!(format!("{:?}", row()), format!("{:?}", row()));
    assert_eq!((row().fault.as_str(), row().detected), ("Rs", true));
    let shown = drivemon(&["campaign", "replay", SMOKE, "--index", "24"]);
    let first_fault = stdout(&shown)
        .lines()
        .find(|line| line.matches('●').count() >= 3)
        .and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    let expected = row().fault_from_s + row().delay_s;
    // Printed to the millisecond.
    assert!(
        first_fault.is_some_and(|t| (t - expected).abs() < 1e-3),
        "{first_fault:?} {expected}"
    );
}

#[test]
fn a_replayed_run_becomes_a_recording_that_the_monitor_reads() {
    let folder = scratch("campaign-replay");
    let recording = folder.join("run.csv.gz");
    let done = drivemon(&[
        "campaign",
        "replay",
        SMOKE,
        "--index",
        "24",
        "-o",
        text(&recording),
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    let motor = folder.join("run.motor.toml");
    let monitored = drivemon(&["monitor", text(&recording), "--motor", text(&motor)]);
    assert_eq!(monitored.status.code(), Some(1), "{}", stderr(&monitored));
}

#[test]
fn the_table_counts_what_the_rows_say() {
    let folder = scratch("campaign-table");
    let (output, json, page) = (
        folder.join("x.parquet"),
        folder.join("x.json"),
        folder.join("x.md"),
    );
    share(SMOKE, &output, &[]);
    let table = [
        "campaign",
        "table",
        text(&output),
        "--json",
        text(&json),
        "--markdown",
        text(&page),
    ];
    drivemon(&table);
    let rows = Results::read(&output).expect("rows").rows;
    let json: Value = serde_json::from_slice(&bytes(&json)).expect("JSON");
    let campaign = &json["campaigns"][0];
    let judged: u64 = rows
        .iter()
        .map(|row| u64::from(row.healthy_judged_windows))
        .sum();
    assert_eq!(campaign["healthy_windows"], judged);
    let alarms = rows
        .iter()
        .filter(|row| row.healthy_fault_windows > 0)
        .count();
    assert_eq!(campaign["alarms"].as_array().map(Vec::len), Some(alarms));
    let faults = campaign["detection"].as_array().expect("rows");
    // Rs, Bl, Rs-phase, speed, and the current sensor in both directions.
    assert_eq!(faults.len(), 6);
    let dead = |fault: &&Value| fault["fault"] == "i" && fault["smallest_percent"] == -100.0;
    let dead = faults
        .iter()
        .find(dead)
        .expect("dead current sensors are found");
    assert_eq!(dead["sizes"][0]["isolated"]["percent"], 100.0);
    assert!(
        String::from_utf8_lossy(&bytes(&page))
            .contains("| `i` gain of one current sensor | dead |")
    );
}

/// Channels that are off by up to a half are no healthy instrument, whatever the monitor learns to forgive.
const BAD_GAINS: &str = "\
name = \"Bad gains\"
[[motors]]
file = \"assumed-300w.toml\"
[[blocks]]
name = \"bad gains\"
load_kind = \"free\"
healthy_s = 0.4
sensor_gain_error_percent = 50.0
winding_degc = [20.0, 25.0]
";

#[test]
fn an_alarm_is_blamed_on_the_condition_without_which_it_stays_dark() {
    let motors = Path::new(PROJECT).join("motors");
    let plan =
        Plan::parse(BAD_GAINS, "plan.toml", &motors).unwrap_or_else(|error| panic!("{error}"));
    for index in 0..plan.runs() {
        let row = Row::of(&Run::new(&plan, index).expect("a run"));
        assert!(row.healthy_fault_windows > 0, "{row:?}");
        assert_eq!(row.false_cause, "gain errors");
    }
}

/// The monitor is told one motor while another one runs.
#[test]
fn a_motor_file_that_is_wrong_is_a_fault_and_no_condition_is_to_blame() {
    let motors = Path::new(PROJECT).join("motors");
    let plan = BAD_GAINS
        .replace(
            "sensor_gain_error_percent = 50.0",
            "voltage_percent = 100.0",
        )
        .replace("file = ", "plant = \"peer-2k2.toml\"\nfile = ");
    let plan = Plan::parse(&plan, "plan.toml", &motors).unwrap_or_else(|error| panic!("{error}"));
    let row = Row::of(&Run::new(&plan, 0).expect("a run"));
    assert!(row.healthy_fault_windows > 0, "{row:?}");
    assert_eq!(row.false_cause, "no single condition");
}

#[test]
fn every_problem_of_a_plan_is_told_with_line_and_remedy() {
    let cases = [
        (
            "load_kind = \"free\"",
            "load_kind = \"freee\"",
            "write one of",
        ),
        ("seed = 7", "sed = 7", "sed"),
        ("draws = 24", "repetitions = 2", "needs random draws"),
        (
            "from = 10.0, to = 150.0",
            "from = 150.0, to = 10.0",
            "smaller one first",
        ),
        (
            "change_percent = [10.0, 50.0]",
            "change_percent = []",
            "gives no size",
        ),
        (
            "change_percent = [10.0, 50.0]",
            "change_percent = [0.0]",
            "changes nothing",
        ),
        (
            "change_percent = [10.0, 50.0]",
            "change_percent = [-100.0]",
            "only a sensor can be dead",
        ),
        (
            "load_percent = [50.0, 100.0]",
            "load_step_to_percent = 20.0",
            "the load never changes",
        ),
        (
            "motors/assumed-300w.toml",
            "motors/nobody.toml",
            "there is no file",
        ),
        ("fault = \"Rs\"", "fault = \"bars\"", ""),
        ("fault = \"Rs\"", "fault = \"Ls\"", "write one of"),
    ];
    let plan = std::fs::read_to_string(Path::new(PROJECT).join(SMOKE)).expect("shipped");
    let folder = Path::new(PROJECT).join("campaigns");
    for (from, to, expected) in cases {
        assert!(plan.contains(from), "{from}");
        let result = Plan::parse(&plan.replacen(from, to, 1), "plan.toml", &folder);
        match result {
            Ok(_) => assert!(expected.is_empty(), "{to} is accepted"),
            Err(error) => {
                let error = error.to_string();
                assert!(
                    error.contains(expected) && error.starts_with("plan.toml:"),
                    "{error}"
                );
            }
        }
    }
}

#[test]
fn every_plan_that_ships_is_valid_and_on_the_page() {
    let folder = Path::new(PROJECT).join("campaigns");
    let page =
        std::fs::read_to_string(Path::new(PROJECT).join("docs/campaign.md")).expect("shipped");
    let mut plans = 0;
    let entries = std::fs::read_dir(folder).expect("shipped");
    let paths = entries.map(|entry| entry.expect("readable").path());
    // The folder in it holds plants.
    for path in paths.filter(|path| path.is_file()) {
        let plan = Plan::read(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(plan.runs() > 0 && Run::new(&plan, plan.runs()).is_none());
        let name = path.file_name().expect("a name").to_string_lossy();
        let line = page
            .lines()
            .find(|line| line.contains(&format!("| `campaigns/{name}`")));
        assert!(
            line.is_some_and(|line| line.ends_with(&format!("| {} |", plan.runs()))),
            "{name}: {}",
            plan.runs()
        );
        plans += 1;
    }
    assert!(plans >= 3);
}
