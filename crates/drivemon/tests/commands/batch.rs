//! Folders of recordings: one row each, nothing lost to a crash, only what is new judged again.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use crate::common::{PROJECT, drivemon, scratch, stderr, stdout, text};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Row;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// A folder with measured recordings of one motor in a folder of its own, a simulated one of another, and their map.
fn plant(name: &str) -> PathBuf {
    let folder = scratch(name);
    let project = std::fs::canonicalize(PROJECT).expect("it is there");
    let data = project.join("tests/data");
    let recordings = folder.join("recordings/pump");
    std::fs::create_dir_all(&recordings).expect("made");
    let shorted = std::fs::read_dir(data.join("itsc_075hp")).expect("shipped");
    for entry in shorted.map(|entry| entry.expect("readable").path()) {
        if entry.extension().is_some_and(|end| end == "gz") {
            std::fs::copy(&entry, recordings.join(entry.file_name().expect("a name")))
                .expect("copied");
        }
    }
    for end in ["csv.gz", "toml"] {
        let peer = data.join(format!("peer/supply-unbalance/recording_b.{end}"));
        std::fs::copy(peer, folder.join(format!("recordings/fan.{end}"))).expect("copied");
    }
    let map = format!(
        "[[motors]]\nrecordings = \"pump/*.csv*\"\nmotor = {:?}\n\n[[motors]]\nrecordings = \"*\"\nmotor = {:?}\n",
        project.join("motors/itsc-075hp.toml"),
        data.join("peer/supply-unbalance/motor.toml"),
    );
    std::fs::write(folder.join("map.toml"), map).expect("written");
    folder
}

fn arguments(folder: &Path, out: &Path) -> [String; 6] {
    let map = folder.join("map.toml");
    [
        "batch",
        text(&folder.join("recordings")),
        "--motor-map",
        text(&map),
        "-o",
        text(out),
    ]
    .map(str::to_owned)
}

fn batch(folder: &Path, out: &Path) -> Output {
    let arguments = arguments(folder, out);
    drivemon(&arguments.each_ref().map(String::as_str))
}

fn begun(folder: &Path, out: &Path) -> Child {
    Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(arguments(folder, out))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary runs")
}

fn rows(out: &Path) -> Vec<Row> {
    let file = std::fs::File::open(out).expect("written");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    let rows = reader.get_row_iter(None).expect("rows");
    rows.map(|row| row.expect("a row")).collect()
}

/// A cell as text.
fn cell(row: &Row, key: &str) -> String {
    let column = row.get_column_iter().find(|(name, _)| *name == key);
    let (_, field) = column.unwrap_or_else(|| panic!("no column {key}"));
    field.to_string().trim_matches('"').to_owned()
}

fn parts(out: &Path) -> usize {
    let folder = format!("{}.parts", text(out));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.path());
    names
        .filter(|name| name.extension().is_some_and(|end| end == "parquet"))
        .count()
}

#[test]
fn killed_ten_times_it_gives_the_bytes_of_a_run_that_was_not() {
    let folder = plant("batch-killed");
    let [whole, killed] = ["whole", "killed"].map(|name| folder.join(format!("{name}.parquet")));
    let done = batch(&folder, &whole);
    assert!(
        done.status.code().is_some_and(|code| code != 2),
        "{}",
        stderr(&done)
    );
    assert_eq!((stderr(&done).as_str(), rows(&whole).len()), ("", 46));
    let mut random = Pcg64::seed_from_u64(24);
    let (mut kills, mut most) = (0, 0);
    while kills < 10 {
        let mut child = begun(&folder, &killed);
        // Killed when some rows more are there: none, one or two.
        let wanted = parts(&killed) + random.random_range(0..3);
        while parts(&killed) < wanted && child.try_wait().expect("asked").is_none() {
            std::thread::yield_now();
        }
        let ended = child.try_wait().expect("asked").is_some();
        assert!(!ended, "all rows were there after {kills} kills");
        child.kill().expect("killed");
        child.wait().expect("waited");
        kills += 1;
        most = most.max(parts(&killed));
        assert!(!killed.exists());
    }
    assert!(most > 0, "no row survived a kill");
    let done = batch(&folder, &killed);
    assert!(
        stderr(&done).contains("rows were there already"),
        "{}",
        stderr(&done)
    );
    let bytes = |path: &Path| std::fs::read(path).expect("written");
    assert!(bytes(&whole) == bytes(&killed));
    assert_eq!(parts(&killed), 0);
}

