//! The `drivemon` binary as a person uses it: exit codes, messages, JSON.

use std::path::Path;

use crate::common::{PROJECT, drivemon, scratch, stderr, stdout, text};

#[test]
fn help_teaches_the_first_steps_and_the_exit_codes() {
    let help = stdout(&drivemon(&["--help"]));
    for word in [
        "drivemon demo",
        "drivemon monitor rec.csv.gz",
        "Exit codes",
        "NO_COLOR",
        "no protection device",
    ] {
        assert!(help.contains(word), "{word} is missing in:\n{help}");
    }
    assert_eq!(
        drivemon(&["monitor"]).status.code(),
        Some(2),
        "a missing argument is wrong usage"
    );
    assert_eq!(drivemon(&["unknown"]).status.code(), Some(2));
}

#[test]
fn demo_writes_the_documented_json() {
    let file = scratch("demo").join("demo.json");
    let output = drivemon(&["demo", "--seed", "3", "--json", text(&file)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let written = std::fs::read_to_string(&file).expect("the JSON was written");
    let json: serde_json::Value = serde_json::from_str(&written).expect("it is JSON");
    let linear = &json["matrices"][0];
    assert_eq!(
        (&linear["plant"], &linear["frame"]),
        (&"linear".into(), &"voltage".into())
    );
    assert_eq!(
        (linear["agree"].as_u64(), linear["of"].as_u64()),
        (Some(18), Some(18))
    );
    let row = &linear["table"][0];
    for key in [
        "fault",
        "change_percent",
        "expected",
        "measured",
        "r_percent",
    ] {
        assert!(!row[key].is_null(), "{key} is missing in {row}");
    }
    assert_eq!(json["healthy"].as_array().map(Vec::len), Some(8));
    assert!(
        !stdout(&output).contains('\u{1b}'),
        "no colour codes in a pipe"
    );
}

#[test]
fn the_same_scenario_gives_the_same_bytes_and_the_fault_is_found_in_them() {
    let folder = scratch("simulate");
    let scenario = folder.join("scenario.toml");
    let motor = std::fs::canonicalize(Path::new(PROJECT).join("motors/assumed-300w.toml"))
        .expect("it ships");
    std::fs::write(&scenario, two_second_scenario(&motor)).expect("written");
    let record = |name: &str| {
        let file = folder.join(name);
        let output = drivemon(&["simulate", text(&scenario), "-o", text(&file)]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        file
    };
    let (first, second) = (record("first.csv.gz"), record("second.csv.gz"));
    let bytes = |file: &Path| std::fs::read(file).expect("recorded");
    assert_eq!(bytes(&first), bytes(&second));
    let parquet = record("first.parquet");
    assert_eq!(bytes(&parquet), bytes(&record("second.parquet")));
    let judged = |file: &Path| {
        let output = drivemon(&["monitor", text(file), "--motor", text(&motor)]);
        stdout(&output).replace(text(file), "")
    };
    assert_eq!(judged(&first), judged(&parquet));
    let output = drivemon(&[
        "monitor",
        text(&first),
        "--motor",
        text(&motor),
        "--json",
        "-",
    ]);
    assert_eq!(
        output.status.code(),
        Some(1),
        "a lit fault is a finding: {}",
        stdout(&output)
    );
    let json: serde_json::Value =
        serde_json::from_slice(&output.stdout).expect("only JSON on stdout");
    assert_eq!(json["verdict"]["state"], "fault");
    let first_alarm = json["first_alarm_s"].as_f64().expect("an alarm");
    assert!(
        (1.0..1.4).contains(&first_alarm),
        "the fault came at 1.0 s, the lamp at {first_alarm}"
    );
    let causes = json["verdict"]["candidates"]
        .as_array()
        .expect("candidates");
    let likeliest: Vec<_> = causes
        .iter()
        .take(2)
        .map(|cause| cause["fault"].as_str().unwrap_or(""))
        .collect();
    assert!(
        likeliest.contains(&"B") && likeliest.contains(&"Bl"),
        "a tie by physics: {causes:?}"
    );
}

#[test]
fn a_recording_whose_sidecar_would_overwrite_the_scenario_is_refused() {
    let folder = scratch("overwrite");
    let scenario = folder.join("mine.toml");
    let motor = Path::new(PROJECT).join("motors/assumed-300w.toml");
    let content = two_second_scenario(&std::fs::canonicalize(motor).expect("it ships"));
    std::fs::write(&scenario, &content).expect("written");
    let output = drivemon(&[
        "simulate",
        text(&scenario),
        "-o",
        text(&folder.join("mine.csv.gz")),
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("another name"),
        "{}",
        stderr(&output)
    );
    assert_eq!(
        std::fs::read_to_string(&scenario).expect("still there"),
        content
    );
}

fn two_second_scenario(motor: &Path) -> String {
    format!(
        "name = \"more load\"\nmotor = {motor:?}\nduration_s = 2.0\nstart = \"running\"\nseed = 5\n\
         [[faults]]\nfault = \"Bl\"\nchange_percent = 50.0\nfrom_s = 1.0\nto_s = 2.0\n\
         [sensors]\nnoise_sigma_fraction_of_full_scale = 0.002\n"
    )
}

#[test]
fn peer_recording_without_a_fault_is_healthy() {
    let set = "tests/data/peer/none";
    let recording = format!("{set}/recording_b.csv.gz");
    let output = drivemon(&[
        "monitor",
        &recording,
        "--motor",
        &format!("{set}/motor.toml"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    assert!(stdout(&output).contains("healthy"));
}

#[test]
fn three_currents_need_no_motor_file() {
    let output = drivemon(&["monitor", "tests/data/itsc_075hp/sc_a2_b0_c0_002.csv.gz"]);
    assert_eq!(output.status.code(), Some(3), "no motor was judged");
    let said = stdout(&output);
    assert!(
        said.contains("voltages are not recorded") && said.contains("negative over positive"),
        "{said}"
    );
}

/// Where no window can be judged nothing is known of the motor: neither healthy (0) nor faulty (1).
#[test]
fn nothing_judged_is_no_answer() {
    let folder = scratch("nothing-judged");
    let motor = Path::new(PROJECT).join("motors/peer-2k2.toml");
    let shipped = std::fs::read_to_string(&motor).expect("it ships");
    // Not the name of a recording: the sidecar of six-poles.csv is six-poles.toml.
    let other_poles = folder.join("three-pole-pairs.toml");
    let six = shipped.replace("pole_pairs = 2", "pole_pairs = 3");
    assert_ne!(six, shipped);
    std::fs::write(&other_poles, six).expect("written");
    let fast = "[supply]\nfrequency_hz = 400.0\n";
    let cases = [
        ("short", 0.1, "", &motor),
        ("six-poles", 1.0, "", &other_poles),
        ("speedless", 1.0, "[sensors]\nspeed = \"none\"\n", &motor),
        ("fast", 0.5, fast, &motor),
    ];
    for (name, duration_s, more, motor_of_monitor) in cases {
        let scenario = folder.join(format!("{name}.scenario.toml"));
        let text_of_scenario = format!(
            "motor = \"{}\"\nduration_s = {duration_s}\nstart = \"running\"\n{more}",
            motor.display()
        );
        std::fs::write(&scenario, text_of_scenario).expect("written");
        let recording = folder.join(format!("{name}.csv"));
        let simulated = drivemon(&["simulate", text(&scenario), "-o", text(&recording)]);
        assert!(simulated.status.success(), "{}", stderr(&simulated));
        let output = drivemon(&[
            "monitor",
            text(&recording),
            "--motor",
            text(motor_of_monitor),
            "--json",
            "-",
        ]);
        assert_eq!(output.status.code(), Some(3), "{name}: {}", stdout(&output));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("only JSON");
        assert_eq!(json["verdict"]["state"], "not-judged", "{name}");
        assert_eq!(json["judged"], 0, "{name}");
    }
}

#[test]
fn a_load_table_prints_its_operating_points() {
    let table = "tests/data/imc_18k5_load_test/load_test.csv";
    let output = drivemon(&["monitor", table, "--motor", "motors/imc-18k5.toml"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("14 operating points"));
}

#[test]
fn a_folder_that_does_not_exist_is_named_before_the_work() {
    let output = drivemon(&["demo", "--json", "no/such/folder/demo.json"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("no/such/folder/demo.json") && said.contains("make it"),
        "{said}"
    );
    assert_eq!(stdout(&output), "");
}

/// tools/check-json holds the answers of all commands against their schemas.
#[test]
fn an_answer_names_the_format_whose_schema_is_printed() {
    let table = "tests/data/imc_18k5_load_test/load_test.csv";
    let told = drivemon(&[
        "monitor",
        table,
        "--motor",
        "motors/imc-18k5.toml",
        "--json",
        "-",
    ]);
    let answer: serde_json::Value = serde_json::from_str(&stdout(&told)).expect("JSON");
    assert_eq!(answer["format"], "load-table/1");
    let printed = stdout(&drivemon(&["schema", "load-table"]));
    assert_eq!(printed, stdout(&drivemon(&["schema", "load-table/1"])));
    let schema: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    let keys = schema["properties"].as_object().expect("keys");
    for key in answer.as_object().expect("an object").keys() {
        assert!(keys.contains_key(key), "{key}");
    }
    let unknown = drivemon(&["schema", "load-table/9"]);
    assert_eq!(unknown.status.code(), Some(2));
    let said = String::from_utf8_lossy(&unknown.stderr);
    assert!(said.contains("load-table/1"), "{said}");
}

#[test]
fn shells_complete_every_command_and_man_has_a_page_for_each() {
    let help = stdout(&drivemon(&["--help"]));
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands: Vec<&str> = commands
        .take_while(|line| !line.is_empty())
        .filter(|line| !line.starts_with("     "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.len() >= 10, "{commands:?}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&drivemon(&["completions", shell]));
        for command in &commands {
            assert!(script.contains(command), "{shell} does not know {command}");
        }
    }
    let folder = scratch("man-pages");
    let written = drivemon(&["man", &folder.display().to_string()]);
    assert!(written.status.success(), "{written:?}");
    for command in commands {
        let page = folder.join(format!("drivemon-{command}.1"));
        let text = std::fs::read_to_string(&page).expect("a page");
        assert!(text.contains(".SH NAME"), "{}", page.display());
    }
    let nowhere = drivemon(&["man", "/nonexistent/folder"]);
    assert_eq!(nowhere.status.code(), Some(2));
}

/// Recordings are not read for a formula that there cannot be, nor for shapes that cannot be understood.
#[test]
fn wrong_formulas_and_shapes_are_refused_with_what_to_write() {
    let folder = scratch("formulas");
    let shapes = folder.join("mine.toml");
    let text_of_shapes =
        "[[shapes]]\nname = \"mine\"\nformula = \"a*tanh(x/w)\"\nover = \"open\"\n";
    std::fs::write(&shapes, text_of_shapes).expect("a file");
    let motor = format!("{PROJECT}/motors/peer-2k2.toml");
    let recording = format!("{PROJECT}/tests/data/peer/windage/recording.csv.gz");
    let out = folder.join("out.toml");
    let adopt = |more: &[&str]| {
        let all = [
            "adopt",
            more[0],
            recording.as_str(),
            "--motor",
            motor.as_str(),
            "-o",
            text(&out),
        ];
        drivemon(&[&all, &more[1..]].concat())
    };
    for (more, said) in [
        (
            &["windage", "--formula", "1"][..],
            "--formula belongs to `drivemon adopt law`",
        ),
        (&["law", "--formula", "0"], "formulas count from 1"),
        (&["law", "--formula", "one"], "invalid value 'one'"),
        (
            &["law", "--shapes", text(&shapes)],
            "mine.toml:3: shapes[1].formula: it must be proportional",
        ),
        (&["law", "--shapes", "/no/such.toml"], "/no/such.toml"),
    ] {
        let output = adopt(more);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{more:?} {}",
            stderr(&output)
        );
        assert!(
            stderr(&output).contains(said),
            "{more:?} {}",
            stderr(&output)
        );
        assert!(!out.exists());
    }
}

/// A motor with a windage that its file does not have, at one load: nothing to be seen. The designed run shows it.
#[test]
fn a_designed_run_shows_what_one_load_could_not() {
    let folder = scratch("next-run");
    std::fs::copy(
        Path::new(PROJECT).join("motors/peer-2k2.toml"),
        folder.join("m.toml"),
    )
    .expect("copied");
    let path = |name: &str| folder.join(name).display().to_string();
    let truth = "\n[sensors]\ntorque = true\nnoise_sigma_fraction_of_full_scale = 0.002\n\n\
                 [[effects]]\nname = \"windage\"\nwindage_nm_s2 = 4e-5\n";
    let simulate = |scenario: &str, recording: &str, text: &str| {
        std::fs::write(path(scenario), text).expect("written");
        let output = drivemon(&["simulate", &path(scenario), "-o", &path(recording)]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    let one_load = "motor = \"m.toml\"\nduration_s = 1.0\nstart = \"running\"\nsample_rate_hz = 4000\nseed = 3\n\
                    [load]\nconstant_percent = 60.0\n";
    simulate("first-scene.toml", "one.csv", &format!("{one_load}{truth}"));
    std::fs::write(
        path("limits.toml"),
        "duration_s = 3.0\nload_percent = [0, 80]\n",
    )
    .expect("written");
    let explain = |arguments: &[&str], json: &str| -> serde_json::Value {
        let (motor, json) = (path("m.toml"), path(json));
        let all = [
            &["explain"],
            arguments,
            &["--motor", &motor, "--json", &json],
        ]
        .concat();
        let output = drivemon(&all);
        let text = std::fs::read_to_string(&json).unwrap_or_else(|_| panic!("{}", stderr(&output)));
        serde_json::from_str(&text).expect("it is JSON")
    };
    let (limits, next) = (path("limits.toml"), path("next.toml"));
    let first = explain(
        &[&path("one.csv"), "--design", &next, "--limits", &limits],
        "first.json",
    );
    assert_eq!(
        first["steps"].as_array().map(Vec::len),
        Some(0),
        "{}",
        first["summary"]
    );
    let design = &first["next_run"];
    let decides = design["decides"].as_array().expect("a list");
    let windage = decides
        .iter()
        .find(|d| d["what"] == "windage")
        .expect("it is asked");
    assert_eq!(windage["how_surely"], "sure", "{windage}");
    assert!(
        design["instructions"]
            .as_array()
            .is_some_and(|lines| lines.len() > 2)
    );
    assert!(
        design["run"]["levels"]
            .as_array()
            .expect("a list")
            .iter()
            .all(|level| level["load_percent"].as_f64() <= Some(80.0))
    );

    let scenario = std::fs::read_to_string(&next).expect("the scenario was written");
    assert!(scenario.contains("duration_s = 3.000"), "{scenario}");
    let recorded = scenario.replace(
        "duration_s = 3.000",
        "duration_s = 3.000\nsample_rate_hz = 4000\nseed = 4",
    );
    simulate(
        "second-scene.toml",
        "two.csv",
        &format!("{recorded}{truth}"),
    );
    let second = explain(&[&path("two.csv"), &path("one.csv")], "second.json");
    let steps = second["steps"].as_array().expect("a list");
    assert!(
        steps.iter().any(|step| step["effect"] == "windage"),
        "{}",
        second["summary"]
    );
    let windage = steps
        .iter()
        .find(|step| step["effect"] == "windage")
        .expect("it is named");
    let size = &windage["parameters"][0];
    let [value, error] = ["value", "std_error"].map(|key| size[key].as_f64().expect("a number"));
    assert!(
        (value - 4e-5).abs() < 4.0 * error && error < 0.1 * value,
        "{size}"
    );
}
