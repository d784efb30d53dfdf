//! The C program, compiled when the benchmark starts and kept running beside it.
//!
//! A process of its own needs no foreign function and so no `unsafe`; it times itself with the monotonic
//! clock, so that pipes and process start are in no figure.

use crate::direct_on_line::{Case, Instant, STEP_S};
use num_complex::Complex64;
use std::io::{Error, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Optimisation as for the Rust side: the highest level, the baseline instruction set of the target, IEEE
/// arithmetic as written.
pub const FLAGS: [&str; 3] = ["-O3", "-std=c11", "-ffp-contract=off"];

/// The running C program.
#[derive(Debug)]
pub struct CWorker {
    child: Child,
    input: ChildStdin,
    output: ChildStdout,
    steps: usize,
    program: PathBuf,
    /// First line of the compiler's `--version`.
    pub compiler: String,
}

impl CWorker {
    /// Compiles and starts the program; the compiler is `$CC`, else `cc`.
    ///
    /// # Errors
    /// No compiler, or one that fails.
    pub fn start(case: &Case) -> Result<CWorker, Error> {
        let cc = std::env::var("CC").unwrap_or_else(|_| "cc".into());
        let compiler = version(&cc)?;
        let program = compile(&cc)?;
        let mut child = Command::new(&program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let missing = || Error::other("no pipe to the C program");
        let mut worker = CWorker {
            input: child.stdin.take().ok_or_else(missing)?,
            output: child.stdout.take().ok_or_else(missing)?,
            child,
            program,
            steps: case.rows.len(),
            compiler,
        };
        worker.send(&header(case))?;
        let rows = case
            .rows
            .iter()
            .flat_map(|row| [row.u_s.re, row.u_s.im, row.tau_load]);
        worker.send(&rows.collect::<Vec<_>>())?;
        Ok(worker)
    }

    /// Time that `passes` starts from rest take.
    ///
    /// # Errors
    /// The program ended.
    pub fn run(&mut self, passes: u64) -> Result<Duration, Error> {
        self.send(&[passes.max(1) as f64])?;
        let answer = self.receive(7)?;
        Ok(Duration::from_nanos(answer[0] as u64))
    }

    /// The whole start.
    ///
    /// # Errors
    /// The program ended.
    pub fn trajectory(&mut self) -> Result<Vec<Instant>, Error> {
        self.send(&[0.0])?;
        let values = self.receive(3 * self.steps)?;
        let instant = |row: &[f64]| Instant {
            i_s: Complex64::new(row[0], row[1]),
            omega_mech: row[2],
        };
        Ok(values.chunks_exact(3).map(instant).collect())
    }

    fn send(&mut self, values: &[f64]) -> Result<(), Error> {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_ne_bytes()).collect();
        self.input.write_all(&bytes)?;
        self.input.flush()
    }

    fn receive(&mut self, count: usize) -> Result<Vec<f64>, Error> {
        let mut bytes = vec![0; 8 * count];
        self.output.read_exact(&mut bytes)?;
        let (words, _) = bytes.as_chunks::<8>();
        Ok(words.iter().map(|word| f64::from_ne_bytes(*word)).collect())
    }
}

impl Drop for CWorker {
    fn drop(&mut self) {
        // Nothing depends on how it ends: it holds no result, and its file is a temporary one.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_file(&self.program);
    }
}

fn header(case: &Case) -> [f64; 10] {
    let (p, m) = (&case.params, &case.mechanics);
    [
        p.r_s,
        p.r_r,
        p.l_ls,
        p.l_lr,
        p.l_m,
        m.n_p,
        m.inertia,
        m.total_friction(),
        STEP_S,
        case.rows.len() as f64,
    ]
}

fn version(cc: &str) -> Result<String, Error> {
    let output = Command::new(cc).arg("--version").output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().next().unwrap_or(cc).to_owned())
}

fn compile(cc: &str) -> Result<PathBuf, Error> {
    let source = format!("{}/c/direct_on_line.c", crate::FOLDER);
    let program = std::env::temp_dir().join(format!("direct_on_line-{}", std::process::id()));
    let status = Command::new(cc)
        .args(FLAGS)
        .arg(source)
        .arg("-o")
        .arg(&program)
        .status()?;
    if status.success() {
        Ok(program)
    } else {
        Err(Error::other(format!("{cc} failed: {status}")))
    }
}
