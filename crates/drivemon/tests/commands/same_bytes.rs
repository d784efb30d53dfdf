//! The same input gives the same bytes, however many threads there are.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{PROJECT, drivemon, scratch, stderr, text};

/// A start and a load step: short, and enough to find something in.
fn recording(folder: &Path) -> PathBuf {
    let motor = std::fs::canonicalize(Path::new(PROJECT).join("motors/peer-2k2.toml"));
    let scenario = folder.join("scenario.toml");
    let content = format!(
        "motor = {:?}\nduration_s = 1.2\nseed = 7\n[load]\nprofile = [{{ at_s = 0.6, torque_percent = 80.0 }}]\n\
         [sensors]\ntorque = true\nnoise_sigma_fraction_of_full_scale = 0.002\n\
         [[effects]]\nname = \"windage\"\nwindage_nm_s2 = 1e-4\n",
        motor.expect("it ships")
    );
    std::fs::write(&scenario, content).expect("written");
    let file = folder.join("rec.csv.gz");
    let output = drivemon(&["simulate", text(&scenario), "-o", text(&file)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    file
}

/// What a command writes as JSON and as a page with this many threads, and the motor file that it may write.
fn written(folder: &Path, arguments: &[&str], threads: &str) -> Vec<Vec<u8>> {
    let files = ["out.json", "out.html", "out.toml"].map(|name| folder.join(name));
    for file in &files {
        let _ = std::fs::remove_file(file);
    }
    let outputs = ["--json", text(&files[0]), "--report", text(&files[1])];
    let done = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args([arguments, &outputs].concat())
        .current_dir(PROJECT)
        .env("RAYON_NUM_THREADS", threads)
        .output()
        .expect("the binary runs");
    assert!(
        matches!(done.status.code(), Some(0 | 1)),
        "{}",
        stderr(&done)
    );
    let read = |file: &PathBuf| std::fs::read(file).unwrap_or_default();
    files.iter().map(read).collect()
}

#[test]
fn compare_explain_and_adopt_give_the_same_bytes_again_and_with_more_threads() {
    let folder = scratch("same-bytes");
    let recording = recording(&folder);
    let (rec, out) = (text(&recording), folder.join("out.toml"));
    let motor = ["--motor", "motors/peer-2k2.toml"];
    // A recording this short proves no gain: the file is written all the same.
    let adopt = ["adopt", "windage", rec, "--anyway", "-o", text(&out)];
    let commands: [&[&str]; 3] = [&["compare", rec], &["explain", rec], &adopt];
    for command in commands {
        let arguments = [command, &motor].concat();
        let first = written(&folder, &arguments, "1");
        assert!(
            first[0].len() > 1000 && first[1].len() > 1000,
            "{command:?}"
        );
        assert_eq!(first[2].is_empty(), command[0] != "adopt");
        for threads in ["1", "3"] {
            // Not assert_eq: nobody wants to read megabytes.
            let same = written(&folder, &arguments, threads) == first;
            assert!(same, "{command:?} with {threads} threads");
        }
    }
}
