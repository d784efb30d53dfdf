//! Inputs to begin with: what ships, and the small files of other people's writers.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use board::{Frame, MAX_FRAME_BYTES, Shown};
use flate2::{Compression, write::GzEncoder};
use monitor::Report;
use uplink::sparkplug::{Metric, Payload, REBIRTH, Wire};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

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
        "sep=;\nBench;3\nZeit (ms);Ua [V];Ub [V];I1;I2\n0,0;1.234,5;2;3;4\n0,1;-1.234,5;1;2;3\n;;;;\n",
        "Sample Interval,1e-4\nI1 (mA),I2 (mA)\n\"1,234.5\",2\n\"-1,234.5\",3\n",
        "# t ia ib\n0.1  1  2\n0.2  3  4\n% note\nEOF\n",
        "Timestamp,U12,U32,n (rpm)\n3/4/2024 11:59:59.9 AM,1,2,3\n3/4/2024 12:00:00.0 PM,1,2,3\n",
        "\"TraceName\",\"Ia\",\"Ib\"\n\"VUnit\",\"mA\",\"mA\"\n\"HResolution\",1e-4,1e-4\n,1,2\n,3,4\n",
        "time,i_l1,i_l2\n1709290800000000000,1,2\n1709290800000100000,2,3\n",
    ];
    let utf16 = small[1].encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::iter::once(wave.into_bytes())
        .chain(small.map(|text| text.as_bytes().to_vec()))
        .chain([utf16, b"Zeit (\xB5s);ia\n0;1,5\n1;2,5\n".to_vec()])
        .collect()
}

/// A workbook of one sheet, packed and as it is.
pub(crate) fn workbooks() -> Vec<Vec<u8>> {
    const RELATIONS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let relation = |kind: &str, target: &str| {
        format!(
            "<Relationships><Relationship Id=\"r1\" Type=\"{RELATIONS}/{kind}\" Target=\"{target}\"/></Relationships>"
        )
    };
    let workbook = format!(
        "<workbook xmlns:r=\"{RELATIONS}\"><sheets><sheet name=\"S\" sheetId=\"1\" r:id=\"r1\"/></sheets></workbook>"
    );
    let sheet = "<worksheet><sheetData><row r=\"1\"><c r=\"A1\" t=\"str\"><v>t</v></c><c r=\"B1\" t=\"str\"><v>ia</v></c></row>\
                 <row r=\"2\"><c r=\"A2\"><v>0</v></c><c r=\"B2\"><v>1.5</v></c></row>\
                 <row r=\"3\"><c r=\"A3\"><v>1</v></c><c r=\"B3\"><v>2.5</v></c></row></sheetData></worksheet>";
    let parts = [
        ("_rels/.rels", relation("officeDocument", "xl/workbook.xml")),
        ("xl/workbook.xml", workbook),
        (
            "xl/_rels/workbook.xml.rels",
            relation("worksheet", "worksheets/sheet1.xml"),
        ),
        ("xl/worksheets/sheet1.xml", sheet.to_owned()),
    ];
    let methods = [CompressionMethod::Stored, CompressionMethod::Deflated];
    methods
        .into_iter()
        .filter_map(|method| archive(&parts, method).ok())
        .collect()
}

fn archive(parts: &[(&str, String)], method: CompressionMethod) -> zip::result::ZipResult<Vec<u8>> {
    let options = SimpleFileOptions::default().compression_method(method);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in parts {
        archive.start_file(*name, options)?;
        archive.write_all(content.as_bytes())?;
    }
    Ok(archive.finish()?.into_inner())
}

/// Sixteen bits and 32 bit float, three channels.
pub(crate) fn wav() -> Vec<Vec<u8>> {
    let samples: Vec<u8> = (0..=255).cycle().take(240).collect();
    let head = |format: u16, bits: u16| {
        let (block, size) = (3 * bits / 8, samples.len() as u32);
        [
            &b"RIFF"[..],
            &(36 + size).to_le_bytes(),
            b"WAVEfmt ",
            &16u32.to_le_bytes(),
            &format.to_le_bytes(),
            &3u16.to_le_bytes(),
            &8000u32.to_le_bytes(),
            &(8000 * u32::from(block)).to_le_bytes(),
            &block.to_le_bytes(),
            &bits.to_le_bytes(),
            b"data",
            &size.to_le_bytes(),
            &samples,
        ]
        .concat()
    };
    vec![head(1, 16), head(3, 32)]
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
    let all = [
        csv(),
        csv_gz(),
        load_tables(),
        parquet(),
        mat(),
        comtrade(),
        workbooks(),
        wav(),
    ];
    all.into_iter().flatten().collect()
}

const DATA: &str = "crates/formats/tests/data";

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
        let frame = Frame::new(&Report::default(), &Shown::default(), sequence, 3_300);
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

/// Frames of Modbus TCP, one and many.
pub(crate) fn modbus_tcp() -> Vec<Vec<u8>> {
    let bodies: [&[u8]; 5] = [
        &[1, 4, 0, 0, 0, 68],
        &[2, 3, 0, 67, 0, 1],
        &[1, 4, 0, 100, 0, 125],
        &[9, 4, 0, 0, 0, 1],
        &[1, 16, 0, 0, 0, 1, 2, 0, 0],
    ];
    let one = |body: &&[u8]| [&[0, 1, 0, 0, 0, body.len() as u8], *body].concat();
    let mut all: Vec<Vec<u8>> = bodies.iter().map(one).collect();
    all.push(all.concat());
    all
}

/// Messages as the target takes them: kind, length, body.
pub(crate) fn sparkplug() -> Vec<Vec<u8>> {
    let command = |name: &str, value| {
        let metric = Metric {
            name: Some(name.to_owned()),
            value: Some(value),
            ..Metric::default()
        };
        let payload = Payload {
            timestamp: Some(1),
            metrics: vec![metric],
            ..Payload::default()
        };
        payload.to_bytes()
    };
    let of = |kind: u8, body: &[u8]| [&[kind, body.len() as u8], body].concat();
    let here = of(2, br#"{"online":true,"timestamp":5}"#);
    let away = of(2, br#"{"online":false,"timestamp":6}"#);
    let rebirth = of(0, &command(REBIRTH, Wire::Boolean(true)));
    let write = of(1, &command("Speed", Wire::Float(1.0)));
    let all = [&here[..], &rebirth, &write, &away].concat();
    vec![here, away, rebirth, write, all]
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
