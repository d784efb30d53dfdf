//! MAT-files of scipy, and damaged ones.

use super::{
    N, assert_error, assert_notes, assert_refused, assert_signals, bytes, data, mapping, read,
};
use crate::common::Folder;
use formats::read_any;
use recording::Mapping;

#[test]
fn plain_and_compressed_files_are_read() {
    for name in ["scipy-v6.mat", "scipy-v7.mat"] {
        let recording = read(&data(name), &Mapping::default()).unwrap();
        assert_eq!(recording.len(), N);
        assert_eq!(recording.speed().unwrap(), [150.0; N]);
        assert_signals(&recording, 1e-10, 1e-11);
    }
    let recording = read(&data("scipy-v7.mat"), &Mapping::default()).unwrap();
    let notes = [
        "column fs is not used: it holds one number",
        "column note is not used: it holds text",
    ];
    assert_notes(&recording, &notes);
}

#[test]
fn matrices_and_structures_become_columns() {
    let flags = mapping(&[
        "t=time",
        "ia=i_1",
        "ib=i_2",
        "ic=i_3",
        "va=drive.va",
        "vb=drive.vb",
        "vc=drive.vc",
        "speed=drive.deep.n",
    ]);
    let recording = read(&data("scipy-struct.mat"), &flags).unwrap();
    assert_signals(&recording, 1e-10, 1e-11);
    assert_notes(
        &recording,
        &[
            "drive.label is not used: it holds text",
            "cells is not used: it holds cells",
        ],
    );
}

#[test]
fn complex_numbers_are_no_signal() {
    let words = ["ia: cannot be read: it holds complex numbers", "--column"];
    assert_error(&data("scipy-complex.mat"), &Mapping::default(), 2, &words);
}

#[test]
fn a_phase_that_cannot_be_read_is_no_absent_one() {
    for (kind, what) in [
        ("complex", "complex numbers"),
        ("cell", "cells"),
        ("sparse", "a sparse matrix"),
    ] {
        let name = format!("scipy-{kind}-phase.mat");
        let why = format!("ic: cannot be read: it holds {what}");
        assert_error(&data(&name), &Mapping::default(), 2, &[&name, &why]);
        let recording = read(&data(&name), &mapping(&["ic=speed"])).unwrap();
        let note = format!("column ic is not used: it holds {what}");
        assert_notes(&recording, &[&note]);
    }
}

/// Behind the header of 128 bytes and the tags; zlib ends each variable with a checksum.
#[test]
fn the_checksums_of_compressed_variables_are_verified() {
    let folder = Folder::new("mat-flips");
    let whole = bytes("scipy-v7.mat");
    let read = |bytes: &[u8]| read(&folder.file("x.mat", bytes), &Mapping::default()).ok();
    let right = read(&whole).expect("it is whole");
    let values = |of: &recording::Recording| -> Vec<Vec<f64>> {
        let channels = of.channels().map(|(_, x)| x.to_vec());
        std::iter::once(of.t().to_vec()).chain(channels).collect()
    };
    for at in 128..whole.len() {
        let mut wrong = whole.clone();
        wrong[at] ^= 1 << (at % 8);
        if let Some(other) = read(&wrong) {
            assert!(values(&other) == values(&right), "byte {at}");
        }
    }
}

#[test]
fn damaged_and_foreign_files_are_refused() {
    let (plain, packed) = (bytes("scipy-v6.mat"), bytes("scipy-v7.mat"));
    let cut = [
        "x.mat: is truncated or damaged: the element at byte 984",
        "save the file again",
    ];
    assert_refused("x.mat", &plain[..1500], 2, &cut);
    assert_refused(
        "x.mat",
        &packed[..packed.len() - 9],
        2,
        &["truncated or damaged"],
    );
    assert_refused(
        "x.mat",
        &plain[..128],
        2,
        &["holds no vector of numbers", "save each signal as a vector"],
    );
    assert_refused(
        "x.mat",
        &plain[..100],
        2,
        &["no MAT-file of version 5", "-v7"],
    );
    assert_refused("x.mat", b"t,ia\n0,1\n", 2, &["no MAT-file of version 5"]);
    let new = [
        b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec(),
        vec![b' '; 400],
        b"\x89HDF".to_vec(),
    ]
    .concat();
    assert_refused(
        "x.mat",
        &new,
        3,
        &["version 7.3 (HDF5)", "save('x.mat', '-v7')"],
    );
    let mut stream = packed.clone();
    // Behind the tag and the head of the first compressed variable.
    stream[150..170].fill(0xA5);
    assert_refused(
        "x.mat",
        &stream,
        2,
        &["the compressed variable at byte 128", "damaged"],
    );
    let mut extent = plain.clone();
    // The first variable's extents: 128 header + 8 tag + 16 flags + 8 tag.
    extent[160] = 7;
    assert_refused(
        "x.mat",
        &extent,
        2,
        &["is truncated or damaged: the element at byte"],
    );
}

/// The same file with its bytes in the other order, as on PowerPC.
#[test]
fn the_most_significant_byte_may_come_first() {
    let folder = Folder::new("big-endian");
    let mut file = b"MATLAB 5.0 MAT-file, by hand".to_vec();
    file.resize(124, b' ');
    file.extend(b"\x01\x00MI");
    for (name, values) in [(b"t\0", [0.0, 1.0]), (b"ia", [2.5, -3.0])] {
        let length = if name[1] == 0 { 1u16 } else { 2 };
        let body = [
            &6u32.to_be_bytes()[..],
            &8u32.to_be_bytes(),
            &6u32.to_be_bytes(),
            &[0; 4],
            &5u32.to_be_bytes(),
            &8u32.to_be_bytes(),
            &1u32.to_be_bytes(),
            &2u32.to_be_bytes(),
            &length.to_be_bytes(),
            &1u16.to_be_bytes(),
            name,
            &[0; 2],
            &9u32.to_be_bytes(),
            &16u32.to_be_bytes(),
            &f64::to_be_bytes(values[0]),
            &f64::to_be_bytes(values[1]),
        ]
        .concat();
        file.extend(14u32.to_be_bytes());
        file.extend((body.len() as u32).to_be_bytes());
        file.extend(body);
    }
    let recording = read(&folder.file("x.mat", &file), &Mapping::default()).unwrap();
    assert_eq!(recording.t(), [0.0, 1.0]);
    assert_eq!(recording.channels().next().unwrap().1, [2.5, -3.0]);
}

/// Whatever single byte is wrong: an error or a recording, never a panic.
#[test]
fn no_wrong_byte_panics() {
    let folder = Folder::new("mat-bytes");
    for name in ["scipy-v6.mat", "scipy-struct.mat"] {
        let whole = bytes(name);
        for at in (0..whole.len()).step_by(5) {
            let mut wrong = whole.clone();
            wrong[at] ^= 1 << (at % 8);
            let path = folder.file("x.mat", &wrong);
            let _ = read_any(&path, &Mapping::default(), &mut crate::common::quiet());
        }
    }
}