#[test]
fn a_row_says_what_monitor_says_and_only_what_is_new_is_judged_again() {
    let folder = small_plant("batch-rows");
    let out = folder.join("out.parquet");
    let broken = folder.join("recordings/pump/x.csv");
    let done = batch(&folder, &out);
    assert_eq!(done.status.code(), Some(2), "{}", stderr(&done));
    assert!(stderr(&done).contains("x.csv:3: ia"), "{}", stderr(&done));
    let table = rows(&out);
    let names: Vec<String> = table.iter().map(|row| cell(row, "recording")).collect();
    assert_eq!(names[0], "fan.csv.gz");
    assert_eq!((names.len(), names[6].as_str()), (7, "pump/x.csv"));
    assert_eq!(cell(&table[6], "state"), "not-read");
    assert!(cell(&table[6], "error").contains("x.csv:3: ia"));

    let json = folder.join("fan.json");
    let fan = folder.join("recordings/fan.csv.gz");
    let motor = Path::new(PROJECT).join("tests/data/peer/supply-unbalance/motor.toml");
    drivemon(&[
        "monitor",
        text(&fan),
        "--motor",
        text(&motor),
        "--json",
        text(&json),
    ]);
    let told: serde_json::Value =
        serde_json::from_slice(&std::fs::read(&json).expect("written")).expect("JSON");
    assert_eq!(cell(&table[0], "state"), told["verdict"]["state"]);
    assert_eq!(
        cell(&table[0], "judged_windows"),
        told["judged"].to_string()
    );
    let v2: f64 = cell(&table[0], "v2_over_v1_percent")
        .parse()
        .expect("a number");
    let expected = 100.0 * told["sequence"]["v2_over_v1"].as_f64().expect("measured");
    assert!((v2 - expected).abs() < 1e-9 && v2 > 0.5, "{v2} {expected}");
    assert!(cell(&table[0], "findings").contains("supply-unbalance"));

    std::fs::remove_file(&broken).expect("removed");
    let before = std::fs::read(&out).expect("written");
    let done = batch(&folder, &out);
    assert!(
        stderr(&done).contains("6 of 6 rows were there already"),
        "{}",
        stderr(&done)
    );
    assert_ne!(std::fs::read(&out).expect("written"), before);
    let sidecar = folder.join("recordings/fan.toml");
    let changed = std::fs::read_to_string(&sidecar).expect("copied") + "# looked at again\n";
    std::fs::write(&sidecar, changed).expect("written");
    let done = batch(&folder, &out);
    assert!(
        stderr(&done).contains("5 of 6 rows were there already"),
        "{}",
        stderr(&done)
    );
    assert!(stdout(&done).contains("is written"));
}

/// A recording of the plant that cannot be read, in a folder of few.
fn small_plant(name: &str) -> PathBuf {
    let folder = plant(name);
    let pump = folder.join("recordings/pump");
    for entry in std::fs::read_dir(&pump).expect("made").flatten() {
        let name = entry.file_name().into_string().expect("UTF-8");
        if !name.starts_with("sc_hlt") {
            std::fs::remove_file(entry.path()).expect("removed");
        }
    }
    std::fs::write(pump.join("x.csv"), "t,ia,ib\n0,1,2\n0.1,x,2\n").expect("written");
    folder
}

#[test]
fn parts_made_in_any_order_and_twice_give_the_bytes_of_one_machine() {
    let folder = small_plant("batch-parts");
    let [whole, out] = ["whole", "parts"].map(|name| folder.join(format!("{name}.parquet")));
    batch(&folder, &whole);
    let part = |words: &[&str]| {
        let arguments = arguments(&folder, &out);
        let mut all = arguments.each_ref().map(String::as_str).to_vec();
        all.extend(words);
        drivemon(&all)
    };
    for bounds in [["--from", "5"], ["--to", "3"], ["--to", "3"]] {
        let done = part(&bounds);
        assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
        assert!(!out.exists());
    }
    assert_eq!(parts(&out), 2, "rows of a part have no files of their own");
    // What was begun and not finished: a row by itself, and what is no part.
    let rest = part(&["--from", "3", "--to", "4"]);
    assert!(
        stdout(&rest).contains("Recordings 3..4 of 7"),
        "{}",
        stdout(&rest)
    );
    for (words, told) in [
        (["--from", "7"].as_slice(), "recordings 0..7"),
        (&["--from", "2", "--to", "2"], "recordings 0..7"),
        (&["--from", "2", "--engine", "ray"], "leave them out"),
    ] {
        let refused = part(words);
        assert_eq!(refused.status.code(), Some(2), "{told}");
        assert!(stderr(&refused).contains(told), "{}", stderr(&refused));
    }
    let done = part(&[]);
    assert_eq!(done.status.code(), Some(2), "{}", stderr(&done));
    assert!(
        stderr(&done).contains("6 of 7 rows were there already"),
        "{}",
        stderr(&done)
    );
    let bytes = |path: &Path| std::fs::read(path).expect("written");
    assert!(bytes(&whole) == bytes(&out));
    assert_eq!(parts(&out), 0);
}

