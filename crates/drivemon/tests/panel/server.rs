//! A running `drivemon panel`.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The process; it is ended when this is dropped.
pub struct Server {
    child: Child,
    /// `127.0.0.1:PORT`.
    pub address: String,
    url: String,
}

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_drivemon"));
    command.arg("panel").args(arguments);
    piped(command)
}

/// The same under a limit of open files.
fn command_with_files(files: u32, arguments: &[&str]) -> Command {
    let mut command = Command::new("sh");
    let script = format!("ulimit -n {files}; exec \"$0\" panel \"$@\"");
    command
        .args(["-c", &script, env!("CARGO_BIN_EXE_drivemon")])
        .args(arguments);
    piped(command)
}

fn piped(mut command: Command) -> Command {
    command
        .current_dir(root())
        // A server that is killed leaves what was uploaded to it; it goes with the target folder.
        .env("TMPDIR", env!("CARGO_TARGET_TMPDIR"))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

impl Server {
    /// On any free port, unless the arguments name one.
    pub fn start(arguments: &[&str]) -> Server {
        let named = arguments.contains(&"--port");
        let port: &[&str] = if named { &[] } else { &["--port", "0"] };
        Server::listening(command(&[port, arguments].concat()))
    }

    /// On any free port, with so many open files at most.
    pub fn with_files(files: u32) -> Server {
        Server::listening(command_with_files(files, &["--port", "0"]))
    }

    fn listening(mut command: Command) -> Server {
        let mut child = command.spawn().expect("it starts");
        let stdout = child.stdout.take().expect("piped");
        let mut lines = BufReader::new(stdout).lines().map_while(Result::ok);
        let link = lines.find_map(|line| {
            let link = line.strip_prefix("panel: ")?;
            Some(link.split(' ').next()?.to_owned())
        });
        let Some(url) = link else {
            let mut said = String::new();
            let _ = child
                .stderr
                .take()
                .expect("piped")
                .read_to_string(&mut said);
            panic!("no address was printed: {said}");
        };
        let (_, host) = url.split_once("://").expect("a link");
        let address = host.split('/').next().expect("an address").to_owned();
        Server {
            child,
            address,
            url,
        }
    }

    /// What the page would be opened by.
    pub fn url(&self) -> String {
        self.url.clone()
    }

    /// Largest memory that it has had, bytes; only where the system has /proc.
    pub fn largest_memory(&self) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.id())).ok()?;
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix("VmHWM:"))?;
        Some(1024 * line.trim().trim_end_matches(" kB").parse::<u64>().ok()?)
    }

    /// Sends it a signal.
    pub fn signal(&self, name: &str) {
        // The shell's own `kill`: a minimal Debian has no program of that name.
        Command::new("sh")
            .args(["-c", &format!("kill -{name} {}", self.child.id())])
            .status()
            .expect("a signal");
    }

    /// The port alone.
    pub fn port(&self) -> &str {
        self.address.rsplit(':').next().expect("a port")
    }

    /// Its process.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Folders of uploaded files that servers of these tests have now.
    pub fn folders() -> Vec<PathBuf> {
        let entries = std::fs::read_dir(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        let ours = |path: &PathBuf| {
            path.file_name()
                .is_some_and(|name| name.to_string_lossy().starts_with("drivemon-panel-"))
        };
        paths.filter(ours).collect()
    }

    /// Presses Ctrl-C; its exit code.
    pub fn interrupt(self) -> Option<i32> {
        self.ended_by("INT")
    }

    /// Its exit code after a signal.
    pub fn ended_by(mut self, signal: &str) -> Option<i32> {
        self.signal(signal);
        self.child.wait().expect("it ends").code()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Exit code and error text of a panel that must not start.
pub fn refused(arguments: &[&str]) -> (Option<i32>, String) {
    let done = command(arguments).output().expect("it runs");
    (
        done.status.code(),
        String::from_utf8_lossy(&done.stderr).into_owned(),
    )
}
