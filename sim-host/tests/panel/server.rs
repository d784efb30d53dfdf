//! A running `drivemon panel`.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The process; it is ended when this is dropped.
pub struct Server {
    child: Child,
    /// `127.0.0.1:PORT`.
    pub address: String,
}

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_drivemon"));
    command
        .arg("panel")
        .args(arguments)
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
        let mut child = command(&[port, arguments].concat())
            .spawn()
            .expect("it starts");
        let stdout = child.stdout.take().expect("piped");
        let mut lines = BufReader::new(stdout).lines().map_while(Result::ok);
        let address = lines.find_map(|line| {
            let rest = line.strip_prefix("panel: http://")?;
            Some(rest.split('/').next()?.to_owned())
        });
        let Some(address) = address else {
            let mut said = String::new();
            let _ = child
                .stderr
                .take()
                .expect("piped")
                .read_to_string(&mut said);
            panic!("no address was printed: {said}");
        };
        Server { child, address }
    }

    /// What the page would be opened by.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
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
    pub fn interrupt(mut self) -> Option<i32> {
        // The shell's own `kill`: a minimal Debian has no program of that name.
        Command::new("sh")
            .args(["-c", &format!("kill -INT {}", self.child.id())])
            .status()
            .expect("a signal");
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
