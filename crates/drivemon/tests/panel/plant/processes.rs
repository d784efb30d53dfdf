//! Boards, gateway and page as programs.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::server::Server;

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(90);

/// A program that is ended when this is dropped.
pub struct Program(Child);

impl Program {
    /// Runs `drivemon` in a folder.
    pub fn start(folder: &Path, arguments: &[&str]) -> Program {
        let child = Command::new(env!("CARGO_BIN_EXE_drivemon"))
            .args(arguments)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn();
        Program(child.expect("it starts"))
    }

    /// As a power cut ends it.
    pub fn kill(mut self) {
        self.0.kill().expect("it runs");
        self.0.wait().expect("it ends");
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// What a command prints.
pub fn printed(folder: &Path, arguments: &[&str]) -> String {
    let done = Command::new(env!("CARGO_BIN_EXE_drivemon"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("it runs");
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{arguments:?}: {said}");
    String::from_utf8_lossy(&done.stdout).trim().to_owned()
}

/// A plant in a folder of its own.
pub struct Plant {
    folder: tempfile::TempDir,
    _boards: Program,
    gateway: Option<Program>,
}

impl Plant {
    /// Simulated boards, of which some begin to fail, and the gateway that reads them.
    pub fn start(boards: u32, faulty: u32, within_s: u32) -> Plant {
        let folder = tempfile::tempdir().expect("a folder");
        // Nobody else takes the port in between: tests that simulate boards do not run beside each other.
        let free = TcpListener::bind("127.0.0.1:0").expect("a port");
        let listen = free.local_addr().expect("an address").to_string();
        drop(free);
        let (boards, faulty, within) =
            (boards.to_string(), faulty.to_string(), within_s.to_string());
        let simulate = [
            "fleet",
            "simulate",
            &boards,
            "--listen",
            &listen,
            "--per-port",
            "247",
            "--faulty",
            &faulty,
            "--faults-within",
            &within,
            "--config-out",
            "plant.toml",
            "--truth",
            "truth.txt",
        ];
        let boards = Program::start(folder.path(), &simulate);
        let mut plant = Plant {
            folder,
            _boards: boards,
            gateway: None,
        };
        plant.until("a configuration", || plant.file("plant.toml").exists());
        plant.start_gateway();
        plant.until("a store", || plant.file("plant.db").exists());
        plant
    }

    /// Starts the gateway.
    pub fn start_gateway(&mut self) {
        let arguments = ["gateway", "plant.toml", "--every", "0"];
        self.gateway = Some(Program::start(self.folder.path(), &arguments));
    }

    /// Ends the gateway as a power cut would.
    pub fn kill_gateway(&mut self) {
        self.gateway.take().expect("it runs").kill();
    }

    /// The page.
    pub fn page(&self) -> Server {
        let plant = self.file("plant.toml").display().to_string();
        Server::start(&["--fleet", &plant])
    }

    /// A file of the plant.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A new user's token.
    pub fn token(&self, name: &str, role: &str) -> String {
        let arguments = [
            "fleet",
            "user",
            "add",
            name,
            "--role",
            role,
            "--fleet",
            "plant.toml",
        ];
        printed(self.folder.path(), &arguments)
    }

    /// Whether a board has finished a second in which its FAULT lamp was lit.
    pub fn fault_is_lit(&self) -> bool {
        let text = std::fs::read_to_string(self.file("truth.txt")).unwrap_or_default();
        text.lines().any(is_fault)
    }

    /// Waits until something is so.
    pub fn until(&self, what: &str, mut is_so: impl FnMut() -> bool) {
        let begin = Instant::now();
        while !is_so() {
            assert!(begin.elapsed() < PATIENCE, "{what} did not come about");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// Byte of a second's record with the lamp FAULT, two bits (docs/modbus.md: lamps from byte 8 on, FAULT is the ninth).
const FAULT_BYTE: usize = 10;

/// A line `second MOTOR HEX` with FAULT on.
fn is_fault(line: &str) -> bool {
    let Some(hex) = line
        .strip_prefix("second ")
        .and_then(|rest| rest.split(' ').nth(1))
    else {
        return false;
    };
    let byte = hex.get(2 * FAULT_BYTE..2 * FAULT_BYTE + 2);
    let byte = byte.and_then(|digits| u8::from_str_radix(digits, 16).ok());
    byte.is_some_and(|byte| byte & 3 == 1)
}
