//! `drivemon flash` with programs of its own in the place of the build and of probe-rs: what it runs, and how it fails.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A source tree with a build script, and a folder of programs, of this test alone.
struct Place {
    root: PathBuf,
}

impl Place {
    fn new(name: &str) -> Self {
        // Not below the build folder: that may itself lie in a source tree, which would be found instead.
        let own = format!("drivemon-flash-{name}-{}", std::process::id());
        let root = std::env::temp_dir().join(own);
        let _ = fs::remove_dir_all(&root);
        fs::create_dir_all(root.join("tree/tools")).expect("a folder");
        fs::create_dir_all(root.join("bin")).expect("a folder");
        Place { root }
    }

    /// A script that notes how it was called and ends with `code`.
    fn program(&self, path: &str, code: u8) {
        let path = self.root.join(path);
        let log = self.root.join("log");
        let text = format!(
            "#!/bin/sh\necho \"$(basename \"$0\") $* motor=$DRIVE_MONITOR_MOTOR key=$DRIVE_MONITOR_UPDATE_KEY\" >> '{}'\nexit {code}\n",
            log.display()
        );
        fs::write(&path, text).expect("a file");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("a mode");
    }

    /// With a key of its own.
    fn run(&self, motor: &Path, more: &[&str]) -> Output {
        let key = self.root.join("own.pub");
        let text = format!("# drive-monitor, public key own: x\n{}\n", "5a".repeat(32));
        fs::write(&key, text).expect("a file");
        self.run_with(motor, more, key.to_str().expect("a path"))
    }

    fn run_with(&self, motor: &Path, more: &[&str], key: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_drivemon"))
            .args(["flash", "--motor"])
            .arg(motor)
            .args(more)
            .current_dir(self.root.join("tree"))
            .env(
                "PATH",
                format!("{}:/usr/bin:/bin", self.root.join("bin").display()),
            )
            .env_remove("CARGO_TARGET_DIR")
            .env_remove("DRIVE_MONITOR_MOTOR")
            .env("DRIVE_MONITOR_UPDATE_KEY", key)
            .output()
            .expect("drivemon runs")
    }

    fn log(&self) -> Vec<String> {
        let text = fs::read_to_string(self.root.join("log")).unwrap_or_default();
        text.lines().map(str::to_owned).collect()
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.root);
    }
}

fn motor() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../motors/peer-2k2.toml")
}

fn error(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn it_builds_with_the_motor_then_writes_then_starts() {
    let place = Place::new("whole");
    place.program("tree/tools/thumb", 0);
    place.program("bin/probe-rs", 0);
    let output = place.run(&motor(), &[]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let log = place.log();
    assert_eq!(log.len(), 5, "{log:?}");
    let begin = [
        "thumb build --release -p loader motor= key=/",
        "thumb build --release -p drive-monitor motor=/",
        "probe-rs download --chip STM32G474RETx /",
        "probe-rs download --chip STM32G474RETx /",
        "probe-rs reset --chip STM32G474RETx",
    ];
    let contain = [
        "own.pub",
        "peer-2k2.toml ",
        "target/thumbv7em-none-eabihf/release/loader ",
        "target/thumbv7em-none-eabihf/release/drive-monitor ",
        "",
    ];
    for ((line, begin), contained) in log.iter().zip(begin).zip(contain) {
        assert!(
            line.starts_with(begin) && line.contains(contained),
            "{log:?}"
        );
    }
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("key of updates: /"), "{said}");
}

#[test]
fn the_demo_key_goes_in_only_where_it_is_asked_for() {
    let place = Place::new("demo-key");
    place.program("tree/tools/thumb", 0);
    place.program("bin/probe-rs", 0);
    let message = error(&place.run_with(&motor(), &[], ""));
    assert!(
        message.contains("drivemon board key new") && message.contains("--demo-key"),
        "{message}"
    );
    let message = error(&place.run_with(&motor(), &[], "nowhere.pub"));
    assert!(message.contains("nowhere.pub: cannot be read"), "{message}");
    // In the environment by its file it is the demo key all the same, and a secret half is no key for a board.
    let keys = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../keys");
    let at = |name: &str| keys.join(name).display().to_string();
    let message = error(&place.run_with(&motor(), &[], &at("demo.pub")));
    assert!(message.contains("--demo-key"), "{message}");
    let message = error(&place.run_with(&motor(), &[], &at("demo.key")));
    assert!(message.contains("is the secret half"), "{message}");
    assert!(place.log().is_empty());
    let output = place.run(&motor(), &["--demo-key"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("key of updates: demo"), "{said}");
    let log = place.log();
    assert_eq!(
        log[0], "thumb build --release -p loader motor= key=",
        "{log:?}"
    );
}

#[test]
fn a_dry_run_runs_nothing() {
    let place = Place::new("dry");
    place.program("tree/tools/thumb", 0);
    let output = place.run(&motor(), &["--dry-run"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said.matches("would run: ").count(), 5, "{said}");
    assert!(place.log().is_empty());
}

/// Knots and values are constants of the image; a formula would have to be compiled.
#[test]
fn a_law_goes_onto_the_board_and_a_formula_does_not() {
    let place = Place::new("law");
    place.program("tree/tools/thumb", 0);
    let text = fs::read_to_string(motor()).expect("a shipped motor file");
    let with = |name: &str, effect: &str| {
        let path = place.root.join(name);
        let effect = format!("{text}\n[[effects]]\n{effect}\n");
        fs::write(&path, effect).expect("a file");
        path
    };
    let law = with(
        "law.toml",
        "name = \"curve\"\nplace = \"torque\"\ncoordinate = \"speed\"\n\
         knots_rad_s = [0.0, 60.0, 157.0]\nvalues_nm = [0.0, 0.01, 0.05]",
    );
    let output = place.run(&law, &["--dry-run"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let formula = with(
        "formula.toml",
        "name = \"expression\"\nadds_to = \"torque\"\nformula = \"k*omega\"\nk = 0.01",
    );
    let message = error(&place.run(&formula, &["--dry-run"]));
    assert!(message.contains("runs on a host only"), "{message}");
}

#[test]
fn a_motor_file_that_the_board_cannot_take_is_refused_before_the_build() {
    let place = Place::new("bad-motor");
    place.program("tree/tools/thumb", 0);
    let text = fs::read_to_string(motor()).expect("a shipped motor file");
    let bad = place.root.join("bad.toml");
    fs::write(
        &bad,
        text.replace("stator_resistance_ohm", "stator_resistence_ohm"),
    )
    .expect("a file");
    let message = error(&place.run(&bad, &[]));
    assert!(
        message.contains("bad.toml:") && message.contains("stator_resistence_ohm"),
        "{message}"
    );
    assert!(place.log().is_empty());
}

#[test]
fn each_thing_that_may_be_missing_is_named_with_its_remedy() {
    let place = Place::new("missing");
    let message = error(&place.run(&motor(), &[]));
    assert!(message.contains("--source"), "{message}");
    place.program("tree/tools/thumb", 2);
    let message = error(&place.run(&motor(), &[]));
    assert!(message.contains("was not built"), "{message}");
    place.program("tree/tools/thumb", 0);
    let message = error(&place.run(&motor(), &[]));
    assert!(
        message.contains("cargo install probe-rs-tools"),
        "{message}"
    );
    place.program("bin/probe-rs", 1);
    let message = error(&place.run(&motor(), &[]));
    assert!(message.contains("probe-rs list"), "{message}");
    let elsewhere = place.root.join("bin").display().to_string();
    let message = error(&place.run(&motor(), &["--source", &elsewhere]));
    assert!(message.contains("README.md"), "{message}");
}
