//! Inputs to begin with: what ships, and the small files of other people's writers.

use std::io::Write;
use std::path::{Path, PathBuf};

use board::{Frame, MAX_FRAME_BYTES};
use flate2::{Compression, write::GzEncoder};
use monitor::Report;

/// A seed is at most this long: a mutation of a long file mostly changes one more of many equal rows.
const LONGEST: usize = 1 << 14;

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The files of a folder whose names end so, in the order of their names; text is cut at a line.
fn files(folder: &str, end: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(root().join(folder)).into_iter().flatten();
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<_> = paths
        .filter(|path| path.to_string_lossy().ends_with(end))
        .collect();
    paths.sort();
    let read = paths.iter().filter_map(|path| std::fs::read(path).ok());
    read.filter(|bytes| bytes.len() <= LONGEST).collect()
}

/// The motors that ship, and each with a formula.
pub(crate) fn motor_files() -> Vec<Vec<u8>> {
    let shipped = files("motors", ".toml");
    let formula = b"\n[[effects]]\nname = \"expression\"\nformula = \"k*omega*abs(omega)/(1+psi^2)\"\nadds_to = \"torque\"\nk = 1e-6\n";
    let with = shipped.iter().map(|file| [&file[..], formula].concat());
    let with: Vec<_> = with.collect();
    [shipped, with].concat()
}

pub(crate) fn scenarios() -> Vec<Vec<u8>> {
    files("sim-host/scenarios", ".toml")
}

pub(crate) fn campaigns() -> Vec<Vec<u8>> {
    files("campaigns", ".toml")
}

pub(crate) fn sidecars() -> Vec<Vec<u8>> {
    files("tests/data/peer/none", ".toml")
}

pub(crate) fn csv() -> Vec<Vec<u8>> {
    let mut wave = String::from("t,va,vb,vc,ia,ib,ic,speed\n");
    for k in 0..120 {
        let t = f64::from(k) * 1e-3;
        let at = |amplitude: f64, angle: f64| amplitude * (314.16 * t - angle).cos();
        wave += &format!("{t:.3}");
        for (amplitude, lag) in [(325.0, 0.0), (7.0, 0.6)] {
            for phase in 0..3 {
                wave += &format!(",{:.2}", at(amplitude, lag + f64::from(phase) * 2.0944));
            }
        }
        wave += ",150\n";
    }
    let small = [
        "t,ia,ib\n0,1,2\n1e-3,3,4\n2e-3,1,1\n",
        "t;ia\n0,0;1,5\n",
        "# bench\r\n\"t\", \"vab\", \"vbc\", \"ia\"\r\n0,1,2,3\r\n0.1,2,3,4\r\n",
        "t,ia,ib,ic,torque,temperature,ic2\n0,1,2,-3,9,20,-3\n1,1,2,-3,9,20,-3\n",
    ];
    std::iter::once(wave.into_bytes())
        .chain(small.map(|text| text.as_bytes().to_vec()))
        .collect()
}

pub(crate) fn csv_gz() -> Vec<Vec<u8>> {
    csv().iter().map(|bytes| gzip(bytes)).collect()
}

/// Bytes as a gzip file; what cannot be written into memory is left out.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    let _ = packed.write_all(bytes);
    packed.finish().unwrap_or_default()
}

pub(crate) fn load_tables() -> Vec<Vec<u8>> {
    files("tests/data/imc_18k5_load_test", ".csv")
}

/// One of everything that a stream may hold.
pub(crate) fn streams() -> Vec<Vec<u8>> {
    let all = [csv(), csv_gz(), load_tables(), parquet(), mat(), comtrade()];
    all.into_iter().flatten().collect()
}

const DATA: &str = "crates/recording/tests/data";

pub(crate) fn parquet() -> Vec<Vec<u8>> {
    files(DATA, ".parquet")
}

pub(crate) fn mat() -> Vec<Vec<u8>> {
    files(DATA, ".mat")
}

/// The pairs as single files, and those that are.
pub(crate) fn comtrade() -> Vec<Vec<u8>> {
    let (texts, samples) = (files(DATA, ".cfg"), files(DATA, ".dat"));
    let joined = texts.iter().zip(&samples).map(|(text, data)| {
        let parts: [&[u8]; 4] = [
            b"--- file type: CFG ---\r\n",
            text,
            b"--- file type: DAT ---\r\n",
            data,
        ];
        parts.concat()
    });
    joined.chain(files(DATA, ".cff")).collect()
}

/// A way of feeding and a stream, as the target takes them.
pub(crate) fn telemetry() -> Vec<Vec<u8>> {
    let frame = |sequence| {
        let frame = Frame::new(&Report::default(), sequence, 3_300);
        frame.encode(&mut [0; MAX_FRAME_BYTES]).to_vec()
    };
    let stream: Vec<u8> = (0..3).flat_map(frame).collect();
    let of = |way: u8| [&[way], &stream[..]].concat();
    vec![of(0), of(7), of(255)]
}

/// Requests as the target takes them: length, body.
pub(crate) fn modbus() -> Vec<Vec<u8>> {
    let [high, low] = board::modbus::UNLOCK_KEY.to_be_bytes();
    let bodies: [&[u8]; 6] = [
        &[1, 3, 0, 0, 0, 10],
        &[1, 4, 0, 0, 0, 125],
        &[1, 6, 0, 1, 0, 1],
        &[1, 16, 0, 0, 0, 2, 4, high, low, 0, 2],
        &[1, 6, 0, 0, high, low],
        &[0, 8, 0, 0, 1, 2],
    ];
    let one = |body: &[u8]| [&[body.len() as u8], body].concat();
    let mut all: Vec<Vec<u8>> = bodies.iter().map(|body| one(body)).collect();
    all.push(bodies.iter().flat_map(|body| one(body)).collect());
    all
}

/// Steps of four bytes, as the target takes them.
pub(crate) fn samples() -> Vec<Vec<u8>> {
    let healthy = [0, 200, 100, 0].repeat(6);
    let holes = [
        [0, 200, 100, 0],
        [1, 3, 0, 0],
        [0, 200, 100, 0],
        [2, 5, 1, 0],
        [0, 200, 100, 0],
    ]
    .concat();
    let load = [
        [0, 250, 100, 0],
        [0, 250, 100, 90],
        [0, 250, 140, 20],
        [5, 40, 9, 9],
    ]
    .concat();
    let odd = [
        [3, 60, 0x7F, 0xFF],
        [4, 60, 1, 3],
        [6, 60, 2, 2],
        [7, 60, 0, 200],
    ]
    .concat();
    vec![healthy, holes, load, odd]
}