#[test]
fn a_part_whose_recording_changed_is_made_again() {
    let folder = small_plant("batch-part-changed");
    let [whole, out] = ["whole", "parts"].map(|name| folder.join(format!("{name}.parquet")));
    let arguments = arguments(&folder, &out);
    let mut words = arguments.each_ref().map(String::as_str).to_vec();
    words.extend(["--to", "2"]);
    drivemon(&words);
    let sidecar = folder.join("recordings/fan.toml");
    let changed = std::fs::read_to_string(&sidecar).expect("copied") + "# looked at again\n";
    std::fs::write(&sidecar, changed).expect("written");
    let again = drivemon(&words);
    assert!(
        stderr(&again).contains("1 of 2 rows were there already"),
        "{}",
        stderr(&again)
    );
    let third = drivemon(&words);
    assert!(
        stderr(&third).contains("2 of 2 rows were there already"),
        "{}",
        stderr(&third)
    );
    batch(&folder, &whole);
    batch(&folder, &out);
    let bytes = |path: &Path| std::fs::read(path).expect("written");
    assert!(bytes(&whole) == bytes(&out));
}

#[test]
fn slurm_gets_a_script_whose_tasks_make_the_table() {
    let folder = small_plant("batch-slurm");
    let [whole, out] = ["whole", "it's one"].map(|name| folder.join(format!("{name}.parquet")));
    batch(&folder, &whole);
    let arguments = arguments(&folder, &out);
    let mut words = arguments.each_ref().map(String::as_str).to_vec();
    words.extend(["--engine", "slurm", "--task-seconds", "10"]);
    let script = stdout(&drivemon(&words));
    // A Slurm of one machine: what is handed in runs at once.
    let sbatch = folder.join("sbatch");
    let lines = "#!/usr/bin/env bash\nexport SLURM_ARRAY_TASK_ID=0\nbash >&2 || [ $? -eq 2 ] || exit\necho 17\n";
    std::fs::write(&sbatch, lines).expect("written");
    let path = format!("{}:{}", text(&folder), std::env::var("PATH").expect("set"));
    let ran = Command::new("bash")
        .args([
            "-c",
            "chmod +x \"$1/sbatch\" && bash -c \"$2\"",
            "x",
            text(&folder),
            &script,
        ])
        .env("PATH", path)
        .output()
        .expect("bash");
    assert!(ran.status.success(), "{script}\n{}", stderr(&ran));
    assert!(
        stderr(&ran).contains("7 of 7 rows were there already"),
        "{}",
        stderr(&ran)
    );
    let bytes = |path: &Path| std::fs::read(path).expect("written");
    assert!(bytes(&whole) == bytes(&out));
}

#[test]
fn what_is_wrong_is_said_before_anything_is_judged() {
    let folder = plant("batch-wrong");
    let out = folder.join("out.parquet");
    let map = folder.join("map.toml");
    let good = std::fs::read_to_string(&map).expect("written");
    let refused = |map_text: &str, out: &Path, told: &str| {
        std::fs::write(&map, map_text).expect("written");
        let done = batch(&folder, out);
        assert_eq!(done.status.code(), Some(2), "{told}: {}", stderr(&done));
        assert!(stderr(&done).contains(told), "{told}: {}", stderr(&done));
    };
    refused("", &out, "map.toml");
    refused(
        &good.replace("motor = ", "moter = "),
        &out,
        "map.toml:3: motors[1].moter",
    );
    refused(
        &good.replace("pump/*", "pumps/*"),
        &out,
        "fits no recording",
    );
    refused(&good.replace("itsc-075hp", "absent"), &out, "absent.toml");
    refused(&good, &folder.join("out.csv"), ".parquet");
    std::fs::write(&out, "something else").expect("written");
    refused(&good, &out, "is there and no table");
    assert_eq!(std::fs::read(&out).expect("kept"), b"something else");
}
