//! The board's RS-485 line as a serial port of this computer, in real time, for masters that are programs of their own.

use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use virtual_board::{Cause, Port, VirtualBoard};

use super::master::good;
use super::{LAMP_TEST_S, board as board_of, scenario};

/// Emulated time between two looks at the port.
const STEP_S: f64 = 0.002;

/// A board in a thread of its own, and the port at which it hangs.
pub struct Wire {
    /// Name of the port.
    pub port: String,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    /// Kept open, so that the port does not hang up between two programs.
    _slave: TTYPort,
}

impl Wire {
    /// Starts a board that has judged a healthy motor for a while, changed by `prepare`.
    pub fn new(prepare: impl FnOnce(&mut VirtualBoard) + Send + 'static) -> Self {
        let (_, never) = std::sync::mpsc::channel();
        Wire::start(prepare, never)
    }

    /// A board whose power fails and returns whenever something comes.
    pub fn with_resets(resets: Receiver<()>) -> Self {
        Wire::start(|_| {}, resets)
    }

    fn start(
        prepare: impl FnOnce(&mut VirtualBoard) + Send + 'static,
        resets: Receiver<()>,
    ) -> Self {
        let (mut outside, slave) = TTYPort::pair().expect("a pseudo terminal");
        outside
            .set_timeout(Duration::from_millis(1))
            .expect("a timeout");
        let port = slave.name().expect("a name");
        let ended = Arc::new(AtomicBool::new(false));
        let ends = ended.clone();
        let (ready, wait) = std::sync::mpsc::channel();
        let thread = std::thread::spawn(move || {
            let mut board = board_of(&scenario(600.0));
            board.forget_taken();
            board.run(LAMP_TEST_S + 0.8).expect("a run");
            prepare(&mut board);
            ready.send(()).expect("somebody waits");
            serve(&mut board, &mut outside, &ends, &resets);
        });
        wait.recv().expect("a board that runs");
        Wire {
            port,
            ended,
            thread: Some(thread),
            _slave: slave,
        }
    }

    /// Runs `drivemon board` with these arguments on the port.
    pub fn drivemon(&self, arguments: &[&str]) -> (Output, String) {
        let mut command = Command::new(drivemon());
        command
            .arg("board")
            .args(arguments)
            .args(["--serial", &self.port])
            .env("NO_COLOR", "1");
        run(&mut command)
    }
}

/// Runs a program; its output and both of its streams as text.
pub fn run(command: &mut Command) -> (Output, String) {
    let output = command
        .output()
        .unwrap_or_else(|error| panic!("{command:?}: {error}; .ci/run installs it"));
    let text = [&output.stdout[..], &output.stderr[..]].concat();
    (output, String::from_utf8_lossy(&text).into_owned())
}

/// The command line: `DRIVEMON`, or where cargo puts it.
fn drivemon() -> PathBuf {
    let named = std::env::var_os("DRIVEMON").map(PathBuf::from);
    named.unwrap_or_else(|| {
        let built =
            ["debug", "release"].map(|kind| super::root().join(format!("target/{kind}/drivemon")));
        let found = built.into_iter().find(|path| path.exists());
        found.expect("no drivemon; build it: cargo build -p drivemon, or name it in DRIVEMON")
    })
}

/// Carries bytes both ways while the board runs as fast as time does.
fn serve(
    board: &mut VirtualBoard,
    outside: &mut TTYPort,
    ended: &AtomicBool,
    resets: &Receiver<()>,
) {
    let begun = Instant::now();
    let mut emulated = 0.0;
    let mut bytes = [0; 256];
    while !ended.load(Ordering::Relaxed) {
        if resets.try_recv().is_ok() {
            board.reset(Cause::Power).expect("a reset");
        }
        // Both ends of a pseudo terminal share one setting, which the program at the other end makes.
        board.set_peer_speed(Port::Modbus, outside.baud_rate().expect("a speed"));
        if let Ok(length) = outside.read(&mut bytes) {
            board.deliver(Port::Modbus, &good(&bytes[..length]));
        }
        board.run(STEP_S).expect("a run");
        emulated += STEP_S;
        let sent: Vec<u8> = board
            .take_sent(Port::Modbus)
            .iter()
            .filter(|sent| sent.understood)
            .map(|sent| sent.byte)
            .collect();
        outside.write_all(&sent).expect("a port");
        board.take_sent(Port::Frames);
        let ahead = Duration::from_secs_f64(emulated).saturating_sub(begun.elapsed());
        std::thread::sleep(ahead);
    }
}

impl Drop for Wire {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
